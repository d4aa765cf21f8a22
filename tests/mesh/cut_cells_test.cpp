#include "resilin/mesh/cut_cells.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "resilin/mesh/check.hpp"
#include "resilin/mesh/collapsed_cell.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/quality.hpp"

namespace resilin {
namespace {

double volume_of(const Mesh& mesh, CellKind kind) {
  const auto volumes = signed_volumes(mesh, *mesh.find_block(kind));
  return std::accumulate(volumes.begin(), volumes.end(), 0.0);
}

/// The corners of a cube: x first, then y, then z.
const std::array<Index, 8> cube = {0, 1, 3, 2, 4, 5, 7, 6};
Mesh corners_of_cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.vertices.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
  return mesh;
}

TEST(CutCells, OfABlockOfHexahedraFitTogether) {
  Mesh mesh = make_hexahedron_box({2, 3, 1}, {2, 3, 2});
  mesh.vertices.insert(mesh.vertices.end(), {{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}});
  const auto first = static_cast<Index>(mesh.vertices.size()) - 4;
  mesh.block(CellKind::tetrahedron).nodes = {first, first + 1, first + 2, first + 3};
  Numbering numbering;
  EXPECT_EQ(cut_into_simplices(mesh, 3, numbering), "12 hexahedra are cut into 73 tetrahedra");
  EXPECT_EQ(mesh.find_block(CellKind::hexahedron), nullptr);
  EXPECT_NEAR(volume_of(mesh, CellKind::tetrahedron), 6 + 1.0 / 6, 1e-12);
  const MeshReport report = check_mesh(mesh, 3, numbering);  // no overlap, no side of three cells
  EXPECT_TRUE(report.errors.empty());
  for (const MeshIssue& warning : report.warnings)
    EXPECT_THAT(warning.text(), ::testing::HasSubstr("component"));
}

TEST(CutCells, CarryGroupsFieldsAndNumbers) {
  Mesh mesh = corners_of_cube();
  mesh.vertices.emplace_back(0.5, 0.5, 2);
  mesh.blocks = {{CellKind::hexahedron, {cube.begin(), cube.end()}}, {CellKind::pyramid, {4, 5, 7, 6, 8}}};
  mesh.groups = {{"hex", {{0}}, {0, 1, 2, 3, 4, 5, 6, 7}}, {"top", {{}, {0}}, {4, 5, 6, 7, 8}}};
  mesh.cell_fields = {{"young", 0, {1}}, {"young", 1, {2}}, {"only", 0, {3}}};
  Numbering numbering;
  numbering.cells = {{10}, {20}};
  EXPECT_EQ(cut_into_simplices(mesh, 3, numbering), "1 hexahedra and 1 pyramids are cut into 8 tetrahedra");
  EXPECT_NEAR(volume_of(mesh, CellKind::tetrahedron), 1 + 1.0 / 3, 1e-12);
  EXPECT_EQ(mesh.groups[0].cells, (std::vector<std::vector<Index>>{{0, 1, 2, 3, 4, 5}}));
  EXPECT_EQ(mesh.groups[1].cells, (std::vector<std::vector<Index>>{{6, 7}}));
  ASSERT_EQ(mesh.cell_fields.size(), 1u);
  EXPECT_EQ(mesh.cell_fields[0].values, (std::vector<double>{1, 1, 1, 1, 1, 1, 2, 2}));
  EXPECT_EQ(numbering.cell(0, 5), 10);
  EXPECT_EQ(numbering.cell(0, 6), 20);
}

TEST(CutCells, LeaveCellsOfOneKindAlone) {
  for (Mesh mesh : {make_box({1, 1, 1}, {1, 1, 1}), make_hexahedron_box({1, 1, 1}, {1, 1, 1})}) {
    Numbering numbering;
    EXPECT_EQ(cut_into_simplices(mesh, 3, numbering), "");
  }
}

TEST(CutCells, TakeTheDiagonalOfAQuadrilateralThatDoesNotFoldIt) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 1, 0}, {0, 3, 0}, {-1, 1, 0}, {0, 0.5, 0}};
  mesh.blocks = {{CellKind::quadrilateral, {4, 1, 2, 3}}, {CellKind::triangle, {0, 1, 4}}};
  Numbering numbering;
  cut_into_simplices(mesh, 2, numbering);
  const auto areas = signed_volumes(mesh, *mesh.find_block(CellKind::triangle));
  EXPECT_EQ(areas.size(), 3u);
  for (const double area : areas) EXPECT_GT(area, 0);
}

struct Collapse {
  std::array<Index, 8> nodes;
  CellKind kind;
  double volume;
};

/// Hexahedra whose edges are collapsed, in the ways that programs give wedges, pyramids and tetrahedra.
TEST(CollapsedHexahedron, IsTheCellOfItsCorners) {
  const std::vector<Collapse> cases = {
      {{0, 1, 3, 3, 4, 5, 7, 7}, CellKind::prism, 0.5},        // wedge upright
      {{0, 1, 3, 0, 4, 5, 7, 4}, CellKind::prism, 0.5},        //
      {{0, 1, 3, 2, 4, 5, 5, 4}, CellKind::prism, 0.5},        // roof
      {{0, 1, 3, 2, 4, 4, 4, 4}, CellKind::pyramid, 1.0 / 3},  //
      {{0, 1, 2, 2, 4, 4, 4, 4}, CellKind::tetrahedron, 1.0 / 6},
  };
  for (const Collapse& c : cases) {
    const auto cell = cell_of_different_corners(CellKind::hexahedron, c.nodes);
    ASSERT_TRUE(cell.has_value());
    EXPECT_EQ(cell->kind, c.kind);
    Mesh mesh = corners_of_cube();
    mesh.blocks = {{cell->kind, {cell->all().begin(), cell->all().end()}}};
    Numbering numbering;
    EXPECT_EQ(cut_into_simplices(mesh, 3, numbering).empty(), c.kind == CellKind::tetrahedron);
    EXPECT_NEAR(volume_of(mesh, CellKind::tetrahedron), c.volume, 1e-12) << name(c.kind);
    for (const double volume : signed_volumes(mesh, *mesh.find_block(CellKind::tetrahedron)))
      EXPECT_GT(volume, 0);
  }
}

/// Its bent side goes along the diagonal from vertex 0: 1/6 less than the hull of its corners, which has 5/6.
TEST(CollapsedHexahedron, WithOneEdgeCollapsedIsCut) {
  Mesh mesh = corners_of_cube();
  mesh.blocks = {{CellKind::hexahedron, {0, 1, 3, 2, 4, 5, 7, 7}}};
  Numbering numbering;
  cut_into_simplices(mesh, 3, numbering);
  EXPECT_NEAR(volume_of(mesh, CellKind::tetrahedron), 4.0 / 6, 1e-12);
}

TEST(CollapsedCell, StaysWhatItIsWhereAllCornersDifferOrNothingIsLeft) {
  EXPECT_FALSE(cell_of_different_corners(CellKind::hexahedron, cube).has_value());
  EXPECT_FALSE(cell_of_different_corners(CellKind::hexahedron, std::array<Index, 8>{0, 0, 1, 1, 0, 0, 1, 1})
                   .has_value());
  EXPECT_FALSE(
      cell_of_different_corners(CellKind::quadrilateral, std::array<Index, 4>{0, 1, 0, 2}).has_value());
  const auto triangle = cell_of_different_corners(CellKind::quadrilateral, std::array<Index, 4>{0, 1, 2, 0});
  ASSERT_TRUE(triangle.has_value());
  EXPECT_EQ(triangle->kind, CellKind::triangle);
}

}  // namespace
}  // namespace resilin
