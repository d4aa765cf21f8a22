#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <numeric>

#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/quality.hpp"
#include "shared_mesh.hpp"
#include "test_names.hpp"

// Meshes of other projects and those of the validation cases.

namespace resilin {
namespace {

struct Expected {
  std::string file;
  int dimension;
  std::size_t vertices;
  Index cells;
};

class SharedMesh : public ::testing::TestWithParam<Expected> {};

// Numbers of meshes/README.md.
const std::vector<Expected> shared_meshes = {
    {"armadillo_coarse.node", 3, 259, 627}, {"armadillo_coarse.ele", 3, 259, 627},
    {"coarse_bunny.mesh", 3, 699, 2274},    {"bunny.mesh", 3, 5433, 34055},
    {"armadillo_13k.msh", 3, 13230, 54985}, {"spot.mesh", 3, 8428, 37679},
    {"liver.mesh", 3, 10641, 40240},        {"liver_small.mesh", 3, 1227, 4283},
    {"mat40x40.msh", 3, 3200, 9126},        {"kangaroo_2d.msh", 2, 515, 813},
    {"dolphin_2d.msh", 2, 255, 379},        {"beam3_tet.veg", 3, 208, 450},
};

TEST_P(SharedMesh, LoadsAndIsFitForSimulation) {
  RESILIN_NEEDS_SHARED_MESH(GetParam().file);
  const MeshFile file = read_solid_mesh(*testing::shared_mesh(GetParam().file), GetParam().dimension);
  const CellKind kind = GetParam().dimension == 3 ? CellKind::tetrahedron : CellKind::triangle;
  EXPECT_EQ(file.mesh.vertices.size(), GetParam().vertices);
  ASSERT_NE(file.mesh.find_block(kind), nullptr);
  EXPECT_EQ(file.mesh.find_block(kind)->num_cells(), GetParam().cells);
  EXPECT_TRUE(cell_signs(file.mesh, *file.mesh.find_block(kind)).inverted.empty());
}

INSTANTIATE_TEST_SUITE_P(OfOtherProjects, SharedMesh, ::testing::ValuesIn(shared_meshes),
                         [](const auto& test) { return testing::as_test_name(test.param.file); });

TEST(SharedSurface, OfTheArmadilloLoads) {
  RESILIN_NEEDS_SHARED_MESH("armadillo_skin.obj");
  const MeshFile armadillo = read_mesh(*testing::shared_mesh("armadillo_skin.obj"));
  EXPECT_EQ(armadillo.mesh.vertices.size(), 26002u);
  EXPECT_EQ(armadillo.mesh.blocks[0].num_cells(), 52000);
}

TEST(SharedSurface, OfTheCowLoads) {
  const MeshFile cow = read_mesh(testing::source_folder() / "data" / "spot_surface.obj");
  EXPECT_EQ(cow.mesh.vertices.size(), 2930u);
  EXPECT_EQ(cow.mesh.blocks[0].num_cells(), 5856);
}

TEST(SharedMeshVolume, OfTheArmadilloIsTheKnownOne) {
  RESILIN_NEEDS_SHARED_DATA();
  const MeshFile file = read_solid_mesh(*testing::shared_folder() / "meshes" / "armadillo_coarse.node", 3);
  const auto volumes = signed_volumes(file.mesh, file.mesh.blocks[0]);
  EXPECT_NEAR(std::accumulate(volumes.begin(), volumes.end(), 0.0), 0.1003, 5e-5);  // README: four digits
}

struct BoxCase {
  std::string file;
  Vector3 size;
  std::array<int, 3> cells;
  Vector3 origin;
};

/// make_box gives the vertices (up to rounding) and the tetrahedra (exactly) of the validation meshes.
TEST(KuhnNumbering, IsThatOfTheValidationMeshes) {
  const std::vector<BoxCase> cases = {{"bar_2x2x10", {1, 1, 5}, {2, 2, 10}, {-0.5, -0.5, 0}},
                                      {"bar_4x4x20", {1, 1, 5}, {4, 4, 20}, {-0.5, -0.5, 0}},
                                      {"beam_10x2x2", {1, 0.2, 0.2}, {10, 2, 2}, {0, 0, 0}},
                                      {"beam_20x4x4", {1, 0.2, 0.2}, {20, 4, 4}, {0, 0, 0}},
                                      {"column_2x2x12", {1, 1, 6}, {2, 2, 12}, {0, 0, 0}}};
  for (const BoxCase& c : cases) {
    const MeshFile file = read_solid_mesh(testing::reference_folder() / "meshes" / (c.file + ".msh"), 3);
    const Mesh box = make_box(c.size, c.cells, c.origin);
    ASSERT_EQ(box.vertices.size(), file.mesh.vertices.size()) << c.file;
    for (std::size_t v = 0; v < box.vertices.size(); ++v) {
      ASSERT_LT((box.vertices[v] - file.mesh.vertices[v]).norm(), 1e-15 * c.size.norm())
          << c.file << " vertex " << v;
    }
    EXPECT_EQ(box.find_block(CellKind::tetrahedron)->nodes,
              file.mesh.find_block(CellKind::tetrahedron)->nodes)
        << c.file;
  }
}

TEST(ValidationMesh, HasTheGroupsOfItsCase) {
  const auto folder = testing::reference_folder() / "meshes";
  const MeshFile bar = read_solid_mesh(folder / "bar_2x2x10.msh", 3);
  ASSERT_NE(bar.mesh.find_group("top"), nullptr);
  EXPECT_EQ(bar.mesh.find_group("top")->vertices.size(), 9u);
  EXPECT_EQ(bar.mesh.find_group("body")->vertices.size(), 99u);
  const MeshFile cook = read_solid_mesh(folder / "cook_4x4.msh", 2);
  EXPECT_EQ(cook.mesh.find_group("right")->vertices.size(), 5u);
}

TEST(ValidationMesh, AllOfThemLoadWithoutWarning) {
  for (const auto& entry : std::filesystem::directory_iterator(testing::reference_folder() / "meshes")) {
    MeshFile file = read_mesh(entry.path());
    prepare_solid_mesh(file, file.mesh.find_block(CellKind::tetrahedron) != nullptr ? 3 : 2);
    EXPECT_TRUE(file.warnings.empty()) << ::testing::PrintToString(file.warnings);
  }
}

TEST(ShippedMesh, TheCowLoads) {
  const auto folder = testing::source_folder() / "data";
  EXPECT_EQ(read_solid_mesh(folder / "spot.mesh", 3).mesh.blocks[0].num_cells(), 37679);
  EXPECT_EQ(read_mesh(folder / "spot_surface.obj").mesh.blocks[0].num_cells(), 5856);
}

}  // namespace
}  // namespace resilin
