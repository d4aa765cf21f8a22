#include "resilin/mesh/edit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/quality.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

TEST(Reorient, MendsInvertedCellsAndLeavesTheOthersAlone) {
  Mesh box = make_box({1, 1, 1}, {2, 2, 2});
  const std::vector<Index> good = box.blocks[0].nodes;
  std::swap(box.blocks[0].nodes[0], box.blocks[0].nodes[1]);
  EXPECT_EQ(reorient(box, CellKind::tetrahedron), (std::vector<Index>{0}));
  const auto volumes = signed_volumes(box, box.blocks[0]);
  EXPECT_GT(*std::min_element(volumes.begin(), volumes.end()), 0);
  EXPECT_TRUE(std::equal(good.begin() + 4, good.end(), box.blocks[0].nodes.begin() + 4));
  EXPECT_TRUE(reorient(box, CellKind::tetrahedron).empty());
  EXPECT_TRUE(reorient(box, CellKind::triangle6).empty());
}

/// A tetrahedron of ten nodes whose middle nodes sit in the middle of the edges that MSH says.
bool has_nodes_in_the_middle(const Mesh& mesh) {
  constexpr std::array<std::array<std::size_t, 2>, 6> edge_corners = {
      {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}}};
  const auto X = [&](std::size_t n) {
    return mesh.vertices[static_cast<std::size_t>(mesh.blocks[0].nodes[n])];
  };
  for (std::size_t e = 0; e < 6; ++e) {
    if (X(4 + e) != 0.5 * (X(edge_corners[e][0]) + X(edge_corners[e][1]))) return false;
  }
  return true;
}

TEST(Reorient, TakesSecondOrderNodesAlong) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {0, 2, 0}, {2, 0, 0}, {0, 0, 2}, {0, 1, 0},
                   {1, 1, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  mesh.blocks = {{CellKind::tetrahedron10, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}}};
  ASSERT_TRUE(has_nodes_in_the_middle(mesh));
  EXPECT_EQ(reorient(mesh, CellKind::tetrahedron10).size(), 1u);
  EXPECT_GT(signed_volumes(mesh, mesh.blocks[0])[0], 0);
  EXPECT_TRUE(has_nodes_in_the_middle(mesh));
}

TEST(FirstOrder, KeepsTheCorners) {
  Mesh mesh;
  mesh.vertices.resize(10);
  mesh.blocks = {{CellKind::tetrahedron10, {9, 8, 7, 6, 5, 4, 3, 2, 1, 0}}};
  EXPECT_TRUE(to_first_order(mesh));
  EXPECT_EQ(mesh.blocks[0].kind, CellKind::tetrahedron);
  EXPECT_EQ(mesh.blocks[0].nodes, (std::vector<Index>{9, 8, 7, 6}));
  EXPECT_FALSE(to_first_order(mesh));
}

TEST(UnusedNodes, AreDroppedFromVerticesAndGroups) {
  Mesh mesh;
  mesh.vertices = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {8, 8, 8}, {0, 1, 0}};
  mesh.blocks = {{CellKind::triangle, {1, 2, 4}}};
  mesh.groups = {{"some", {}, {0, 1, 4}}};
  EXPECT_EQ(remove_unused_nodes(mesh), (std::vector<Index>{-1, 0, 1, -1, 2}));
  EXPECT_EQ(mesh.vertices.size(), 3u);
  EXPECT_EQ(mesh.blocks[0].nodes, (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(mesh.groups[0].vertices, (std::vector<Index>{0, 2}));
}

TEST(DuplicateVertices, AreMergedOnRequest) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.blocks = {{CellKind::triangle, {0, 1, 2, 3, 5, 4}}};
  EXPECT_EQ(connected_components(mesh.blocks[0], 6).count, 2);
  EXPECT_EQ(merge_duplicate_vertices(mesh), (std::vector<Index>{0, 1, 2, 1, 2, 3}));
  EXPECT_EQ(mesh.blocks[0].nodes, (std::vector<Index>{0, 1, 2, 1, 3, 2}));
  EXPECT_EQ(connected_components(mesh.blocks[0], 4).count, 1);
}

TEST(Surface, OfABoxHasItsBoundaryVertices) {
  const Mesh box = make_box({1, 1, 1}, {3, 3, 3});
  const Surface surface = extract_surface(box);
  EXPECT_EQ(surface.mesh.vertices.size(), 64u - 8u);
  EXPECT_EQ(surface.mesh.blocks[0].num_cells(), 6 * 9 * 2);
  for (std::size_t v = 0; v < surface.volume_vertices.size(); ++v) {
    EXPECT_EQ(surface.mesh.vertices[v], box.vertices[static_cast<std::size_t>(surface.volume_vertices[v])]);
  }
  EXPECT_THROW(extract_surface(Mesh{}), InputError);
}

TEST(Transform, RotatesByTheRightHand) {
  Mesh mesh;
  mesh.vertices = {{1, 0, 0}};
  transform(mesh, 2 * rotation_matrix({0, 0, 5}, 90), {0, 0, 1});
  EXPECT_LT((mesh.vertices[0] - Vector3(0, 2, 1)).norm(), 1e-15);
  EXPECT_THROW(rotation_matrix({0, 0, 0}, 90), InputError);
}

TEST(BoundingBox, LeavesOutVerticesThatNoCellUses) {
  Mesh mesh;
  mesh.vertices = {{9, 9, 9}, {-1, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  mesh.blocks = {{CellKind::triangle, {1, 2, 3}}};
  EXPECT_EQ(bounding_box(mesh).min, Vector3(-1, 0, 0));
  EXPECT_EQ(bounding_box(mesh).max, Vector3(1, 2, 0));
}

}  // namespace
}  // namespace resilin
