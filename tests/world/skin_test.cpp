#include "resilin/world/skin.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "resilin/mesh/edit.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// The small bar with its own boundary, of finer cells, as skin, moved by `shift`.
Description bar_with_skin(const Vector3& shift = Vector3::Zero()) {
  Description scene = small_bar(3, true);
  SkinDescription skin{.place = "body[0].skin",
                       .surface = extract_surface(make_box({1, 0.25, 0.25}, {16, 4, 4})).mesh,
                       .surface_name = "fine.obj"};
  transform(skin.surface, Matrix<3>::Identity(), shift);
  scene.bodies[0].skin = skin;
  return scene;
}

TEST(Skin, IsPlacedWithTheMesh) {
  Description scene = bar_with_skin();
  BodyDescription& body = scene.bodies[0];
  body.scale = 2;
  body.rotate = Rotation{.axis = {1, 2, 3}, .center = {0.5, 0, 0}, .degrees = 50};
  body.translate = {3, 0, -1};
  scene.fixes.clear();
  scene.probes.clear();
  const World world(scene);
  const Skin& skin = *world.bodies[0].skin;
  EXPECT_EQ(skin.embedding.outside().count, 0);
  EXPECT_TRUE(world.warnings.empty());
  std::vector<double> places(static_cast<std::size_t>(skin.rest_positions.size()));
  skin.embedding.apply(world.rest_positions, places);
  const Eigen::Map<const VectorX> carried(places.data(), skin.rest_positions.size());
  EXPECT_LT((carried - skin.rest_positions).norm(), 1e-12);
  EXPECT_EQ(skin.facets.num_cells(), 2 * 2 * (16 * 4 + 16 * 4 + 4 * 4));
}

TEST(Skin, OfASecondBodyIsCarriedByItsOwnNodes) {
  Description scene = bar_with_skin();
  scene.bodies.insert(scene.bodies.begin(), scene.bodies[0]);
  scene.bodies[0].name = "first";
  scene.bodies[0].skin.reset();
  scene.contact.is_enabled = false;
  scene.fixes[0].body = scene.probes[0].body = "first";
  const World world(scene);
  EXPECT_EQ(world.bodies[0].skin, nullptr);
  const Skin& skin = *world.bodies[1].skin;
  for (Index v = 0; v < skin.num_vertices(); ++v)
    for (const Index node : skin.embedding.nodes(v)) EXPECT_GE(node, world.bodies[1].first_node);
}

TEST(Skin, ThatStandsOutOfItsCellsIsAWarningWithTheWorstDistance) {
  const World near(bar_with_skin({0, 0, 0.04}));
  EXPECT_TRUE(near.warnings.empty());
  const World far(bar_with_skin({0, 0, 0.2}));
  ASSERT_EQ(far.warnings.size(), 1u);
  EXPECT_THAT(far.warnings[0], HasSubstr("body[0].skin: vertex "));
  EXPECT_THAT(far.warnings[0], HasSubstr("of fine.obj stands 0.2 m off the nearest cell of a body of 1 m"));
}

TEST(Skin, ThatIsElsewhereIsRefusedWithTheWorstDistanceAndACure) {
  EXPECT_THAT(refusal_of(bar_with_skin({0, 0, 7})),
              AllOf(HasSubstr("stands 7 m off the nearest cell of a body of 1 m"),
                    HasSubstr("scaled, rotated and translated with the mesh")));
}

TEST(Skin, WithoutTrianglesIsRefusedByName) {
  Description scene = bar_with_skin();
  scene.bodies[0].skin->surface = make_box({1, 1, 1}, {1, 1, 1});
  scene.bodies[0].skin->surface.blocks.resize(1);
  scene.bodies[0].skin->surface.block(CellKind::triangle).nodes.clear();
  EXPECT_THAT(refusal_of(scene), HasSubstr("expected triangles in fine.obj"));
}

TEST(Skin, InThePlaneMayBeACurve) {
  Description scene = small_bar(2, true);
  SkinDescription skin;
  skin.surface_name = "curve.msh";
  for (int i = 0; i <= 10; ++i) skin.surface.vertices.emplace_back(0.1 * i, 0.125, 0);
  for (Index i = 0; i < 10; ++i) {
    skin.surface.block(CellKind::line).nodes.push_back(i);
    skin.surface.block(CellKind::line).nodes.push_back(i + 1);
  }
  scene.bodies[0].skin = skin;
  const World world(scene);
  EXPECT_EQ(world.bodies[0].skin->facets.num_cells(), 10);
  EXPECT_EQ(world.bodies[0].skin->embedding.outside().count, 0);
}

}  // namespace
}  // namespace resilin::testing
