#include "resilin/fields/contact_traction.hpp"

#include <gtest/gtest.h>

#include "resilin/fields/evaluator.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A block that cannot go sideways rests on the ground under its weight, or on another one that is held
/// below.
Description resting_block(int dimension, const std::string& element, bool is_on_a_body) {
  Description scene = small_bar(dimension, false);
  scene.fixes.clear();
  scene.probes.clear();
  BodyDescription& body = scene.bodies[0];
  body.element = element;
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.0}};
  body.mesh = dimension == 3 ? make_box({0.6, 0.6, 0.3}, {3, 3, 2}) : make_rectangle({0.6, 0.3}, {4, 2});
  const int up = dimension - 1;
  const double distance = 1e-3;
  body.translate = 0.5 * distance * Vector3::Unit(up);
  const auto slide = [&](const std::string& name) {
    FixDescription sides;
    sides.name = name + " sides";
    sides.body = name;
    sides.components = {true, dimension == 3, false};
    scene.fixes.push_back(sides);
  };
  slide(body.name);
  if (!is_on_a_body) {
    ColliderDescription ground;
    ground.name = "ground";
    ground.shape.normal = Vector3::Unit(up);
    ground.activation_distance = distance;
    scene.colliders.push_back(ground);
    return scene;
  }
  BodyDescription base = body;
  base.name = "base";
  base.translate = -0.3 * Vector3::Unit(up);
  base.material.density = 0;
  scene.bodies.push_back(base);
  slide("base");
  FixDescription foot;
  foot.name = "foot";
  foot.body = "base";
  foot.where.kind = Where::Kind::plane;
  foot.where.axis = up;
  foot.where.at = -0.3;
  scene.fixes.push_back(foot);
  scene.contact.activation_distance = distance;
  return scene;
}

/// Even over the underside, and of the size of the weight.
TEST(ContactPressure, CarriesTheWeight) {
  for (const int dimension : {2, 3})
    for (const std::string element : {"P1", "P2"})
      for (const bool is_on_a_body : {false, true}) {
        SCOPED_TRACE(element + " " + std::to_string(dimension) +
                     (is_on_a_body ? " on a body" : " on the ground"));
        const Simulation simulation = converged_end_of(resting_block(dimension, element, is_on_a_body));
        const World& world = simulation.world();
        const VectorX pressure = contact_pressure(world, simulation.state());
        const double weight_over_area = 1000 * 9.81 * 0.3;
        double least = 1e300, most = 0;
        for (Index node = 0; node < world.bodies[0].num_nodes; ++node) {
          const double height = node_position(dimension, node, world.rest_positions)[dimension - 1];
          if (height > 0.01) {  // edges along each other fade out, which turns them a little
            EXPECT_NEAR(pressure[node], 0, 0.01 * weight_over_area);
            continue;
          }
          least = std::min(least, pressure[node]);
          most = std::max(most, pressure[node]);
        }
        // Corners of quadratic facets bear little, as they do under an even pressure.
        const bool has_idle_corners = element == "P2" && dimension == 3;
        EXPECT_GT(least, has_idle_corners ? 0 : 0.94 * weight_over_area);
        EXPECT_LT(most, (has_idle_corners ? 1.2 : 1.06) * weight_over_area);
        const VectorX traction = contact_traction(world, simulation.state());
        EXPECT_NEAR(traction.segment(0, world.bodies[0].num_nodes * dimension).cwiseAbs().maxCoeff(), most,
                    0.02 * most);
      }
}

}  // namespace
}  // namespace resilin::testing
