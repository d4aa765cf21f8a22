#pragma once

#include "resilin/simulation/simulation.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {

/// A block that cannot go sideways rests on the ground under its weight, or on another one that is held
/// below.
inline Description resting_block(int dimension, const std::string& element, bool is_on_a_body) {
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

}  // namespace resilin::testing
