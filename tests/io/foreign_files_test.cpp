#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/io/vtu.hpp"
#include "resilin/mesh/quality.hpp"
#include "shared_data.hpp"
#include "test_names.hpp"

// Files that Gmsh, VTK and meshio wrote (tests/data/make_meshes.py): the unit cube with the groups "body",
// "left" (x = 0), "rim" (two edges) and "corner" (the origin).

namespace resilin {
namespace {

std::filesystem::path file(const std::string& name) {
  return testing::source_folder() / "tests" / "data" / "meshes" / name;
}

std::string test_name(const ::testing::TestParamInfo<std::string>& info) {
  return testing::as_test_name(info.param);
}

double volume(const Mesh& mesh) {
  const auto volumes = signed_volumes(mesh, *mesh.find_block(CellKind::tetrahedron));
  return std::accumulate(volumes.begin(), volumes.end(), 0.0);
}

class CubeFile : public ::testing::TestWithParam<std::string> {};

TEST_P(CubeFile, IsTheUnitCubeOf24Tetrahedra) {
  const MeshFile cube = read_solid_mesh(file(GetParam()), 3);
  EXPECT_EQ(cube.mesh.vertices.size(), 14u);
  ASSERT_NE(cube.mesh.find_block(CellKind::tetrahedron), nullptr);
  EXPECT_EQ(cube.mesh.find_block(CellKind::tetrahedron)->num_cells(), 24);
  EXPECT_NEAR(volume(cube.mesh), 1, 1e-12);  // Gmsh writes 16 digits
  EXPECT_TRUE(cube.warnings.empty()) << ::testing::PrintToString(cube.warnings);
}

INSTANTIATE_TEST_SUITE_P(OfEveryFormat, CubeFile,
                         ::testing::Values("cube.ele", "cube.mesh", "cube.node", "cube_22_ascii.msh",
                                           "cube_22_binary.msh", "cube_40_ascii.msh", "cube_41_ascii.msh",
                                           "cube_41_binary.msh", "cube_42_ascii.vtk", "cube_42_binary.vtk",
                                           "cube_51_ascii.vtk", "cube_51_binary.vtk", "cube_ascii.vtu",
                                           "cube_base64.vtu", "cube_inline.vtu", "cube_raw.vtu"),
                         test_name);

class GmshFile : public ::testing::TestWithParam<std::string> {};

TEST_P(GmshFile, HasItsPhysicalGroups) {
  const Mesh mesh = read_mesh(file(GetParam())).mesh;
  const auto coordinate_sum = [&](const std::string& group, int axis) {
    double sum = 0;
    for (const Index v : mesh.find_group(group)->vertices)
      sum += mesh.vertices[static_cast<std::size_t>(v)][axis];
    return sum;
  };
  for (const char* group : {"body", "left", "rim", "corner"})
    ASSERT_NE(mesh.find_group(group), nullptr) << group;
  EXPECT_EQ(mesh.find_group("body")->vertices.size(), mesh.vertices.size());
  EXPECT_EQ(mesh.find_group("corner")->vertices.size(), 1u);
  EXPECT_EQ(coordinate_sum("left", 0), 0);
  EXPECT_EQ(coordinate_sum("rim", 0), 0);
  EXPECT_GT(coordinate_sum("rim", 1), 0);
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(coordinate_sum("corner", axis), 0);
}

INSTANTIATE_TEST_SUITE_P(OfEveryVersion, GmshFile,
                         ::testing::Values("cube_22_ascii.msh", "cube_22_binary.msh", "cube_40_ascii.msh",
                                           "cube_41_ascii.msh", "cube_41_binary.msh", "cube_p2_41_ascii.msh",
                                           "cube_p2_41_binary.msh"),
                         test_name);

class SecondOrderFile : public ::testing::TestWithParam<std::string> {};

/// VTK and MSH order the last two edges differently; read, both are in the order of MSH.
TEST_P(SecondOrderFile, HasItsMiddleNodesInTheMiddle) {
  const Mesh mesh = read_mesh(file(GetParam())).mesh;
  const CellBlock* block = mesh.find_block(CellKind::tetrahedron10);
  ASSERT_NE(block, nullptr);
  ASSERT_EQ(block->num_cells(), 24);
  constexpr std::array<std::array<std::size_t, 2>, 6> edge_corners = {
      {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}}};
  for (Index cell = 0; cell < block->num_cells(); ++cell) {
    const auto X = [&](std::size_t n) {
      return mesh.vertices[static_cast<std::size_t>(block->cell(cell)[n])];
    };
    for (std::size_t e = 0; e < 6; ++e) {
      EXPECT_LT((X(4 + e) - 0.5 * (X(edge_corners[e][0]) + X(edge_corners[e][1]))).norm(), 1e-12)
          << cell << ' ' << e;
    }
  }
}

TEST_P(SecondOrderFile, IsASolidAsItIs) {
  const MeshFile cube = read_solid_mesh(file(GetParam()), 3);
  EXPECT_TRUE(cube.warnings.empty());
  EXPECT_NE(cube.mesh.find_block(CellKind::tetrahedron10), nullptr);
}

TEST_P(SecondOrderFile, IsUsedByItsCornersWithAWarningWhenAsked) {
  MeshFile cube = read_mesh(file(GetParam()));
  use_corners_only(cube);
  prepare_solid_mesh(cube, 3);
  EXPECT_NEAR(volume(cube.mesh), 1, 1e-12);
  ASSERT_FALSE(cube.warnings.empty());
  EXPECT_THAT(cube.warnings[0], ::testing::HasSubstr("second-order"));
}

INSTANTIATE_TEST_SUITE_P(OfEveryFormat, SecondOrderFile,
                         ::testing::Values("cube_p2_41_ascii.msh", "cube_p2_41_binary.msh",
                                           "cube_p2_42_binary.vtk", "cube_p2_51_binary.vtk",
                                           "cube_p2_raw.vtu"),
                         test_name);

class FieldFile : public ::testing::TestWithParam<std::string> {};

TEST_P(FieldFile, GivesItsCellField) {
  const Mesh mesh = read_mesh(file(GetParam())).mesh;
  ASSERT_EQ(mesh.cell_fields.size(), 1u);
  EXPECT_EQ(mesh.cell_fields[0].name, "young");
  for (std::size_t i = 0; i < 24; ++i)
    EXPECT_EQ(mesh.cell_fields[0].values[i], 1000.0 + static_cast<double>(i));
}

INSTANTIATE_TEST_SUITE_P(OfVtk, FieldFile,
                         ::testing::Values("cube_42_ascii.vtk", "cube_42_binary.vtk", "cube_51_ascii.vtk",
                                           "cube_51_binary.vtk", "cube_ascii.vtu", "cube_base64.vtu",
                                           "cube_inline.vtu", "cube_raw.vtu"),
                         test_name);

TEST(VtuOfVtk, GivesItsPointVectors) {
  for (const char* name :
       {"cube_ascii.vtu", "cube_base64.vtu", "cube_inline.vtu", "cube_raw.vtu", "cube_compressed.vtu"}) {
    const VtuContent content = read_vtu(file(name));
    ASSERT_EQ(content.point_data.size(), 1u) << name;
    const VtuValues& velocity = content.point_data[0];
    EXPECT_EQ(velocity.name, "velocity");
    ASSERT_EQ(velocity.components, 3);
    for (std::size_t v = 0; v < content.file.mesh.vertices.size(); ++v) {
      for (int i = 0; i < 3; ++i) {
        // Twice the position, in single precision.
        EXPECT_NEAR(velocity.values[3 * v + static_cast<std::size_t>(i)],
                    2 * content.file.mesh.vertices[v][i], 1e-6);
      }
    }
  }
}

TEST(VtuOfVtk, IsRefusedInWordsWhereItsCompressionIsUnknownOrDamaged) {
  std::ifstream stream(file("cube_compressed.vtu"), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  const auto refusal = [](const std::string& changed) {
    try {
      read_vtu_from_memory("a.vtu", changed);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal(bytes), "");
  std::string other = bytes;
  other.replace(other.find("ZLib"), 4, "LZ4_");
  EXPECT_THAT(refusal(other), ::testing::HasSubstr("a.vtu: compressor: expected vtkZLibDataCompressor"));
  const std::size_t data = bytes.find('_', bytes.find("<AppendedData")) + 1;
  const std::size_t end = bytes.find_last_not_of(" \n", bytes.rfind("</AppendedData>") - 1);
  for (std::size_t cut = data; cut <= end; cut += 97) EXPECT_NE(refusal(bytes.substr(0, cut)), "") << cut;
  std::string damaged = bytes;
  damaged[data + 60] = damaged[data + 60] == 'A' ? 'B' : 'A';
  EXPECT_NE(refusal(damaged), "");
}

}  // namespace
}  // namespace resilin
