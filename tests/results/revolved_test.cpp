// Axisymmetric frames as revolved bodies: volumes, fields, what is refused.

#include "resilin/results/revolved.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "resilin/core/error.hpp"
#include "resilin/element/axisymmetric.hpp"
#include "run_into.hpp"
#include "small_scenes.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

const VtuValues& array_of(const std::vector<VtuValues>& arrays, const std::string& name) {
  return *std::ranges::find(arrays, name, &VtuValues::name);
}

std::string refusal(const std::filesystem::path& folder) {
  try {
    write_revolved(folder, {});
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

/// Radii 1 to 2, heights 0 to 1: a quadrilateral below half of the height, above it triangles, linear or of
/// second order.
VtuContent section(CellKind triangles) {
  VtuContent content;
  Mesh& mesh = content.file.mesh;
  mesh.vertices = {{1, 0, 0}, {2, 0, 0}, {2, 0.5, 0}, {1, 0.5, 0}, {2, 1, 0}, {1, 1, 0}};
  mesh.block(CellKind::quadrilateral).nodes = {0, 1, 2, 3};
  std::vector<Index>& nodes = mesh.block(triangles).nodes;
  for (const std::array<Index, 3>& corners : {std::array<Index, 3>{3, 2, 4}, {3, 4, 5}}) {
    nodes.insert(nodes.end(), corners.begin(), corners.end());
    if (triangles == CellKind::triangle) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      nodes.push_back(static_cast<Index>(mesh.vertices.size()));
      const auto place = [&](Index node) { return mesh.vertices[static_cast<std::size_t>(node)]; };
      mesh.vertices.push_back(0.5 * (place(corners[k]) + place(corners[(k + 1) % 3])));
    }
  }
  content.cell_data.push_back({"body", 1, {7, 8, 9}});
  VtuValues stress{"cauchy_stress", 9, {}}, principal{"principal_stress", 3, {}},
      motion{"displacement", 3, {}};
  for (int cell = 0; cell < 3; ++cell) {
    stress.values.insert(stress.values.end(), {5, 1, 0, 1, 2, 0, 0, 0, 3});
    principal.values.insert(principal.values.end(), {3, 2, 1});
  }
  for (const Vector3& place : mesh.vertices) motion.values.insert(motion.values.end(), {place.x(), 4, 0});
  content.cell_data.push_back(stress);
  content.cell_data.push_back(principal);
  content.point_data.push_back(motion);
  return content;
}

/// Volume of a cell from its faces, with the outward normals that VTK's order gives.
double volume(const CellBlock& block, Index cell, const std::vector<Vector3>& vertices) {
  using Face = std::vector<std::size_t>;
  const std::vector<Face> faces =
      block.kind == CellKind::prism
          ? std::vector<Face>{{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}
          : std::vector<Face>{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                              {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  const auto at = [&](std::size_t corner) {
    return vertices[static_cast<std::size_t>(block.cell(cell)[corner])];
  };
  double sum = 0;
  for (const Face& face : faces)
    for (std::size_t k = 2; k < face.size(); ++k)
      sum += at(face[0]).dot(at(face[k - 1]).cross(at(face[k]))) / 6;
  return sum;
}

TEST(Revolved, FillsTheTurnWithoutInvertedCells) {
  for (const CellKind triangles : {CellKind::triangle, CellKind::triangle6})
    for (const double angle : {90., 270., 360.}) {
      const int sectors = 20;
      const VtuContent body = revolved(section(triangles), {.angle = angle, .sectors = sectors});
      double sum = 0;
      for (const CellBlock& block : body.file.mesh.blocks)
        for (Index i = 0; i < block.num_cells(); ++i) {
          const double own = volume(block, i, body.file.mesh.vertices);
          EXPECT_GT(own, 0);
          sum += own;
        }
      const double sector = angle / sectors * std::numbers::pi / 180;
      EXPECT_NEAR(sum, sectors * std::sin(sector) / 2 * (4 - 1), 1e-12);  // chords, not arcs
      for (const VtuValues& array : body.point_data)
        EXPECT_EQ(array.values.size(),
                  body.file.mesh.vertices.size() * static_cast<std::size_t>(array.components));
    }
}

TEST(Revolved, TurnsVectorsAndTensorsWithTheSection) {
  const VtuContent body = revolved(section(CellKind::triangle), {.angle = 270, .sectors = 9});
  const std::vector<double>& motion = array_of(body.point_data, "displacement").values;
  for (std::size_t v = 0; v < body.file.mesh.vertices.size(); ++v) {
    const Vector3& place = body.file.mesh.vertices[v];
    const Vector3 expected(place.x(), 4, place.z());  // radial, as long as the radius, and up
    EXPECT_LT((Eigen::Map<const Vector3>(&motion[3 * v]) - expected).norm(), 1e-12);
  }
  const std::vector<double>& stress = array_of(body.cell_data, "cauchy_stress").values;
  const std::vector<double>& principal = array_of(body.cell_data, "principal_stress").values;
  const std::vector<double>& numbers = array_of(body.cell_data, "body").values;
  std::size_t cell = 0;
  for (const CellBlock& block : body.file.mesh.blocks)
    for (Index i = 0; i < block.num_cells(); ++i, ++cell) {
      Vector3 middle = Vector3::Zero();
      for (const Index node : block.cell(i))
        middle += body.file.mesh.vertices[static_cast<std::size_t>(node)];
      const Vector3 radial = Vector3(middle.x(), 0, middle.z()).normalized(), up = Vector3::UnitY();
      const Eigen::Map<const Matrix<3>> sigma(&stress[9 * cell]);
      EXPECT_NEAR(radial.dot(sigma * radial), 5, 1e-12);
      EXPECT_NEAR(radial.dot(sigma * up), 1, 1e-12);
      EXPECT_NEAR(radial.cross(up).dot(sigma * radial.cross(up)), 3, 1e-12) << "hoop stress";
      EXPECT_EQ(principal[3 * cell], 3);
      const double own = block.kind == CellKind::hexahedron ? 7 : i < 9 ? 8 : 9;
      EXPECT_EQ(numbers[cell], own) << "number of its cell in the section";
    }
}

TEST(Revolved, FramesOfARunAreWrittenBesideIt) {
  const TemporaryFolder folder;
  Description scene = small_bar(2, false);
  run_into(folder / "plane", scene, 0);
  EXPECT_THAT(refusal(folder / "plane"),
              ::testing::HasSubstr("expected an axisymmetric run, got a plane one"));
  EXPECT_THAT(refusal(folder / "none"), ::testing::HasSubstr("the folder of a run"));
  scene.bodies[0].element = axisymmetric_name("P1");
  scene.colliders.emplace_back().shape = {.point = {0, -0.5, 0}, .normal = Vector3::UnitY()};
  run_into(folder / "ring", scene, 0);
  const std::size_t frames = write_revolved(folder / "ring", {.angle = 180, .sectors = 6});
  EXPECT_GT(frames, 1U);
  const VtuContent last = read_vtu(folder / "ring/revolved" / "0001.vtu");
  EXPECT_FALSE(last.file.mesh.blocks.empty());
  EXPECT_TRUE(std::filesystem::exists(folder / "ring/revolved.pvd"));
  // The line of the floor reaches beyond the axis; the half turn of a part there would be on the other side.
  EXPECT_TRUE(std::filesystem::exists(folder / "ring/revolved_colliders.pvd"));
  const Mesh floor = read_vtu(folder / "ring/revolved" / "collider_0000.vtu").file.mesh;
  ASSERT_FALSE(floor.blocks.empty());
  for (const CellBlock& block : floor.blocks)
    for (const Index node : block.nodes) {
      const Vector3& place = floor.vertices[static_cast<std::size_t>(node)];
      EXPECT_LT(place.z(), 1e-12);
      EXPECT_EQ(place.y(), -0.5);
    }
}

}  // namespace
}  // namespace resilin::testing
