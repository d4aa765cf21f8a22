#include "resilin/mesh/second_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "resilin/mesh/check.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

using ::testing::HasSubstr;

TEST(SecondOrder, AddsTheMiddleOfEveryEdgeAfterTheVertices) {
  const Mesh box = make_box({2, 1, 1}, {2, 1, 1});
  const SecondOrderMesh finer = second_order(box);
  const std::size_t num_edges = edges(box.blocks[0]).size();
  ASSERT_EQ(finer.mesh.vertices.size(), box.vertices.size() + num_edges);
  EXPECT_TRUE(std::ranges::is_sorted(finer.ends));
  for (std::size_t i = 0; i < finer.ends.size(); ++i) {
    const auto [a, b] = finer.ends[i];
    EXPECT_EQ(finer.mesh.vertices[box.vertices.size() + i],
              0.5 * (box.vertices[static_cast<std::size_t>(a)] + box.vertices[static_cast<std::size_t>(b)]));
  }
  EXPECT_EQ(finer.mesh.blocks[0].kind, CellKind::tetrahedron10);
  EXPECT_EQ(finer.mesh.blocks[1].kind, CellKind::triangle6);
  EXPECT_TRUE(check_mesh(finer.mesh, 3).errors.empty());
}

TEST(SecondOrder, GroupsTakeTheNodesOfTheirCells) {
  const Mesh finer = second_order(make_box({2, 1, 1}, {2, 1, 1})).mesh;
  const Group& side = *finer.find_group("x_max");
  EXPECT_EQ(side.vertices.size(), 9u);  // a square of two triangles: 4 corners, 5 edges
  for (const Index v : side.vertices) EXPECT_EQ(finer.vertices[static_cast<std::size_t>(v)].x(), 2);
}

/// A cube of one layer has an edge through its inside whose ends are corners of the surface.
TEST(SecondOrder, ASetOfSurfaceVerticesTakesNoNodeFromInside) {
  const Mesh box = make_box({1, 1, 1}, {1, 1, 1});
  const SecondOrderMesh finer = second_order(box);
  std::vector<bool> is_in_set(finer.mesh.vertices.size(), false);
  std::fill_n(is_in_set.begin(), box.vertices.size(), true);
  const std::vector<Index> between = middles_between(finer.mesh.blocks[0], is_in_set);
  EXPECT_EQ(between.size(), 18u);  // 19 edges, one of them the diagonal through the cube
  for (const Index node : between) {
    const Vector3& X = finer.mesh.vertices[static_cast<std::size_t>(node)];
    EXPECT_TRUE(((X.array() == 0) || (X.array() == 1)).any()) << X.transpose();
  }
}

TEST(SecondOrder, KeepsCurvedCells) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, -0.1, 0}, {0.5, 0.5, 0}, {0, 0.5, 0}};
  mesh.blocks = {{CellKind::triangle6, {0, 1, 2, 3, 4, 5}}, {CellKind::line, {0, 1}}};
  const SecondOrderMesh finer = second_order(mesh);
  EXPECT_TRUE(finer.ends.empty());
  EXPECT_EQ(finer.mesh.blocks[1].kind, CellKind::line3);
  EXPECT_EQ(finer.mesh.blocks[1].nodes, (std::vector<Index>{0, 1, 3}));
}

std::string first_error(const Mesh& mesh, int dim) {
  const MeshReport report = check_mesh(mesh, dim);
  return report.errors.empty() ? "" : report.errors[0].text();
}

TEST(SecondOrderCheck, NamesTheNodeThatStandsTooFarOff) {
  Mesh mesh = second_order(make_rectangle({1, 1}, {1, 1})).mesh;
  mesh.vertices[4] += Vector3(0.4, 0.4, 0);
  EXPECT_THAT(first_error(mesh, 2), HasSubstr("inverted: its Jacobian is"));
  EXPECT_THAT(first_error(mesh, 2),
              HasSubstr("node 4 stands 0.566 edge lengths from the middle of its edge"));
}

TEST(SecondOrderCheck, NamesAMissingNode) {
  Mesh mesh = second_order(make_box({1, 1, 1}, {1, 1, 1})).mesh;
  mesh.blocks[0].nodes[4] = mesh.blocks[0].nodes[0];
  EXPECT_THAT(first_error(mesh, 3), HasSubstr("node 0 twice: the node in the middle of edge 0-"));
}

TEST(SecondOrderCheck, RefusesCellsThatWouldComeApart) {
  Mesh mesh = second_order(make_rectangle({1, 1}, {1, 1})).mesh;
  mesh.vertices.push_back(mesh.vertices[static_cast<std::size_t>(mesh.blocks[0].nodes[5])]);
  mesh.blocks[0].nodes[5] = static_cast<Index>(mesh.vertices.size()) - 1;
  EXPECT_THAT(first_error(mesh, 2), HasSubstr("different nodes in the middle of edge 0-3"));
}

TEST(HexahedronCheck, TurnsAMirroredOneAndRefusesAnotherOrder) {
  Mesh mesh = make_hexahedron_box({1, 1, 1}, {1, 1, 1});
  EXPECT_EQ(first_error(mesh, 3), "");
  Mesh mirrored = mesh;
  turn_around(CellKind::hexahedron, mirrored.blocks[0].nodes);
  EXPECT_EQ(first_error(mirrored, 3), "");
  EXPECT_EQ(reorient(mirrored, CellKind::hexahedron).size(), 1u);
  EXPECT_EQ(mirrored.blocks[0].nodes, mesh.blocks[0].nodes);
  std::swap(mesh.blocks[0].nodes[2], mesh.blocks[0].nodes[3]);  // vertices row by row, as grids count
  std::swap(mesh.blocks[0].nodes[6], mesh.blocks[0].nodes[7]);
  EXPECT_NE(first_error(mesh, 3), "");
  std::swap(mesh.blocks[0].nodes[6], mesh.blocks[0].nodes[7]);
  EXPECT_THAT(first_error(mesh, 3), HasSubstr("not in the order of MSH"));
}

TEST(MixedCells, AreRefusedByName) {
  Mesh mesh = make_rectangle({1, 1}, {1, 1});
  mesh.blocks.push_back({CellKind::quadrilateral, {0, 1, 3, 2}});
  EXPECT_THAT(first_error(mesh, 2),
              HasSubstr("1 quadrilaterals beside triangles: a body has cells of one kind"));
}

}  // namespace
}  // namespace resilin
