// Cells stay upright whatever is done to bodies by hand, under every law and on every kind of element.

#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "playground.hpp"
#include "resilin/element/catalog.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// Two blocks in a room that they nearly fill, where they press on each other and on themselves.
Description full_room(int dim, const std::string& element, const LawInfo& law) {
  Description scene;
  scene.dimension = dim;
  scene.is_dynamic = true;
  scene.time_step = 1.0 / 60;
  scene.end_time = 1e6;
  scene.gravity = dim == 3 ? Vector3(0, 0, -9.81) : Vector3(0, -9.81, 0);
  scene.contact.with_themselves = true;
  scene.contact.friction = 0.3;
  const ElementInfo& info = require_element(element, dim, "element");
  for (int i = 0; i < 2; ++i) {
    BodyDescription body;
    body.name = "block " + std::to_string(i);
    body.mesh = block_for(info, Vector3(0.4, 0.4, 0.4), info.degree == 2 ? 1 : 2);
    body.element = element;
    body.translate = {0.45 * i + 0.02, 0.02, dim == 3 ? 0.02 : 0};
    body.material = material_of(law);
    body.material.constants["youngs_modulus"] = i == 0 ? 2e4 : 1e5;
    scene.bodies.push_back(body);
  }
  for (int axis = 0; axis < dim; ++axis)
    for (const double side : {0.0, axis == 0 ? 0.95 : 0.6}) {
      ColliderDescription wall;
      wall.name = std::string(side == 0 ? "low " : "high ") + std::to_string(axis);
      wall.shape.point = side * Vector3::Unit(axis);
      wall.shape.normal = (side == 0 ? 1 : -1) * Vector3::Unit(axis);
      scene.colliders.push_back(wall);
    }
  return scene;
}

using FoldStormCase = std::tuple<const char*, const char*, int>;  ///< law, element, dimension
class FoldStorm : public ::testing::TestWithParam<FoldStormCase> {};

TEST_P(FoldStorm, LeavesNoCellInsideOutAtAnyTime) {
  const auto& [law, element, dim] = GetParam();
  LiveScene scene(full_room(dim, element, *find_law(law)));
  const LiveControls calm = scene.controls();
  Chance chance(17);
  int pressed_frames = 0;
  const auto step = [&] {
    const LiveReport& report = scene.step(unhurried);
    ASSERT_TRUE(scene.state().positions.allFinite() && scene.state().velocities.allFinite());
    ASSERT_EQ(report.inverted_cells, 0);
    pressed_frames += report.min_volume_ratio < 0.5;
  };
  for (int grab = 0; grab < 10; ++grab) {
    LiveControls controls = calm;
    controls.newton_limit = 1;
    controls.time_step = chance.between_in_ratio(1e-3, 0.1);
    controls.max_force = chance.between_in_ratio(10, 1000) * calm.max_force;
    scene.set_controls(controls);
    const MaterialPoint place = at_node(chance.below(scene.world().num_nodes()));
    const Vector3 start = place.position(dim, scene.state().positions);
    Vector3 way = 3 * chance.direction();
    if (dim == 2) way.z() = 0;
    scene.grab(place, start);
    for (int i = 1; i <= 10; ++i) {
      scene.drag(start + i / 10.0 * way);
      ASSERT_NO_FATAL_FAILURE(step()) << "pull " << grab << ", frame " << i;
    }
    scene.release();
    for (int i = 0; i < 10; ++i) ASSERT_NO_FATAL_FAILURE(step()) << "release " << grab << ", frame " << i;
  }
  EXPECT_GT(pressed_frames, 0) << "too calm to show anything";
}

INSTANTIATE_TEST_SUITE_P(Laws, FoldStorm,
                         ::testing::Combine(::testing::Values("stable_neo_hookean", "stable_neo_hookean_log",
                                                              "corotated", "arap", "saint_venant_kirchhoff",
                                                              "neo_hookean"),
                                            ::testing::Values("P1", "P2", "Q1"), ::testing::Values(2, 3)),
                         [](const ::testing::TestParamInfo<FoldStormCase>& entry) {
                           return std::string(std::get<0>(entry.param)) + "_" + std::get<1>(entry.param) +
                                  "_" + std::to_string(std::get<2>(entry.param)) + "d";
                         });

/// A corner is pulled straight through its body for two seconds.
TEST(FoldBarrier, KeepsACornerThatIsPulledThroughItsBodyFromStoppingOthers) {
  Description both = standing_block(2, 0);
  both.contact.is_enabled = false;
  both.bodies.push_back(both.bodies.front());
  both.bodies[0].name = "pulled";
  both.bodies[1].name = "swaying";
  both.bodies[1].translate = {2, 0, 0};
  both.bodies[1].velocity = {1, 0, 0};
  both.fixes.push_back(both.fixes.front());
  for (std::size_t i = 0; i < 2; ++i) {
    both.fixes[i].name = "foot of " + both.bodies[i].name;
    both.fixes[i].body = both.bodies[i].name;
  }
  Description alone = both;
  alone.bodies.erase(alone.bodies.begin());
  alone.fixes.erase(alone.fixes.begin());
  LiveScene pulled(both), free(alone);
  const World& world = pulled.world();
  const Body& swaying = world.bodies[1];
  Index corner = 0;
  for (Index node = 0; node < world.bodies[0].num_nodes; ++node)
    if (node_position(3, node, world.rest_positions).sum() >
        node_position(3, corner, world.rest_positions).sum())
      corner = node;
  LiveControls controls = pulled.controls();
  controls.max_force *= 100;
  pulled.set_controls(controls);
  pulled.grab(at_node(corner), Vector3(-1, -1, -1));
  double least = 1, farthest = 0, apart = 0;
  for (int i = 0; i < 120; ++i) {
    pulled.step(unhurried);
    free.step(unhurried);
    least = std::min(least, pulled.report().min_volume_ratio);
    ASSERT_EQ(pulled.report().inverted_cells, 0) << "step " << i;
    const VectorX moved = free.state().positions - free.world().rest_positions;
    farthest = std::max(farthest, moved.norm());
    apart = std::max(apart, (pulled.state().positions.segment(3 * swaying.first_node, moved.size()) -
                             free.state().positions)
                                .norm());
  }
  EXPECT_LT(least, 0.1) << "too calm to show anything";
  EXPECT_LT(apart, 1e-2 * farthest);
  pulled.release();
  for (int i = 0; i < 60; ++i) pulled.step(unhurried);
  EXPECT_GT(pulled.report().min_volume_ratio, 0.1);
}

}  // namespace
}  // namespace resilin::testing
