// Bodies thrown about in a box that is shaken, one Newton iteration for each frame.

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string>

#include "playground.hpp"
#include "resilin/contact/crossing.hpp"

namespace resilin::testing {
namespace {

constexpr double room = 1.1;               // m, half of the box's width
constexpr double swing = 0.3, pace = 1.5;  // m and Hz: how the box is shaken

Vector3 sway() { return swing * Vector3(1, 0.6, 0.8); }

ColliderDescription wall(int axis, double side) {
  ColliderDescription collider;
  collider.name = std::string(side < 0 ? "low " : "high ") + std::to_string(axis);
  collider.shape.point = side * room * Vector3::Unit(axis);
  collider.shape.normal = -side * Vector3::Unit(axis);
  collider.displacement = sway();
  collider.time_function.form = TimeFunction::Sine{.frequency = pace};
  return collider;
}

/// Six cubes of 0.4 m, each of another stiffness, within six planes that swing together.
Description shaken_box(const std::string& law, double friction) {
  Description scene;
  scene.is_dynamic = true;
  scene.time_step = 1.0 / 60;
  scene.end_time = 1e6;
  scene.gravity = {0, 0, -9.81};
  scene.contact.with_themselves = true;
  scene.contact.friction = friction;
  for (int i = 0; i < 6; ++i) {
    BodyDescription body;
    body.name = "cube " + std::to_string(i);
    body.mesh = make_box({0.4, 0.4, 0.4}, {2, 2, 2}, Vector3::Constant(-0.2), TetPattern::five);
    body.element = "P1";
    body.translate = {0.6 * (i % 2) - 0.3, 0.6 * (i / 2) - 0.6, 0.1 * i - 0.3};
    body.rotate = Rotation{.axis = {1, 2, 3}, .degrees = 25.0 * i};
    body.material.law = law;
    body.material.constants = {{"youngs_modulus", 2e4 * std::pow(3.0, i % 3)}, {"poissons_ratio", 0.3}};
    scene.bodies.push_back(body);
  }
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      scene.colliders.push_back(wall(axis, side));
      scene.colliders.back().friction = friction;
    }
  return scene;
}

/// Six times the volume of a tetrahedron, in more digits than places have.
long double volume(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  using Long = Eigen::Matrix<long double, 3, 1>;
  const Long p = b.cast<long double>() - a.cast<long double>(),
             q = c.cast<long double>() - a.cast<long double>(),
             r = d.cast<long double>() - a.cast<long double>();
  return p.dot(q.cross(r));
}

/// Whether any edge goes through any triangle, each tried with each: no tree, no predicate of the library.
bool has_crossing_by_trying(const CollisionSurface& surface, const VectorX& places) {
  const auto at = [&](Index v) -> Vector3 { return places.segment<3>(Eigen::Index{v} * 3); };
  for (std::size_t t = 0; t < surface.triangles.size(); t += 3) {
    const std::array<Index, 3> T{surface.triangles[t], surface.triangles[t + 1], surface.triangles[t + 2]};
    const std::array<Vector3, 3> x{at(T[0]), at(T[1]), at(T[2])};
    const Vector3 low = x[0].cwiseMin(x[1]).cwiseMin(x[2]), high = x[0].cwiseMax(x[1]).cwiseMax(x[2]);
    for (std::size_t e = 0; e < surface.edges.size(); e += 2) {
      const std::array<Index, 2> E{surface.edges[e], surface.edges[e + 1]};
      if (std::ranges::find(T, E[0]) != T.end() || std::ranges::find(T, E[1]) != T.end()) continue;
      const Vector3 p = at(E[0]), q = at(E[1]);
      if ((p.cwiseMax(q).array() < low.array()).any() || (p.cwiseMin(q).array() > high.array()).any())
        continue;
      if ((volume(x[0], x[1], x[2], p) > 0) == (volume(x[0], x[1], x[2], q) > 0)) continue;
      const bool first = volume(p, q, x[0], x[1]) > 0;
      if (first == (volume(p, q, x[1], x[2]) > 0) && first == (volume(p, q, x[2], x[0]) > 0)) return true;
    }
  }
  return false;
}

/// Outcome of a storm.
struct Wreck {
  int frames = 0, crossings = 0, crossings_by_trying = 0, vertices_outside = 0, num_touching = 0;
  int folded_frames = 0;     ///< with a cell inside out
  double longest_delay = 0;  ///< longest delay of the box behind its motion [s]
  bool is_finite = true;
};

class BodyStorm {
 public:
  BodyStorm(LiveScene& scene, std::uint64_t seed) : scene_(scene), chance_(seed), calm_(scene.controls()) {}

