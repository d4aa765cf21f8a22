#pragma once

#include "pressed_bars.hpp"
#include "resilin/contact/catalog.hpp"
#include "resilin/mesh/topology.hpp"

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

/// Two arms that are joined at the left, of which the upper one is pressed onto the lower one and along it.
inline Description two_arms(int dimension, bool is_dynamic) {
  const int up = dimension - 1;
  Description scene = pressed_bars(dimension, is_dynamic);
  scene.colliders.clear();
  scene.bodies.pop_back();
  scene.contact.with_themselves = true;
  scene.gravity.setZero();
  BodyDescription& arms = scene.bodies[0];
  arms.name = "arms";
  arms.mesh = dimension == 3 ? make_box({0.3, 0.05, 0.15}, {6, 1, 3}) : make_rectangle({0.3, 0.15}, {6, 3});
  const auto corners = static_cast<std::size_t>(dimension + 1);
  std::vector<Index>& nodes =
      arms.mesh.block(dimension == 3 ? CellKind::tetrahedron : CellKind::triangle).nodes;
  std::vector<Index> kept;
  for (std::size_t first = 0; first < nodes.size(); first += corners) {
    Vector3 middle = Vector3::Zero();
    for (std::size_t k = first; k < first + corners; ++k)
      middle += arms.mesh.vertices[static_cast<std::size_t>(nodes[k])] / static_cast<double>(corners);
    if (middle.x() > 0.05 && middle[up] > 0.05 && middle[up] < 0.1) continue;
    kept.insert(kept.end(), nodes.begin() + static_cast<std::ptrdiff_t>(first),
                nodes.begin() + static_cast<std::ptrdiff_t>(first + corners));
  }
  nodes = kept;
  arms.mesh.groups.clear();
  for (Vector3& vertex : arms.mesh.vertices)
    if (vertex[up] > 0.09) {
      vertex[up] -= 0.048;  // rest of the slot
      vertex[0] += 0.007;   // no corner is above another
    }
  scene.fixes[0].body = "arms";
  scene.fixes[0].where.tolerance = 0.008;
  FixDescription& press = scene.fixes[1];
  press.body = "arms";
  press.where.kind = Where::Kind::box;
  press.where.min = Vector3(0.29, -1, -1);
  press.where.max = Vector3(0.31, 1, 1);
  press.where.min[up] = 0.09;
  const Vector3 way = -0.006 * Vector3::Unit(up) + 0.004 * Vector3::UnitX();
  if (is_dynamic) {
    press.velocity = way / scene.end_time;
    press.displacement.setZero();
  } else {
    press.displacement = way;
  }
  return scene;
}

/// The surface of a box of 0.5 x 0.25 x 0.25 m whose faces bulge a little: no two of its parts are level.
inline Mesh bulged_box() {
  const Mesh box = make_box({0.5, 0.25, 0.25}, {3, 2, 2});
  Mesh surface;
  surface.vertices = box.vertices;
  for (Vector3& vertex : surface.vertices) {
    const Vector3 off = vertex - Vector3(0.25, 0.125, 0.125);
    vertex[2] += 0.004 * off[2] * (1 - 3 * off.head<2>().squaredNorm());
  }
  surface.block(CellKind::triangle).nodes = boundary(*box.find_solid(3)).facets.nodes;
  return surface;
}

/// The bars meet with their skins, fine surfaces that their cells carry.
inline Description rubbing_skins(int dimension, bool is_dynamic) {
  const int up = dimension - 1;
  Description scene = rubbing_bars(dimension, is_dynamic, "half_space");
  for (BodyDescription& body : scene.bodies) {
    SkinDescription skin;
    if (dimension == 3) {
      skin.surface = bulged_box();
    } else {
      skin.surface.vertices = {{0, 0, 0},      {0.13, -0.0002, 0}, {0.31, -0.0003, 0}, {0.5, 0, 0},
                               {0.5, 0.25, 0}, {0.27, 0.2503, 0},  {0, 0.25, 0}};
      skin.surface.block(CellKind::line).nodes = {0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 0};
    }
    body.skin = skin;
    body.contact_surface = MeetingSurface::skin;
  }
  scene.bodies[1].translate += 0.0008 * Vector3::Unit(up);
  scene.contact.activation_distance = scene.colliders[0].activation_distance = 0.0025;
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
