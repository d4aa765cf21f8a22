// Friction of cables at guides, from the scene file to the report.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cable_scenes.hpp"
#include "resilin/core/text.hpp"
#include "scene_runs.hpp"

namespace resilin::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

struct CableFriction : Scenes {};

/// A block that slides along x on a spring of 1000 N/m, and a cable over a drum of guides that pulls it with
/// a tension of 10 N at its other end.
struct Drum {
  double mu, angle;  ///< the angle of all guides [rad]
  std::string simulation = "load_steps = 10";
  std::string time_function = "{ ramp = { from = 0, until = 1 } }";
  std::string body{};

  double capstan() const { return std::exp(mu * angle); }
  std::string scene() const {
    const int guides = std::max(1, static_cast<int>(std::lround(angle / (std::numbers::pi / 6))));
    const double turn = angle / guides;
    // Backwards from the block, which the last piece pulls to -x.
    std::string points = "{ body = \"block\", at = [1, 0] }]";
    double direction = 0;
    double x = 0, y = 0;
    for (int i = guides; i >= 0; --i) {
      const std::string place = "[" + format_number(x) + ", " + format_number(y) + "]";
      points = (i == 0 ? "points = [" : "") + ("{ at = " + place + " }, " + points);
      direction -= turn;
      x -= 0.1 * std::cos(direction);
      y -= 0.1 * std::sin(direction);
    }
    return "[simulation]\ndimension = 2\n" + simulation + R"(
[newton]
tolerance = 1e-11
[contact]
friction_speed = 1e-6
[[body]]
name = "block"
mesh = { box = { size = [0.2, 0.1], cells = [1, 1], origin = [1, -0.05] } }
rigid = { density = 100 }
)" + body + R"(
[[joint]]
name = "rail"
kind = "slider"
bodies = ["block"]
at = [1, 0]
axis = [1, 0]
stiffness = 1000
[[cable]]
name = "cable"
)" + points +
           "\ntension = 10\nfriction = " + format_number(mu) + "\ntime_function = " + time_function + "\n";
  }
};

/// The force of the spring that the cable pulls at.
double pull_of(const json& frame) { return -1000 * double(frame["joints"]["rail"]["value"]); }

TEST_F(CableFriction, LoseTensionAsOnACapstan) {
  struct Row {
    double mu, degrees, ratio;
  };
  for (const auto& [mu, degrees, ratio] :
       {Row{0.1, 30, 1.0537548970256727}, Row{0.1, 540, 2.566332395208135}, Row{0.3, 90, 1.6019776512823565},
        Row{0.5, 180, 4.810477380965351}, Row{0.5, 540, 111.31777848985621}}) {
    SCOPED_TRACE(std::to_string(mu) + ", " + std::to_string(degrees));
    const Drum drum{.mu = mu, .angle = degrees * std::numbers::pi / 180};
    const json frame = frames_of(drum.scene()).back();
    EXPECT_NEAR(10 / pull_of(frame), ratio, 1e-9 * ratio);
    const std::vector<double> tensions = frame["cables"]["cable"]["tensions"];
    EXPECT_EQ(tensions.front(), 10);
    EXPECT_NEAR(tensions.back(), pull_of(frame), 1e-9 * tensions.back());
    EXPECT_EQ(double(frame["cables"]["cable"]["force"]), 10);
  }
}

// Pulled, let go by half, so that it sticks, and let go until it slides back.
TEST_F(CableFriction, StickAtGuidesUntilTheySlideBack) {
  const Drum drum{.mu = 0.3,
                  .angle = std::numbers::pi / 2,
                  .simulation = "load_steps = 40\nend_time = 4",
                  .time_function = "{ table = [[0, 0], [1, 1], [2, 0.5], [4, 0.1]] }"};
  const json frames = frames_of(drum.scene());
  ASSERT_EQ(frames.size(), 41U);
  const double pulled = 10 / drum.capstan();
  EXPECT_NEAR(pull_of(frames[10]), pulled, 1e-9 * pulled);
  EXPECT_NEAR(pull_of(frames[20]), pulled, 1e-4 * pulled);  // it creeps
  const double let_go = drum.capstan();
  EXPECT_NEAR(pull_of(frames[40]), let_go, 1e-9 * let_go);
  // Heat: what slides past the guides by the step of the tension there, at the end of each load step.
  EXPECT_NEAR(double(frames[10]["energy"]["friction"]),
              0.5 * (drum.capstan() - 1) * pulled * pulled / 1000 * 1.1, 1e-10);
  double heat = 0;
  for (const json& frame : frames) {
    EXPECT_GE(double(frame["energy"]["friction"]), heat);
    heat = frame["energy"]["friction"];
  }
}

// Thrown away from the guides with the energy of the way, and pulled back by the spring: with the tension
// times e^a one way, by e^a the other.
TEST_F(CableFriction, RubAtGuidesInMotionWithEveryIntegrator) {
  for (const std::string integrator : {"backward_euler", "bdf2", "midpoint", "newmark", "tr_bdf2"}) {
    SCOPED_TRACE(integrator);
    const Drum drum{.mu = 0.3,  // 2 kg
                    .angle = std::numbers::pi / 2,
                    .simulation = "kind = \"dynamic\"\ntime_step = 0.0005\nend_time = 0.4\nintegrator = \"" +
                                  integrator + "\"",
                    .time_function = "{ ramp = { from = -1, until = 0 } }",
                    .body = "velocity = [2, 0]\n"};
    double farthest = 0, nearest = 0, farthest_again = -1, heat = 0;
    for (const json& frame : frames_of(drum.scene())) {
      const double place = frame["joints"]["rail"]["value"];
      nearest = std::min(nearest, place);
      const bool has_turned = nearest < -0.05;
      double& largest = has_turned ? farthest_again : farthest;
      largest = std::max(largest, place);
      EXPECT_GE(double(frame["energy"]["dissipated"]), heat - 1e-12);
      heat = frame["energy"]["dissipated"];
    }
    const double out = 10 * drum.capstan() / 1000, back = 10 / drum.capstan() / 1000;  // [m] of the spring
    const double first = std::sqrt(2 * 4 / 1000.0 + out * out) - out;
    const double tolerance = integrator == "backward_euler" ? 5e-3 : integrator == "bdf2" ? 1e-3 : 2e-4;
    EXPECT_NEAR(farthest, first, tolerance);
    EXPECT_NEAR(nearest, -first - 2 * back, tolerance);
    EXPECT_NEAR(farthest_again, first + 2 * back - 2 * out, tolerance);
  }
}

TEST_F(CableFriction, RefuseFrictionWithoutGuides) {
  const std::string two =
      pulled_block.substr(0, pulled_block.find(", { body = \"block\", at = [0.1, 0.05, 0.15]")) +
      ", { body = \"block\", at = [0.1, 0.05, 0.3] }]\ntension = 5\n";
  EXPECT_THAT(error_of(two, "cable.0.friction=0.2"), HasSubstr("a cable with guides between its ends"));
  EXPECT_THAT(error_of(pulled_block, "cable.0.friction=-1"), HasSubstr(">= 0"));
}

}  // namespace
}  // namespace resilin::testing
