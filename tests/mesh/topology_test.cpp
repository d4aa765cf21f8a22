#include "resilin/mesh/topology.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "every_element.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/generators.hpp"

namespace resilin {
namespace {

const CellBlock one_tet = {CellKind::tetrahedron, {0, 1, 2, 3}};
const std::vector<Vector3> unit_tet = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

TEST(Boundary, OfOneTetrahedronPointsOutwards) {
  const Boundary result = boundary(one_tet);
  ASSERT_EQ(result.facets.num_cells(), 4);
  const Vector3 center(0.25, 0.25, 0.25);
  for (Index f = 0; f < 4; ++f) {
    const auto nodes = result.facets.cell(f);
    const auto X = [&](std::size_t i) { return unit_tet[static_cast<std::size_t>(nodes[i])]; };
    EXPECT_GT((X(1) - X(0)).cross(X(2) - X(0)).dot(X(0) - center), 0) << f;
  }
}

TEST(Boundary, OfTwoTetrahedraLeavesOutTheSideThatTheyShare) {
  const Boundary result = boundary({CellKind::tetrahedron, {0, 1, 2, 3, 1, 2, 3, 4}});
  EXPECT_EQ(result.facets.num_cells(), 6);
  for (const Facet& owner : result.owners) EXPECT_FALSE(owner.cell == 0 && owner.local == 3);
}

TEST(Boundary, OfATriangleRunsAroundIt) {
  const Boundary result = boundary({CellKind::triangle, {4, 5, 6}});
  EXPECT_EQ(result.facets.kind, CellKind::line);
  EXPECT_EQ(result.facets.nodes, (std::vector<Index>{4, 5, 5, 6, 6, 4}));
}

TEST(Boundary, OfABoxIsClosed) {
  const Mesh box = make_box({1, 2, 3}, {3, 4, 2});
  const CellBlock facets = boundary(*box.find_block(CellKind::tetrahedron)).facets;
  // Every edge of a closed surface belongs to two triangles, and V - E + F = 2 for a sphere.
  visit_facets(facets, [](std::span<const Facet> uses) { EXPECT_EQ(uses.size(), 2u); });
  const auto is_used = used_vertices(facets, static_cast<Index>(box.vertices.size()));
  const auto num_used = std::count(is_used.begin(), is_used.end(), true);
  EXPECT_EQ(num_used - static_cast<std::ptrdiff_t>(edges(facets).size()) + facets.num_cells(), 2);
}

struct BoundaryOfEveryElement : OnEveryElement {};
INSTANTIATE_TEST_SUITE_P(Catalogue, BoundaryOfEveryElement, ::testing::ValuesIn(elements()), name_of_element);

/// Sides of the reference cell of every element: flat, facing outwards, with the nodes in the middle of edges
/// where they belong.
TEST_P(BoundaryOfEveryElement, PointsOutwardsWithAllItsNodes) {
  CellBlock cell{cell_kind(element), {}};
  Vector3 center = Vector3::Zero();
  for (int a = 0; a < element.num_nodes; ++a) {
    cell.nodes.push_back(a);
    center += element.nodes[static_cast<std::size_t>(a)] / element.num_nodes;
  }
  const Boundary result = boundary(cell);
  EXPECT_EQ(result.facets.num_cells(), static_cast<Index>(cell_sides(cell.kind).size()));
  for (Index f = 0; f < result.facets.num_cells(); ++f) {
    const auto nodes = result.facets.cell(f);
    const auto X = [&](std::size_t i) { return element.nodes[static_cast<std::size_t>(nodes[i])]; };
    const Vector3 edge = X(1) - X(0);
    const Vector3 normal = element.dim == 2 ? Vector3(edge.y(), -edge.x(), 0) : edge.cross(X(2) - X(0));
    EXPECT_GT(normal.dot(X(0) - center), 0) << f;
    for (std::size_t i = 0; i < nodes.size(); ++i) EXPECT_NEAR(normal.dot(X(i) - X(0)), 0, 1e-15);
    const auto middles = cell_edges(result.facets.kind);
    const auto corners = static_cast<std::size_t>(num_corners(result.facets.kind));
    for (std::size_t e = 0; corners + e < nodes.size(); ++e) {
      const auto [i, j] = middles[e];
      EXPECT_EQ(X(corners + e), 0.5 * (X(static_cast<std::size_t>(i)) + X(static_cast<std::size_t>(j))));
    }
  }
  const auto corners = static_cast<std::size_t>(element.num_corners());
  for (std::size_t e = 0; corners + e < element.nodes.size(); ++e) {
    const auto [i, j] = cell_edges(cell.kind)[e];
    EXPECT_EQ(element.nodes[corners + e], 0.5 * (element.nodes[static_cast<std::size_t>(i)] +
                                                 element.nodes[static_cast<std::size_t>(j)]));
  }
}

TEST(Edges, AreListedOnceAndSorted) {
  const auto result = edges({CellKind::tetrahedron, {3, 2, 1, 0, 1, 2, 3, 4}});
  EXPECT_EQ(result.size(), 9u);
  EXPECT_EQ(result.front(), (std::array<Index, 2>{0, 1}));
  EXPECT_TRUE(std::is_sorted(result.begin(), result.end()));
}

TEST(Edges, OfABoxSatisfyEulersFormula) {
  const Mesh box = make_box({1, 1, 1}, {2, 3, 4});
  const CellBlock& tets = *box.find_block(CellKind::tetrahedron);
  std::ptrdiff_t num_faces = 0;
  visit_facets(tets, [&](std::span<const Facet>) { ++num_faces; });
  const auto V = static_cast<std::ptrdiff_t>(box.vertices.size());
  const auto E = static_cast<std::ptrdiff_t>(edges(tets).size());
  EXPECT_EQ(V - E + num_faces - tets.num_cells(), 1);  // a ball
}

TEST(Components, AreNumberedInTheOrderOfTheirCells) {
  const CellBlock block = {CellKind::triangle, {5, 6, 7, 0, 1, 2, 2, 3, 0}};
  const Components result = connected_components(block, 9);
  EXPECT_EQ(result.count, 2);
  EXPECT_EQ(result.of_cell, (std::vector<Index>{0, 1, 1}));
  EXPECT_EQ(result.of_vertex, (std::vector<Index>{1, 1, 1, 1, -1, 0, 0, 0, -1}));
}

using Edges = std::vector<std::array<Index, 2>>;

TEST(Pinches, AreNotInSoundMeshes) {
  const Mesh boxes[] = {make_box({1, 1, 1}, {3, 2, 2}),
                        make_box({1, 1, 1}, {2, 2, 2}, {0, 0, 0}, TetPattern::five),
                        make_hexahedron_box({1, 1, 1}, {3, 2, 2}), make_rectangle({1, 1}, {3, 3}),
                        make_quadrilateral_rectangle({1, 1}, {2, 3})};
  for (const Mesh& mesh : boxes) {
    const CellBlock& block = *(mesh.find_solid(3) != nullptr ? mesh.find_solid(3) : mesh.find_solid(2));
    const Pinches pinches = find_pinches(block, static_cast<Index>(mesh.vertices.size()));
    EXPECT_TRUE(pinches.vertices.empty()) << name(block.kind);
    EXPECT_TRUE(pinches.edges.empty()) << name(block.kind);
  }
}

void expect_pinches(const CellBlock& block, const std::vector<Index>& vertices, const Edges& edges) {
  const Pinches pinches = find_pinches(block, 7);
  EXPECT_EQ(pinches.vertices, vertices) << name(block.kind);
  EXPECT_EQ(pinches.edges, edges) << name(block.kind);
}

TEST(Pinches, AreTheVerticesAndEdgesThroughWhichAloneCellsHangTogether) {
  using enum CellKind;
  expect_pinches({triangle, {0, 1, 2, 2, 3, 4}}, {2}, {});
  expect_pinches({quadrilateral, {0, 1, 2, 3, 2, 4, 5, 6}}, {2}, {});
  expect_pinches({triangle, {0, 1, 2, 2, 3, 4, 4, 5, 0}}, {0, 2, 4}, {});  // a ring of three
  expect_pinches({tetrahedron, {0, 1, 2, 3, 3, 4, 5, 6}}, {3}, {});
  expect_pinches({tetrahedron, {0, 1, 2, 3, 0, 1, 4, 5}}, {}, {{0, 1}});
  expect_pinches({tetrahedron, {0, 1, 2, 3, 1, 2, 3, 4}}, {}, {});  // a side in common
  expect_pinches({triangle, {0, 1, 2, 3, 4, 5}}, {}, {});           // nothing in common
}

/// Two boxes of hexahedra that have a corner or an edge in common, in any numbering of the vertices.
TEST(Pinches, AreFoundInAnyNumbering) {
  std::mt19937 random(7);
  for (int round = 0; round < 20; ++round) {
    const bool is_edge = round % 2 == 1;
    const auto tets = round % 4 < 2;
    Mesh a = tets ? make_box({1, 1, 1}, {2, 2, 2}) : make_hexahedron_box({1, 1, 1}, {2, 2, 2});
    const Vector3 corner(1, 1, is_edge ? 0 : 1);
    const Mesh b =
        tets ? make_box({1, 1, 1}, {2, 2, 2}, corner) : make_hexahedron_box({1, 1, 1}, {2, 2, 2}, corner);
    CellBlock& block = a.blocks[0];
    const auto shift = static_cast<Index>(a.vertices.size());
    for (const Index node : b.blocks[0].nodes) block.nodes.push_back(node + shift);
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    a.blocks.resize(1);
    a.groups.clear();
    merge_duplicate_vertices(a);
    std::vector<Index> number(a.vertices.size());
    std::iota(number.begin(), number.end(), 0);
    std::ranges::shuffle(number, random);
    std::vector<Vector3> place(number.size());
    for (std::size_t v = 0; v < number.size(); ++v)
      place[static_cast<std::size_t>(number[v])] = a.vertices[v];
    for (Index& node : a.blocks[0].nodes) node = number[static_cast<std::size_t>(node)];
    const Pinches pinches = find_pinches(a.blocks[0], static_cast<Index>(place.size()));
    EXPECT_EQ(pinches.vertices.size(), is_edge ? 0u : 1u);
    EXPECT_EQ(pinches.edges.size(), is_edge ? 2u : 0u);  // each half of the boxes' edge
    for (const Index v : pinches.vertices) EXPECT_EQ(place[static_cast<std::size_t>(v)], Vector3(1, 1, 1));
    for (const auto& edge : pinches.edges)
      for (const Index v : edge) EXPECT_EQ(place[static_cast<std::size_t>(v)].head<2>(), Vector<2>(1, 1));
  }
}

}  // namespace
}  // namespace resilin