  Wreck blow(int grabs) {
    for (int i = 0; i < grabs && wreck_.is_finite; ++i) {
      change_controls();
      pull();
      scene_.release();
      for (int frame = 0; frame < 20; ++frame) step();
    }
    return wreck_;
  }

 private:
  void change_controls() {
    LiveControls controls = scene_.controls();
    controls.newton_limit = 1;
    if (chance_.happens(0.7)) controls.time_step = chance_.between_in_ratio(1e-4, 0.1);
    controls.max_force = chance_.between_in_ratio(0.1, 5) * calm_.max_force;
    scene_.set_controls(controls);
  }

  /// To anywhere in the box and beyond; a few frames of it throw, many drag.
  void pull() {
    const ContactSurface& surface = scene_.world().contact->surface();
    const Index vertex = chance_.below(surface.num_body_vertices());
    const MaterialPoint place = at_node(surface.vertices.nodes_of(vertex)[0]);
    const Vector3 start = place.position(3, scene_.state().positions);
    const Vector3 way = 10 * room * chance_.between(0, 1) * chance_.direction();
    const int frames = 1 + chance_.below(10);
    scene_.grab(place, start);
    for (int i = 1; i <= frames; ++i) {
      scene_.drag(start + static_cast<double>(i) / frames * way);
      step();
    }
  }

  void step() {
    scene_.step(unhurried);
    ++wreck_.frames;
    wreck_.folded_frames += scene_.report().inverted_cells > 0;
    const State& state = scene_.state();
    wreck_.is_finite &= state.positions.allFinite() && state.velocities.allFinite();
    if (!wreck_.is_finite) return;
    const SurfaceContact& contact = *scene_.world().contact;
    const VectorX places = contact.surface().places(state.positions);
    const CollisionSurface& surface = contact.surface().parts;
    wreck_.crossings += first_crossing(surface, contact.meetings(), places).has_value();
    wreck_.crossings_by_trying += has_crossing_by_trying(surface, places);
    wreck_.num_touching += std::isfinite(contact.smallest_gap(state.positions).distance);
    // Where the box is, by its formula.
    const double phase = 2 * std::numbers::pi * pace * (state.time - state.collider_delay);
    for (Eigen::Index i = 0; i < places.size(); i += 3) {
      const Vector3 x = places.segment<3>(i) - std::sin(phase) * sway();
      wreck_.vertices_outside += !(x.cwiseAbs().maxCoeff() < room);
    }
    wreck_.longest_delay = std::max(wreck_.longest_delay, state.collider_delay);
  }

  LiveScene& scene_;
  Chance chance_;
  LiveControls calm_;
  Wreck wreck_;
};

/// RESILIN_STORM_GRABS in the environment makes it longer than a test has time for.
int grabs_of_storm() {
  const char* asked = std::getenv("RESILIN_STORM_GRABS");
  return asked != nullptr ? std::atoi(asked) : 50;
}

class StormInABox : public ::testing::TestWithParam<int> {};

TEST_P(StormInABox, LeavesBodiesApartAndUpright) {
  const int seed = GetParam();
  LiveScene scene(shaken_box(seed % 2 == 0 ? "neo_hookean" : "stable_neo_hookean", seed < 3 ? 0.0 : 0.4));
  const Wreck wreck = BodyStorm(scene, static_cast<std::uint64_t>(seed)).blow(grabs_of_storm());
  EXPECT_TRUE(wreck.is_finite);
  EXPECT_EQ(wreck.crossings, 0);
  EXPECT_EQ(wreck.crossings_by_trying, 0);
  EXPECT_EQ(wreck.vertices_outside, 0);
  EXPECT_EQ(wreck.folded_frames, 0);
  EXPECT_GT(wreck.num_touching, wreck.frames / 10) << "too calm to show anything";
  RecordProperty("frames", wreck.frames);
  RecordProperty("touching", wreck.num_touching);
  RecordProperty("longest_delay", std::to_string(wreck.longest_delay));
}
INSTANTIATE_TEST_SUITE_P(Seeds, StormInABox, ::testing::Range(1, 13), ::testing::PrintToStringParamName());

}  // namespace
}  // namespace resilin::testing
