#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "resilin/core/error.hpp"
#include "resilin/material/law.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/simulation/simulation.hpp"
#include "resilin/world/state.hpp"
#include "sample_fibres.hpp"

namespace resilin::testing {

/// E = 0.1 MPa, nu = 0.4 unless the law has but one Poisson's ratio; all the families of fibres that it can
/// have.
inline MaterialDescription material_of(const LawInfo& law) {
  MaterialDescription material;
  material.law = law.name;
  if (!std::isnan(law.only_poissons_ratio)) material.constants["poissons_ratio"] = law.only_poissons_ratio;
  for (const ConstantText& constant : law.constants)
    if (constant.is_free && std::isnan(constant.fallback))
      material.constants[std::string(constant.name)] = constant.unit.empty() ? 1 : 1e4;
  for (const Vector3& direction : fibres_for(law, {Vector3(1, 1, 0), Vector3(1, -1, 0)}))
    material.fibres.push_back({direction});
  return material;
}

/// A bar of 1 x 0.25 x 0.25 m (2D: 1 x 0.25 m) held at x = 0 under its weight; E = 0.1 MPa.
inline Description small_bar(int dimension, bool is_dynamic) {
  Description scene;
  scene.dimension = dimension;
  scene.is_dynamic = is_dynamic;
  scene.time_step = 0.02;
  scene.end_time = 0.2;
  scene.gravity = dimension == 3 ? Vector3(0, 0, -9.81) : Vector3(0, -9.81, 0);
  BodyDescription body;
  body.element = "P1";
  body.mesh = dimension == 3 ? make_box({1, 0.25, 0.25}, {8, 2, 2}) : make_rectangle({1, 0.25}, {8, 2});
  scene.bodies.push_back(std::move(body));
  FixDescription wall;
  wall.name = "wall";
  wall.where.kind = Where::Kind::plane;
  scene.fixes.push_back(wall);
  ProbeDescription tip;
  tip.name = "tip";
  tip.at = {1, 0.25, dimension == 3 ? 0.25 : 0.0};
  scene.probes.push_back(tip);
  return scene;
}

/// Why a scene is refused, in one line; empty when it is not.
inline std::string refusal_of(const Description& scene) {
  try {
    const Simulation simulation(scene);
  } catch (const InputError& error) {
    EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
    return error.what();
  }
  return {};
}

inline Simulation run_all(const Description& scene) {
  Simulation simulation(scene);
  while (!simulation.is_finished() && simulation.step().status == StepReport::Status::converged) {
  }
  return simulation;
}

/// The end of a run whose every step converges.
inline Simulation converged_end_of(const Description& scene) {
  Simulation simulation = run_all(scene);
  EXPECT_TRUE(simulation.is_finished()) << "not converged beyond load factor " << simulation.state().load
                                        << ", time " << simulation.state().time << " s";
  return simulation;
}

/// A run, and one that goes on from a checkpoint after `step` steps, end in the same bits.
inline void expect_same_bits_after_a_checkpoint(const Description& scene, int step) {
  const auto advance = [](Simulation& simulation, int steps) {
    for (int i = 0; i < steps && !simulation.is_finished(); ++i)
      ASSERT_EQ(simulation.step().status, StepReport::Status::converged);
  };
  constexpr int all = std::numeric_limits<int>::max();
  Simulation unbroken(scene), first(scene), second(scene);
  advance(unbroken, all);
  advance(first, step);
  ASSERT_FALSE(first.is_finished());
  second.resume_from(deserialize_state(serialize(first.state()), "checkpoint.bin"), "checkpoint.bin");
  advance(second, all);
  EXPECT_EQ(serialize(unbroken.state()), serialize(second.state()));
}

/// Level, below `small_bar`: three lines, or four triangles.
inline Mesh level_sheet(int dimension, double height) {
  Mesh mesh;
  if (dimension == 2) {
    mesh.vertices = {{-1, height, 0}, {0.3, height, 0}, {2, height, 0}};
    mesh.block(CellKind::line).nodes = {0, 1, 1, 2};
  } else {
    mesh.vertices = {{-1, -1, height}, {2, -1, height}, {0.5, 0.1, height}, {0.5, 3, height}};
    mesh.block(CellKind::triangle).nodes = {0, 1, 2, 1, 3, 2, 3, 0, 2};
  }
  return mesh;
}

/// A ball that comes faster than the bar in its way lets it.
inline Description bar_before_a_fast_ball() {
  Description scene = small_bar(3, true);
  ColliderDescription ball;
  ball.name = "ball";
  ball.kind = "sphere";
  ball.shape.center = {1.6, 0.13, 0.12};
  ball.shape.radius = 0.5;
  ball.velocity = {-20, 0, 0};
  scene.colliders.push_back(ball);
  return scene;
}

}  // namespace resilin::testing
