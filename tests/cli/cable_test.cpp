// Loops of joints, springs and cables, from the scene file to the report.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cable_scenes.hpp"
#include "scene_runs.hpp"

namespace resilin::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

struct JointLoops : Scenes {};
struct Cables : Scenes {};

/// Two sliders with a rod between them; one moves along a slanted line. In statics the motor of the other one
/// holds it through the rod: its way s solves s^2 + sqrt(2) (1 - d) s + (1 - d)^2 = 1.
TEST_F(JointLoops, HoldASlantedSliderThroughARod) {
  const std::string scene = R"(
[[body]]
name = "driver"
mesh = { box = { size = [0.2, 0.2, 0.2], cells = [1, 1, 1], origin = [-1.1, -0.1, -0.1] } }
rigid = true

[[body]]
name = "slanted"
mesh = { box = { size = [0.2, 0.2, 0.2], cells = [1, 1, 1], origin = [-0.1, -0.1, -0.1] } }
rigid = true

[[body]]
name = "rod"
mesh = { box = { size = [1, 0.1, 0.1], cells = [1, 1, 1], origin = [-1, -0.05, -0.05] } }
rigid = true

[[joint]]
kind = "slider"
bodies = ["driver"]
at = [-1, 0, 0]
axis = [1, 0, 0]
motor = { position = 0.5 }

[[joint]]
name = "way"
kind = "slider"
bodies = ["slanted"]
at = [0, 0, 0]
axis = [1, 1, 0]

[[joint]]
kind = "hinge"
bodies = ["driver", "rod"]
at = [-1, 0, 0]
axis = [0, 0, 1]

[[joint]]
kind = "hinge"
bodies = ["slanted", "rod"]
at = [0, 0, 0]
axis = [0, 0, 1]
)";
  const json frame = frames_of(scene, {"simulation.load_steps=10"}).back();
  EXPECT_NEAR(double(frame["joints"]["way"]["value"]), (std::sqrt(3.5) - std::sqrt(0.5)) / 2, 1e-6);
}

/// Four hinges whose axes meet in one point, as in a universal joint. An axis that misses the point by the
/// rounding of a file must not lock the loop: the output turns as without this error.
TEST_F(JointLoops, TurnALoopWhoseAxesMissEachOtherByRounding) {
  const std::string loop = R"(
[simulation]
kind = "dynamic"
integrator = "tr_bdf2"
time_step = 0.02
end_time = 1

[[body]]
name = "input"
mesh = { box = { size = [1, 1, 2], cells = [1, 1, 1], origin = [-0.5, -0.5, -3] } }
rigid = { density = 1000 }

[[body]]
name = "cross"
mesh = { box = { size = [1, 1, 1], cells = [1, 1, 1], origin = [-0.5, -0.5, -0.5] } }
rigid = { density = 1000 }

[[body]]
name = "output"
mesh = { box = { size = [1, 1, 2], cells = [1, 1, 1], origin = [-0.5, -0.5, 1] } }
rigid = { density = 1000 }

[[joint]]
name = "motor"
kind = "hinge"
bodies = ["input"]
at = [0, 0, -3]
axis = [0, 0, 1]
motor = { position = 1, time_function = { ramp = { from = 0, until = 1 } } }

[[joint]]
name = "shaft"
kind = "hinge"
bodies = ["output"]
at = [0, 5, 8.660254037844386]
axis = [0, 0.5, 0.8660254037844386]

[[joint]]
kind = "hinge"
bodies = ["input", "cross"]
at = [0, 0, 0]
axis = [1, 0, 0]

[[joint]]
kind = "hinge"
bodies = ["output", "cross"]
at = [0, 0, 0]
axis = [0, 0.8660254037844386, -0.5]
)";
  const auto angle = [&](const std::string& at) {
    return double(frames_of(loop, {"joint.1.at=" + at}).back()["joints"]["shaft"]["value"]);
  };
  const double exact = angle("[0,5,8.660254037844386]");
  EXPECT_NEAR(exact, std::atan2(std::sin(1.0) * std::sqrt(0.75), std::cos(1.0)), 5e-3);
  EXPECT_NEAR(angle("[0,5,8.660254]"), exact, 1e-5);
  EXPECT_NEAR(angle("[0,5,8.66025]"), exact, 1e-4);
}

