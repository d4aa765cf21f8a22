// Statics of bodies that only friction holds: one that slides is told as such, with what is missing; one that
// friction holds has an equilibrium.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

constexpr double friction = 0.5, density = 1000, gravity = 9.81;

/// A block on a plane that is tilted by an angle whose tangent is `slope`, with `modulus` times its weight
/// per area as Young's modulus.
Description block_on_a_slope(int dimension, double slope, double modulus, bool is_on_a_body) {
  Description scene;
  scene.dimension = dimension;
  const int up = dimension - 1;
  const double angle = std::atan(slope);
  scene.gravity = gravity * (std::sin(angle) * Vector3::UnitX() - std::cos(angle) * Vector3::Unit(up));
  BodyDescription block;
  block.name = "block";
  block.element = "P1";
  block.mesh = dimension == 3 ? make_box({1, 1, 0.3}, {3, 3, 1}) : make_rectangle({1, 0.3}, {4, 2});
  block.translate = 1e-3 * Vector3::Unit(up);
  block.material.constants = {{"youngs_modulus", modulus * density * gravity}, {"poissons_ratio", 0.3}};
  block.material.density = density;
  if (is_on_a_body) {
    BodyDescription base = block;
    base.name = "base";
    base.mesh = dimension == 3 ? make_box({3, 2, 0.3}, {4, 3, 1}) : make_rectangle({3, 0.3}, {6, 1});
    base.translate = -0.3 * Vector3::Unit(up) - (dimension == 3 ? Vector3(1, 0.5, 0) : Vector3(1, 0, 0));
    FixDescription foot;
    foot.name = "foot";
    foot.body = "base";
    foot.where.kind = Where::Kind::plane;
    foot.where.axis = up;
    foot.where.at = -0.3;
    scene.fixes.push_back(foot);
    scene.contact.friction = friction;
    scene.bodies = {block, base};
    return scene;
  }
  scene.bodies = {block};
  ColliderDescription plane;
  plane.name = "plane";
  plane.shape.normal = Vector3::Unit(up);
  plane.friction = friction;
  scene.colliders.push_back(plane);
  return scene;
}

/// The number after a word in a text.
double number_after(const std::string& text, const std::string& word) {
  const std::size_t found = text.find(word);
  return found == std::string::npos ? std::nan("") : std::stod(text.substr(found + word.size()));
}

TEST(Slide, IsToldWithWhatIsMissing) {
  for (const int dimension : {2, 3})
    for (const bool is_on_a_body : {false, true})
      for (const double modulus : {1e2, 1e4}) {
        SCOPED_TRACE(std::to_string(dimension) + (is_on_a_body ? "D on a body, " : "D on a plane, ") +
                     std::to_string(modulus));
        const double slope = 0.65, angle = std::atan(slope);
        Simulation simulation(block_on_a_slope(dimension, slope, modulus, is_on_a_body));
        StepReport report;
        while (!simulation.is_finished() &&
               (report = simulation.step()).status == StepReport::Status::converged) {
        }
        ASSERT_FALSE(simulation.is_finished());
        EXPECT_NE(report.reason.find("friction cannot hold \"block\""), std::string::npos) << report.reason;
        const double weight = density * gravity * 0.3;
        const double missing = weight * (std::sin(angle) - friction * std::cos(angle));
        EXPECT_NEAR(number_after(report.reason, "out of balance by "), missing, 0.05 * missing)
            << report.reason;
      }
}

TEST(Slide, IsNotToldOfABodyThatFrictionHolds) {
  for (const int dimension : {2, 3})
    for (const double slope : {0.3, 0.48})
      for (const double modulus : {1e2, 1e4}) {
        SCOPED_TRACE(std::to_string(dimension) + "D, " + std::to_string(slope) + ", " +
                     std::to_string(modulus));
        Description scene = block_on_a_slope(dimension, slope, modulus, false);
        scene.load_steps = 2;
        EXPECT_TRUE(run_all(scene).is_finished());
      }
}

}  // namespace
}  // namespace resilin::testing
