#include "resilin/mesh/refine_surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <utility>

#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/generators.hpp"

namespace resilin {
namespace {

TEST(RefineSurface, KeepsTheSurfaceWithoutGapsAndMakesEveryEdgeShort) {
  Mesh box = extract_surface(make_box({2, 1, 0.3}, {1, 1, 1})).mesh;
  box.groups.push_back({"first", {{0}}, {}});
  const Mesh first = box;
  const std::vector<Vector3>& before = first.vertices;
  for (const double longest : {0.7, 0.25}) {
    refine_surface(box, longest);
    ASSERT_GE(box.vertices.size(), before.size());
    for (std::size_t v = 0; v < before.size(); ++v) EXPECT_EQ(box.vertices[v], before[v]);
    std::map<std::pair<Index, Index>, int> uses;  // there is one and back one
    double volume = 0, area = 0, area_of_group = 0;
    const CellBlock& triangles = box.blocks[0];
    for (Index t = 0; t < triangles.num_cells(); ++t) {
      const auto c = triangles.cell(t);
      const auto X = [&](std::size_t i) { return box.vertices[static_cast<std::size_t>(c[i])]; };
      volume += X(0).dot(X(1).cross(X(2))) / 6;
      const double own = 0.5 * (X(1) - X(0)).cross(X(2) - X(0)).norm();
      area += own;
      if (std::ranges::find(box.groups[0].cells[0], t) != box.groups[0].cells[0].end()) area_of_group += own;
      for (std::size_t i = 0; i < 3; ++i) {
        ++uses[{c[i], c[(i + 1) % 3]}];
        EXPECT_LE((X(i) - X((i + 1) % 3)).norm(), longest);
      }
    }
    EXPECT_NEAR(volume, 0.6, 1e-14);
    EXPECT_NEAR(area, 2 * (2 + 0.6 + 0.3), 1e-13);
    for (const auto& [edge, count] : uses) {
      EXPECT_EQ(count, 1);
      EXPECT_TRUE(uses.contains({edge.second, edge.first}));
    }
    const auto corners = first.blocks[0].cell(0);
    const auto at = [&](std::size_t i) { return before[static_cast<std::size_t>(corners[i])]; };
    EXPECT_NEAR(area_of_group, 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm(), 1e-13);
  }
}

TEST(RefineSurface, EndsBeforeThereAreTooMany) {
  Mesh box = extract_surface(make_box({1, 1, 1}, {1, 1, 1})).mesh;
  refine_surface(box, 1e-9, 1000);
  EXPECT_LE(box.blocks[0].num_cells(), 1000);
  EXPECT_GT(box.blocks[0].num_cells(), 12);
}

}  // namespace
}  // namespace resilin