TEST_F(Cables, SwingABoxOnASpring) {
  const std::string spring = R"(
[simulation]
kind = "dynamic"
gravity = [0, 0, -10]
time_step = 0.01
end_time = 0.3
integrator = "tr_bdf2"

[[body]]
name = "box"
mesh = { box = { size = [0.1, 0.1, 0.1], cells = [1, 1, 1] } }
rigid = { density = 1000 }
translate = [-0.05, -0.05, -0.05]

[[spring]]
name = "spring"
points = [{ body = "box", at = [0, 0, 0] }, { at = [0, 0, 1] }]
stiffness = 1000
)";
  // Half a period of sqrt(1000 / 1) rad/s: the box is 2 m g / k lower.
  const json frame = frames_of(spring, {"simulation.end_time=0.09934588265796101",
                                        "simulation.time_step=0.0009934588265796101"})
                         .back();
  EXPECT_NEAR(double(frame["rigid_bodies"]["box"]["position"][2]), -0.02, 1e-5);
  EXPECT_NEAR(double(frame["cables"]["spring"]["length"]), 1.02, 1e-5);
  EXPECT_NEAR(double(frame["cables"]["spring"]["force"]), 20, 0.01);
}

/// Springs whose ends coincide at rest and whose rest length is 0 are linear in all directions. They alone
/// hold the block here; the mean of its vertices moves by the total force over the sum of the stiffnesses.
TEST_F(Cables, StartWithoutLengthIfTheirRestLengthIsZero) {
  std::string scene = R"(
[[body]]
name = "block"
mesh = { box = { size = [1, 1, 1], cells = [1, 1, 1] } }
element = "P1"
material = { law = "neo_hookean", youngs_modulus = 1e5, poissons_ratio = 0.3 }

[[load]]
kind = "body_force"
value = [8, -16, 24]
)";
  for (int corner = 0; corner < 8; ++corner) {
    const std::string at = "[" + std::to_string(corner & 1) + ", " + std::to_string((corner >> 1) & 1) +
                           ", " + std::to_string(corner >> 2) + "]";
    scene += "\n[[spring]]\npoints = [{ body = \"block\", at = " + at + " }, { at = " + at +
             " }]\nstiffness = 100\nrest_length = 0\n\n[[probe]]\nname = \"" + std::to_string(corner) +
             "\"\nat = " + at + "\n";
  }
  const json probes = frames_of(scene).back()["probes"];
  const std::vector<double> total = {8, -16, 24};
  for (std::size_t i = 0; i < 3; ++i) {
    double sum = 0;
    for (const json& probe : probes) sum += double(probe["displacement"][i]);
    EXPECT_NEAR(100 * sum, total[i], 1e-6);
  }

  EXPECT_THAT(error_of(scene, "spring.0.rest_length=0.1"),
              HasSubstr("points apart, got points in one place"));
}

TEST_F(Cables, PullWithOneTensionOrByALength) {
  const json by_force = frames_of(pulled_block).back();
  EXPECT_NEAR(double(by_force["cables"]["cable"]["force"]), 5, 1e-12);
  // The cable is shorter than at rest.
  const double shorter = std::sqrt(0.01 + 0.0225) + 0.15 - double(by_force["cables"]["cable"]["length"]);
  EXPECT_GT(shorter, 1e-3);
  std::string by_length = pulled_block;
  by_length.replace(by_length.find("tension = 5"), 11,
                    "stiffness = 1e7\nshortening = " + std::to_string(shorter));
  EXPECT_NEAR(double(frames_of(by_length).back()["cables"]["cable"]["force"]), 5, 0.01);
}

}  // namespace
}  // namespace resilin::testing
