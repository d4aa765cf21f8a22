#pragma once

#include "pressed_bars.hpp"
#include "resilin/contact/catalog.hpp"

namespace resilin::testing {

/// Something rubs on each source at the end: else there is nothing to differentiate.
inline void expect_friction(const Description& scene) {
  const Simulation end = converged_end_of(scene);
  EXPECT_GT(end.state().friction_work, 0);
}

/// The bars, pressed and dragged along each other.
inline Description rubbing_bars(int dimension, bool is_dynamic, const std::string& floor_kind) {
  Description scene = pressed_bars(dimension, is_dynamic, floor_kind);
  scene.colliders[0].friction = 0.3;
  scene.contact.friction = 0.4;
  FixDescription& press = scene.fixes[1];
  if (is_dynamic) {
    press.velocity[0] = 0.3;
    scene.bodies[1].velocity = press.velocity;
  } else {
    press.displacement[0] = 0.004;
  }
  return scene;
}

/// A block whose top is led down onto a collider and along it.
inline Description block_on(const ShapeKind& kind, int dimension, bool is_dynamic) {
  const int up = dimension - 1;
  const double across = dimension == 3 ? 0.1 : 0;
  Description scene = small_bar(dimension, is_dynamic);
  scene.newton.tolerance = 1e-12;
  scene.load_steps = 3;
  scene.time_step = 0.01;
  scene.end_time = 0.04;
  scene.probes.clear();
  scene.bodies[0].name = "block";
  scene.bodies[0].mesh =
      dimension == 3 ? make_box({0.3, 0.2, 0.1}, {3, 2, 1}) : make_rectangle({0.3, 0.1}, {4, 2});
  FixDescription& press = scene.fixes[0];
  press.name = "press";
  press.where.axis = up;
  press.where.at = 0.1;
  const Vector3 way = 0.006 * Vector3::UnitX() - 0.006 * Vector3::Unit(up);
  if (is_dynamic) {
    press.velocity = way / scene.end_time;
    scene.bodies[0].velocity = press.velocity;
  } else {
    press.displacement = way;
  }
  ColliderDescription under;
  under.name = "under";
  under.kind = kind.name;
  under.friction = 0.4;
  const double gap = 0.0004;  // less than the activation distance
  ShapeDescription& shape = under.shape;
  shape.point = -gap * Vector3::Unit(up);
  shape.normal = Vector3::Unit(up);
  shape.radius = 0.3;
  shape.size = {2, 2, 2};
  shape.size[up] = 0.2;
  const Vector3 middle(0.14, across, 0);
  shape.center = middle - ((kind.name == "box" ? 0.1 : 0.3) + gap) * Vector3::Unit(up);
  shape.start = shape.end = shape.center;
  shape.start += dimension == 3 ? Vector3(-0.1, -0.6, 0) : Vector3(-0.1, 0, 0);
  shape.end += dimension == 3 ? Vector3(0.1, 0.6, 0) : Vector3(0.1, 0, 0);
  shape.mesh = level_sheet(dimension, -gap);
  scene.colliders.push_back(under);
  return scene;
}

/// A free block that is thrown at the ground: lands, slips and leaves it, or stays and slides until it
/// sticks.
inline Description thrown_block(int dimension, const Vector3& velocity, double height, double end_time) {
  Description scene = small_bar(dimension, true);
  scene.newton.tolerance = 1e-12;
  scene.time_step = 0.005;
  scene.end_time = end_time;
  scene.fixes.clear();
  scene.probes.clear();
  BodyDescription& block = scene.bodies[0];
  block.name = "block";
  block.mesh = dimension == 3 ? make_box({0.2, 0.1, 0.1}, {2, 1, 1}) : make_rectangle({0.2, 0.1}, {4, 2});
  block.material.constants["youngs_modulus"] = 5e4;
  block.velocity = velocity;
  ColliderDescription ground;
  ground.name = "ground";
  ground.kind = "half_space";
  ground.shape.point = -height * Vector3::Unit(dimension - 1);
  ground.shape.normal = Vector3::Unit(dimension - 1);
  ground.friction = 0.3;
  scene.colliders.push_back(ground);
  return scene;
}

}  // namespace resilin::testing
