// A touch so light that the positions have no digits for its force is no reason for a failed step.

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "every_integrator.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

constexpr double activation_distance = 5e-3;

/// A cube of 1 m without gravity, `share` of the activation distance inside that of a collider above it.
Description touched_cube(int dimension, const std::string& kind, double share) {
  Description scene;
  scene.dimension = dimension;
  BodyDescription body;
  body.name = "cube";
  body.element = "P1";
  body.mesh = dimension == 3 ? make_box({1, 1, 1}, {2, 2, 2}) : make_rectangle({1, 1}, {3, 3});
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.4}};
  scene.bodies.push_back(std::move(body));
  const int up = dimension - 1;
  const double top = 1 + activation_distance * (1 - share);
  const Vector3 middle = dimension == 3 ? Vector3(0.5, 0.5, 0) : Vector3(0.5, 0, 0);
  ColliderDescription tool;
  tool.name = "tool";
  tool.kind = kind;
  tool.activation_distance = activation_distance;
  tool.shape.point = top * Vector3::Unit(up);
  tool.shape.normal = -Vector3::Unit(up);
  tool.shape.radius = 1;
  tool.shape.center = middle + (top + 1) * Vector3::Unit(up);
  scene.colliders.push_back(tool);
  return scene;
}

/// From force-free touches to such as make forces of some digits.
constexpr std::array shares = {1e-14, 1e-12, 1e-10, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3};

TEST(GrazingTouch, IsAStepThatConverges) {
  for (const int dimension : {2, 3})
    for (const std::string kind : {"half_space", "sphere"})
      for (const std::string& integrator : integrator_names())
        for (const double share : shares) {
          SCOPED_TRACE(integrator + ", " + kind + ", " + std::to_string(dimension) + "D, " +
                       std::to_string(share));
          Description scene = touched_cube(dimension, kind, share);
          scene.is_dynamic = true;
          scene.integrator = integrator;
          scene.time_step = 2.5e-3;
          scene.end_time = 3 * scene.time_step;
          Simulation simulation(scene);
          while (!simulation.is_finished()) {
            const StepReport report = simulation.step();
            ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
          }
        }
}

TEST(GrazingTouch, OfAHeldBodyHasAnEquilibrium) {
  for (const int dimension : {2, 3})
    for (const std::string kind : {"half_space", "sphere"})
      for (const double share : shares) {
        SCOPED_TRACE(kind + ", " + std::to_string(dimension) + "D, " + std::to_string(share));
        Description scene = touched_cube(dimension, kind, share);
        FixDescription foot;
        foot.name = "foot";
        foot.where.kind = Where::Kind::plane;
        foot.where.axis = dimension - 1;
        scene.fixes.push_back(foot);
        EXPECT_TRUE(run_all(scene).is_finished());
      }
}

}  // namespace
}  // namespace resilin::testing
