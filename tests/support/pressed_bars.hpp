#pragma once

#include <string>

#include "small_scenes.hpp"

namespace resilin::testing {

/// A soft bar next to a floor, held at x = 0, onto which one that is three times as stiff is pressed.
inline Description pressed_bars(int dimension, bool is_dynamic,
                                const std::string& floor_kind = "half_space") {
  const int up = dimension - 1;
  Description scene = small_bar(dimension, is_dynamic);
  scene.newton.tolerance = 1e-12;
  scene.load_steps = 4;
  scene.time_step = 0.01;
  scene.end_time = 0.04;
  scene.probes.clear();
  BodyDescription& lower = scene.bodies[0];
  lower.name = "lower";
  lower.mesh = dimension == 3 ? make_box({0.5, 0.25, 0.25}, {2, 1, 1}) : make_rectangle({0.5, 0.25}, {3, 2});
  lower.material.constants["youngs_modulus"] = 1e4;
  BodyDescription upper = lower;
  upper.name = "upper";
  upper.material.constants["youngs_modulus"] = 3e4;
  upper.translate = 0.02 * Vector3::UnitX() + 0.2515 * Vector3::Unit(up);
  if (dimension == 3) upper.translate[1] = 0.013;
  scene.fixes[0].body = "lower";
  FixDescription press = scene.fixes[0];
  press.name = "press";
  press.body = "upper";
  press.where.at = 0.02;
  if (is_dynamic) {
    press.velocity = -0.5 * Vector3::Unit(up);
    upper.velocity = press.velocity;
  } else {
    press.displacement = -0.006 * Vector3::Unit(up);
  }
  scene.bodies.push_back(upper);
  scene.fixes.push_back(press);
  ColliderDescription floor;
  floor.name = "floor";
  floor.kind = floor_kind;
  floor.shape.point = -0.002 * Vector3::Unit(up);
  floor.shape.normal = Vector3::Unit(up);
  if (floor_kind == "mesh") floor.shape.mesh = level_sheet(dimension, -0.002);
  scene.colliders.push_back(floor);
  return scene;
}

/// All barriers press at the end: else there is nothing to differentiate.
inline void expect_contact(const Description& scene) {
  const Simulation end = converged_end_of(scene);
  for (const auto& term : end.world().terms) {
    if (term->properties().category != EnergyCategory::contact) continue;
    EXPECT_GT(term->value(end.state().positions, end.world().at_load(1)), 0) << term->name();
  }
}

}  // namespace resilin::testing
