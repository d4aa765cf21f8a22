#include "resilin/mesh/generators.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/mesh/quality.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

double total(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

TEST(Box, NodeNumbersRunFirstAlongX) {
  const Mesh box = make_box({2, 3, 4}, {2, 3, 4}, {10, 20, 30});
  ASSERT_EQ(box.vertices.size(), 3u * 4 * 5);
  const auto node = [](int i, int j, int k) { return static_cast<std::size_t>(i + 3 * (j + 4 * k)); };
  EXPECT_EQ(box.vertices[node(0, 0, 0)], Vector3(10, 20, 30));
  EXPECT_EQ(box.vertices[node(1, 0, 0)], Vector3(11, 20, 30));
  EXPECT_EQ(box.vertices[node(2, 3, 4)], Vector3(12, 23, 34));
  EXPECT_EQ(box.vertices[node(1, 2, 3)], Vector3(11, 22, 33));
}

TEST(Box, FollowsTheKuhnRecipeCellByCell) {
  const Mesh box = make_box({1, 1, 1}, {1, 1, 1});
  const CellBlock& tets = *box.find_block(CellKind::tetrahedron);
  const std::vector<Index> recipe = {0, 1, 3, 7, 0, 1, 7, 5, 0, 5, 7, 4, 0, 3, 2, 7, 0, 2, 6, 7, 0, 6, 4, 7};
  EXPECT_EQ(tets.nodes, recipe);
}

/// The pieces fill the box: positive volumes that add up, and a boundary with the area of the six sides.
void expect_fills_the_box(TetPattern pattern, Index tets_per_cube) {
  const Mesh box = make_box({2, 3, 4}, {3, 2, 4}, {-1, 0, 5}, pattern);
  const CellBlock& tets = *box.find_block(CellKind::tetrahedron);
  const CellBlock& sides = *box.find_block(CellKind::triangle);
  EXPECT_EQ(tets.num_cells(), 3 * 2 * 4 * tets_per_cube);
  const std::vector<double> volumes = signed_volumes(box, tets);
  EXPECT_GT(*std::min_element(volumes.begin(), volumes.end()), 0);
  EXPECT_NEAR(total(volumes), 24, 24e-14);  // 144 additions of rounded numbers
  EXPECT_EQ(sides.num_cells(), 2 * 2 * (3 * 2 + 2 * 4 + 3 * 4));
  EXPECT_NEAR(total(triangle_areas(box, sides)), 2 * (2 * 3 + 3 * 4 + 2 * 4), 52e-14);
}

TEST(Box, IsFilledBySixTetrahedraPerCube) { expect_fills_the_box(TetPattern::kuhn6, 6); }
TEST(Box, IsFilledByFiveTetrahedraPerCubeThatFitTheirNeighbours) {
  expect_fills_the_box(TetPattern::five, 5);
}

TEST(Box, SidesAreGroupsThatPointOutwards) {
  const Mesh box = make_box({1, 1, 1}, {2, 2, 2});
  const CellBlock& sides = *box.find_block(CellKind::triangle);
  for (const auto& [name, normal] :
       {std::pair{"x_min", Vector3(-1, 0, 0)}, std::pair{"x_max", Vector3(1, 0, 0)},
        std::pair{"y_min", Vector3(0, -1, 0)}, std::pair{"y_max", Vector3(0, 1, 0)},
        std::pair{"z_min", Vector3(0, 0, -1)}, std::pair{"z_max", Vector3(0, 0, 1)}}) {
    const Group* side = box.find_group(name);
    ASSERT_NE(side, nullptr) << name;
    EXPECT_EQ(side->vertices.size(), 9u);
    ASSERT_EQ(side->cells[1].size(), 8u);
    Vector3 area = Vector3::Zero();
    for (const Index facet : side->cells[1]) {
      const auto nodes = sides.cell(facet);
      const auto X = [&](std::size_t i) { return box.vertices[static_cast<std::size_t>(nodes[i])]; };
      area += 0.5 * (X(1) - X(0)).cross(X(2) - X(0));
    }
    EXPECT_LT((area - normal).norm(), 1e-14) << name;
  }
  EXPECT_EQ(box.find_group("body")->cells[0].size(), 48u);
  EXPECT_EQ(box.find_group("body")->vertices.size(), 27u);
}

TEST(Box, LastPlaneIsExactlyAtOriginPlusSize) {
  const Mesh box = make_box({0.1, 0.7, 1}, {7, 3, 49});
  EXPECT_EQ(box.vertices.back(), Vector3(0.1, 0.7, 1));
}

TEST(Box, RefusesSizesAndCountsThatMakeNoBox) {
  EXPECT_THROW(make_box({0, 1, 1}, {1, 1, 1}), InputError);
  EXPECT_THROW(make_box({1, -1, 1}, {1, 1, 1}), InputError);
  EXPECT_THROW(make_box({1, 1, std::nan("")}, {1, 1, 1}), InputError);
  EXPECT_THROW(make_box({1, 1, 1}, {1, 0, 1}), InputError);
  EXPECT_THROW(make_box({1, 1, 1}, {100000, 100000, 100000}), InputError);
  EXPECT_THROW(make_rectangle({1, 1}, {1, 0}), InputError);
}

TEST(Rectangle, SplitsEveryQuadAlongTheSameDiagonal) {
  const Mesh mesh = make_rectangle({2, 1}, {2, 1}, {5, 6});
  EXPECT_EQ(mesh.find_block(CellKind::triangle)->nodes,
            (std::vector<Index>{0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4}));
  EXPECT_EQ(mesh.vertices[4], Vector3(6, 7, 0));
}

TEST(Rectangle, AlternatesDiagonalsOnRequest) {
  const Mesh mesh = make_rectangle({2, 1}, {2, 1}, {0, 0}, TrianglePattern::alternating);
  EXPECT_EQ(mesh.find_block(CellKind::triangle)->nodes,
            (std::vector<Index>{0, 1, 4, 0, 4, 3, 1, 2, 4, 2, 5, 4}));
  const auto areas = signed_volumes(mesh, *mesh.find_block(CellKind::triangle));
  EXPECT_GT(*std::min_element(areas.begin(), areas.end()), 0);
}

TEST(Rectangle, SidesAreGroupsOfLinesWithTheBodyOnTheirLeft) {
  const Mesh mesh = make_rectangle({3, 2}, {3, 2});
  const CellBlock& lines = *mesh.find_block(CellKind::line);
  const Group* right = mesh.find_group("x_max");
  ASSERT_NE(right, nullptr);
  ASSERT_EQ(right->cells[1].size(), 2u);
  for (const Index line : right->cells[1]) {
    const auto nodes = lines.cell(line);
    EXPECT_LT(mesh.vertices[static_cast<std::size_t>(nodes[0])].y(),
              mesh.vertices[static_cast<std::size_t>(nodes[1])].y());
  }
  EXPECT_EQ(mesh.find_group("y_min")->vertices, (std::vector<Index>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.find_group("z_min"), nullptr);
}

}  // namespace
}  // namespace resilin
