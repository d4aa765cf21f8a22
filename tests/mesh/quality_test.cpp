#include "resilin/mesh/quality.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "resilin/mesh/edit.hpp"

namespace resilin {
namespace {

Mesh tet(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  Mesh mesh;
  mesh.vertices = {a, b, c, d};
  mesh.blocks = {{CellKind::tetrahedron, {0, 1, 2, 3}}};
  return mesh;
}

const Mesh unit = tet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});

TEST(Volume, OfTheUnitTetrahedronIsOneSixthAndChangesSignWithItsOrder) {
  EXPECT_DOUBLE_EQ(signed_volumes(unit, unit.blocks[0])[0], 1.0 / 6);
  const Mesh mirrored = tet({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  EXPECT_DOUBLE_EQ(signed_volumes(mirrored, mirrored.blocks[0])[0], -1.0 / 6);
}

TEST(CellSigns, TellFlatInvertedAndInfiniteCellsFromGoodOnes) {
  EXPECT_TRUE(cell_signs(unit, unit.blocks[0]).flat.empty());
  const Mesh flat = tet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0});
  EXPECT_EQ(cell_signs(flat, flat.blocks[0]).flat, (std::vector<Index>{0}));
  const Mesh inverted = tet({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  EXPECT_EQ(cell_signs(inverted, inverted.blocks[0]).inverted, (std::vector<Index>{0}));
  const Mesh huge = tet({0, 0, 0}, {1e200, 0, 0}, {0, 1e200, 0}, {0, 0, 1e200});
  EXPECT_EQ(cell_signs(huge, huge.blocks[0]).not_finite, (std::vector<Index>{0}));
}

TEST(CellSigns, DoNotDependOnTheUnitOfLength) {
  for (const double scale : {1e-9, 1e9}) {
    Mesh small = unit;
    transform(small, scale * Matrix<3>::Identity(), Vector3::Zero());
    EXPECT_TRUE(cell_signs(small, small.blocks[0]).flat.empty()) << scale;
    Mesh flat = tet({0, 0, 0}, {1, 0, 0.1}, {0, 1, 0.2}, {1, 1, 0.3});  // in the plane z = 0.1 x + 0.2 y
    transform(flat, scale * Matrix<3>::Identity(), Vector3::Zero());
    EXPECT_EQ(cell_signs(flat, flat.blocks[0]).flat.size(), 1u) << scale;
  }
}

TEST(CellSigns, AcceptASliverThatRoundingCannotFlatten) {
  const Mesh sliver = tet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1e-9});
  EXPECT_TRUE(cell_signs(sliver, sliver.blocks[0]).flat.empty());
}

TEST(DuplicateCells, AreFoundWhateverTheOrderOfTheirNodes) {
  const CellBlock block = {CellKind::tetrahedron, {0, 1, 2, 3, 1, 2, 3, 4, 3, 2, 1, 0, 2, 1, 0, 3}};
  EXPECT_EQ(duplicate_cells(block), (std::vector<std::pair<Index, Index>>{{0, 2}, {0, 3}}));
}

TEST(DuplicateVertices, AreThoseAtExactlyTheSamePlace) {
  Mesh mesh;
  mesh.vertices = {{1, 2, 3}, {0, 0, 0}, {1, 2, 3}, {1, 2, 3 + 1e-15}, {-0.0, 0, 0}};
  EXPECT_EQ(duplicate_vertices(mesh), (std::vector<std::pair<Index, Index>>{{0, 2}, {1, 4}}));
}

TEST(NonmanifoldEdges, AreSharedByThreeTriangles) {
  const CellBlock fan = {CellKind::triangle, {0, 1, 2, 1, 0, 3, 0, 1, 4}};
  EXPECT_EQ(nonmanifold_edges(fan), (std::vector<std::array<Index, 2>>{{0, 1}}));
}

TEST(ShapeQuality, IsOneForTheRegularTetrahedronAndTriangle) {
  const Mesh regular = tet({1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1});
  EXPECT_NEAR(std::abs(shape_qualities(regular, regular.blocks[0])[0]), 1, 1e-14);
  Mesh triangle;
  triangle.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}};
  triangle.blocks = {{CellKind::triangle, {0, 1, 2}}};
  EXPECT_NEAR(shape_qualities(triangle, triangle.blocks[0])[0], 1, 1e-14);
}

TEST(DihedralAngles, OfRegularRightAngledAndFlatTetrahedra) {
  Mesh mesh;
  mesh.vertices = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {0, 0, 0},
                   {1, 0, 0}, {0, 1, 0},   {0, 0, 1},   {1, 1, 1e-3}};
  CellBlock& cells = mesh.block(CellKind::tetrahedron);
  cells.nodes = {0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 8};
  const std::vector<double> angles = smallest_dihedral_angles(mesh, cells);
  EXPECT_NEAR(angles[0], 70.528779, 1e-6);                                 // arccos 1/3
  EXPECT_NEAR(angles[1], 54.735610, 1e-6);                                 // arctan sqrt 2
  EXPECT_NEAR(angles[2], std::atan(1e-3) * 180 / std::numbers::pi, 1e-6);  // a sliver
}

}  // namespace
}  // namespace resilin
