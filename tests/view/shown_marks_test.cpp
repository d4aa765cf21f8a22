#include "resilin/view/shown_marks.hpp"

#include <gtest/gtest.h>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

TEST(ShownMarks, AreTheSupportsLoadsAndProbesAtTheirVertices) {
  for (const int dim : {2, 3}) {
    Description scene = small_bar(dim, false);
    LoadDescription pull;
    pull.name = "pull";
    pull.kind = "nodal_force";
    pull.where.kind = Where::Kind::plane;
    pull.where.axis = 0;
    pull.where.at = 1;
    pull.value = {0, 3, 0};
    scene.loads.push_back(pull);
    const World world(scene);
    const ShownSurface surface(world);
    const std::vector<ShownMark> marks = shown_marks(world, surface);
    ASSERT_EQ(marks.size(), 3u);
    const auto place = [&](Index vertex, int axis) {
      return surface.rest_positions()[static_cast<std::size_t>(3 * vertex + axis)];
    };
    EXPECT_EQ(marks[0].kind, ShownMark::Kind::support);
    EXPECT_EQ(marks[0].name, "wall");
    EXPECT_EQ(marks[0].vertices.size(), dim == 3 ? 9u : 3u);
    for (const Index vertex : marks[0].vertices) EXPECT_EQ(place(vertex, 0), 0.0F);
    EXPECT_EQ(marks[1].kind, ShownMark::Kind::load);
    EXPECT_EQ(marks[1].name, "pull");
    EXPECT_NEAR(marks[1].greatest, 3, 1e-12);
    ASSERT_EQ(marks[1].directions.size(), marks[1].vertices.size());
    for (std::size_t i = 0; i < marks[1].vertices.size(); ++i) {
      EXPECT_EQ(place(marks[1].vertices[i], 0), 1.0F);
      EXPECT_LT((marks[1].directions[i] - Vector3::UnitY()).norm(), 1e-12);
    }
    EXPECT_EQ(marks[2].name, "tip");
    ASSERT_EQ(marks[2].vertices.size(), 1u);
    EXPECT_EQ(place(marks[2].vertices[0], 0), 1.0F);
    EXPECT_EQ(place(marks[2].vertices[0], 1), 0.25F);
  }
}

TEST(ShownSurface, FindsThePlaceThatWasTouched) {
  const World world(small_bar(3, true));
  const ShownSurface surface(world);
  const auto& [a, b, c] = surface.triangles()[5];
  const auto place = [&](std::uint32_t v) -> Vector3 {
    return Eigen::Map<const Eigen::Vector3f>(surface.rest_positions().data() + 3 * std::size_t{v})
        .cast<double>();
  };
  const Vector3 touched = 0.5 * place(a) + 0.3 * place(b) + 0.2 * place(c);
  for (const std::uint32_t corner : {a, b, c}) {
    const MaterialPoint found =
        surface.touched_place(static_cast<Index>(corner), touched, surface.rest_positions());
    EXPECT_LT((found.position(3, world.rest_positions) - touched).norm(), 1e-6);
  }
  for (Index node = 0; node < world.num_nodes(); ++node)
    EXPECT_EQ(surface.material_point(*surface.vertex_of(node)).nodes.front(), node);
  EXPECT_FALSE(surface.vertex_of(world.num_nodes()));
}

}  // namespace
}  // namespace resilin::testing
