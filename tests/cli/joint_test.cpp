// Joints, from the scene file to the report.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "resilin/core/types.hpp"
#include "scene_runs.hpp"

namespace resilin::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

struct Joints : Scenes {};

/// Two rods of 1 m and 0.8 m, 1 kg and 0.7 kg, that hang at 1.2 rad and at -0.5 rad.
const std::string double_pendulum = R"(
[simulation]
kind = "dynamic"
dimension = 2
gravity = [0, -9.81]
time_step = 0.001
end_time = 0.5
integrator = "bdf2"

[[body]]
name = "one"
mesh = { box = { size = [0.01, 1.0], cells = [1, 4] } }
rigid = { density = 100 }
rotate = [68.75493541569878]
translate = [0.9302272971948429, -0.36701794990650977]

[[body]]
name = "two"
mesh = { box = { size = [0.01, 0.8], cells = [1, 4] } }
rigid = { density = 87.5 }
rotate = [-28.64788975654116]
translate = [0.544110742274412, -1.0620266762959507]

[[joint]]
name = "pin"
kind = "hinge"
bodies = ["one"]
at = [0, 0]

[[joint]]
name = "elbow"
kind = "ball"
bodies = ["one", "two"]
at = [0.9320390859672263, -0.3623577544766736]
)";

// Rows of a reference by Runge and Kutta's method for rods without a width.
TEST_F(Joints, OfADoublePendulumHaveTheForcesOfTheReference) {
  const json frame = frames_of(double_pendulum).back();
  const json joints = frame["joints"];
  EXPECT_NEAR(double(joints["pin"]["value"]), -0.15477499198836925 - 1.2, 2e-4);
  EXPECT_NEAR(double(joints["elbow"]["value"]), 1.1025681434117245 + 0.15477499198836925 + 1.7, 5e-4);
  EXPECT_NEAR(double(joints["pin"]["force"][0]), 3.365462629381681, 0.01);
  EXPECT_NEAR(double(joints["pin"]["force"][1]), 20.201544578840764, 0.01);
  EXPECT_NEAR(double(joints["elbow"]["force"][0]), 0.4678932559921614, 0.01);
  EXPECT_NEAR(double(joints["elbow"]["force"][1]), -4.6436736611959715, 0.01);
  const json one = frame["rigid_bodies"]["one"];
  EXPECT_NEAR(double(one["position"][0]), 0.5 * std::sin(-0.15477499198836925), 1e-4);
  EXPECT_NEAR(double(one["position"][1]), -0.5 * std::cos(-0.15477499198836925), 1e-4);
  EXPECT_NEAR(double(one["angular_velocity"][0]), -3.541215586379556, 1e-3);
  EXPECT_NEAR(2 * std::atan2(double(one["rotation"][3]), double(one["rotation"][0])),
              -0.15477499198836925 - 1.2, 2e-4);
}

TEST_F(Joints, KeepTheEnergyWithEveryIntegrator) {
  for (const std::string integrator : {"bdf2", "tr_bdf2", "newmark"}) {
    SCOPED_TRACE(integrator);
    const json frames = frames_of(double_pendulum, {"simulation.integrator=" + integrator});
    EXPECT_NEAR(double(frames.back()["energy"]["total"]), double(frames[0]["energy"]["total"]), 2e-3);
  }
}

/// A parallelogram of three bars, which a motor turns by its left one.
const std::string four_bar = R"(
[simulation]
kind = "dynamic"
dimension = 2
time_step = 0.01
end_time = 1
integrator = "tr_bdf2"

[[body]]
name = "left"
mesh = { box = { size = [0.1, 1], cells = [1, 1] } }
rigid = { density = 100 }
translate = [-0.05, 0]

[[body]]
name = "top"
mesh = { box = { size = [2, 0.1], cells = [1, 1] } }
rigid = { density = 100 }
translate = [0, 0.95]

[[body]]
name = "right"
mesh = { box = { size = [0.1, 1], cells = [1, 1] } }
rigid = { density = 100 }
translate = [1.95, 0]

[[joint]]
name = "crank"
kind = "hinge"
bodies = ["left"]
at = [0, 0]
motor = { position = 0.5, time_function = { ramp = { from = 0, until = 0.8 } } }

[[joint]]
kind = "hinge"
bodies = ["left", "top"]
at = [0, 1]

[[joint]]
kind = "hinge"
bodies = ["top", "right"]
at = [2, 1]

[[joint]]
name = "rocker"
kind = "hinge"
bodies = ["right"]
at = [2, 0]
)";

TEST_F(Joints, CloseALoop) {
  const json frame = frames_of(four_bar).back();
  EXPECT_NEAR(double(frame["joints"]["crank"]["value"]), 0.5, 2e-3);
  EXPECT_NEAR(double(frame["joints"]["rocker"]["value"]), double(frame["joints"]["crank"]["value"]), 1e-6);
  const json top = frame["rigid_bodies"]["top"];
  EXPECT_NEAR(double(top["rotation"][0]), 1, 1e-9);
  EXPECT_NEAR(double(top["position"][0]), 1 - std::sin(0.5), 2e-3);
}

// A slider at a dead centre moves by the square of the angle, a bar beside another one locks nothing.
TEST_F(Joints, TellOfAMotorThatTheyLock) {
  const auto words = [&](const std::string& scene) {
    folder.write("scene.toml", scene);
    const ProgramResult result = run_program(folder.path(), {"check", "scene.toml"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out + result.err;
  };
  const auto joint = [](const std::string& keys) {
    return four_bar + "\n[[joint]]\nname = \"extra\"\n" + keys;
  };
  EXPECT_THAT(words(joint("kind = \"hinge\"\nbodies = [\"top\"]\nat = [1, 1]")),
              HasSubstr("joint[0].motor: \"crank\" is locked: the joints \"joint[1]\" and \"extra\" hold "
                        "\"left\"; leave one of these joints out"));
  EXPECT_THAT(words(joint("kind = \"distance\"\nbodies = [\"left\"]\nat = [0, 1]\nto = [1, 0]")),
              HasSubstr("\"crank\" is locked: the joint \"extra\" holds \"left\"; leave it out"));
  const std::string beside =
      joint("kind = \"distance\"\nbodies = [\"left\", \"right\"]\nat = [0, 0.5]\nto = [2, 0.5]");
  EXPECT_THAT(words(beside), Not(HasSubstr("locked")));
  const std::string at_a_dead_centre = four_bar.substr(0, four_bar.find("[[joint]]")) + R"(
[contact]
enabled = false

[[joint]]
name = "crank"
kind = "hinge"
bodies = ["top"]
at = [0, 1]

[[joint]]
kind = "hinge"
bodies = ["top", "right"]
at = [2, 1]

[[joint]]
kind = "hinge"
bodies = ["right", "left"]
at = [3, 1]

[[joint]]
kind = "slider"
bodies = ["left"]
at = [3, 1]
axis = [1, 0]
motor = { force = -1 }
)";
  EXPECT_THAT(words(at_a_dead_centre), Not(HasSubstr("locked")));
  const std::string held = four_bar.substr(0, four_bar.find("[[joint]]\nname = \"rocker\"")) +
                           "\n[[fix]]\nbody = \"right\"\nwhere = { all = true }\n";
  EXPECT_THAT(words(held), HasSubstr("the joints \"joint[1]\" and \"joint[2]\" hold \"left\""));
  EXPECT_THAT(words(held + "rotate = { degrees = 20, center = [2, 0] }"), Not(HasSubstr("locked")));
}

// Strains of a thin rod would be differences of positions without digits.
TEST_F(Joints, TurnThinRodsInShortSteps) {
  const std::string rod = R"(
[simulation]
kind = "dynamic"
time_step = 0.0005
end_time = 0.005

[[body]]
name = "rod"
mesh = { box = { size = [1, 0.01, 0.005], cells = [1, 1, 1] } }
rigid = { density = 1000 }
rotate = [0, 1, 1, 30]
translate = [0.5, 0.5, 0.3]

[[joint]]
name = "pin"
kind = "hinge"
axis = [1, 2, 3]
bodies = ["rod"]
at = [0.5, 0.5, 0.3]
motor = { velocity = 0.4 }
)";
  EXPECT_NEAR(double(frames_of(rod).back()["joints"]["pin"]["value"]), 0.002, 1e-8);
}

/// A box that hangs below the ground by one joint.
const std::string hanging_box = R"(
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

[[joint]]
name = "joint"
kind = "fixed"
bodies = ["box"]
at = [0.1, 0, 0]
)";

TEST_F(Joints, BearTheWeight) {
  json joint = frames_of(hanging_box).back()["joints"]["joint"];
  EXPECT_NEAR(double(joint["force"][2]), 10, 1e-3);
  EXPECT_NEAR(double(joint["moment"][1]), 1, 1e-3);  // against the weight at 0.1 m
  joint = frames_of(hanging_box, {"joint.0.kind=distance", "joint.0.at=[0,0,0]", "joint.0.to=[0,0,1]"})
              .back()["joints"]["joint"];
  EXPECT_NEAR(double(joint["value"]), 1, 1e-4);
  EXPECT_NEAR(double(joint["force"][2]), 10, 0.1);
}

TEST_F(Joints, AreRefusedInOneLine) {
  const auto error = [&](const std::string& setting) { return error_of(hanging_box, setting); };
  EXPECT_THAT(error(R"(joint.0.bodies=["box","box"])"), HasSubstr("two bodies, or one"));
  EXPECT_THAT(error(R"(joint.0.bodies=["bux"])"), HasSubstr("one of box"));
  EXPECT_THAT(error_of(hanging_box + "axis = [0, 0, 0]", "joint.0.kind=hinge"),
              HasSubstr("a vector that is not zero"));
  EXPECT_THAT(error("joint.0.kind=screw"), HasSubstr("\"universal\", \"fixed\" or \"distance\""));
  EXPECT_THAT(error("joint.0.kind=slider"), HasSubstr("the joint needs the key \"axis\""));
  EXPECT_THAT(error("joint.0.limits=[-1,1]"), HasSubstr("only a hinge or a slider has this key"));
  EXPECT_THAT(error("body.0.velocity=[1,0,0]"), HasSubstr("one velocity at the joint"));
  const std::string fixed = hanging_box + R"(
[[fix]]
body = "box"
where = { group = "z_max" }
)";
  EXPECT_THAT(error_of(fixed, "title=x"), HasSubstr("leave the joint or a [[fix]] out"));
}

/// A box of 1 kg that a joint leads, by the ground or by a fixed block.
std::string led_box(const std::string& bodies, const std::string& keys, const std::string& motion = "") {
  return R"(
[simulation]
kind = "dynamic"
gravity = [0, 0, -10]
time_step = 0.005
end_time = 0.2
integrator = "tr_bdf2"

[contact]
enabled = false

[[body]]
name = "base"
mesh = { box = { size = [0.2, 0.2, 0.2], cells = [1, 1, 1], origin = [-0.1, -0.1, -0.1] } }
rigid = { density = 1000 }

[[fix]]
body = "base"
where = { group = "z_min" }

[[body]]
name = "box"
mesh = { box = { size = [0.1, 0.1, 0.1], cells = [1, 1, 1], origin = [-0.05, -0.05, -0.05] } }
rigid = { density = 1000 }
)" + motion +
         "\n[[joint]]\nname = \"joint\"\nbodies = " + bodies + "\nat = [0, 0, 0]\n" + keys;
}

constexpr const char* to_the_ground = "[\"box\"]";
constexpr const char* to_the_base = "[\"base\", \"box\"]";

// 10 m/s^2 along an axis or in a plane at 45 degrees.
TEST_F(Joints, LeadABoxByTheGroundOrByABody) {
  struct Led {
    const char* keys;
    const char* motion;
    double value, angle;
  };
  const double way = 0.5 * 10 * std::sqrt(0.5) * 0.2 * 0.2;
  for (const Led& led :
       {Led{"kind = \"slider\"\naxis = [1, 0, -1]", "", way, 0},
        Led{"kind = \"cylindrical\"\naxis = [1, 0, -1]",
            "velocity_gradient = [[0, 2, 0], [-2, 0, -2], [0, 2, 0]]", way, std::sqrt(8) * 0.2},
        Led{"kind = \"planar\"\naxis = [1, 0, 1]", "velocity_gradient = [[0, -2, 0], [2, 0, -2], [0, 2, 0]]",
            way, std::sqrt(8) * 0.2}}) {
    SCOPED_TRACE(led.keys);
    const json ground = frames_of(led_box(to_the_ground, led.keys, led.motion)).back()["joints"]["joint"];
    const json base = frames_of(led_box(to_the_base, led.keys, led.motion)).back()["joints"]["joint"];
    EXPECT_NEAR(double(ground["value"]), led.value, 2e-4 * led.value);
    EXPECT_NEAR(double(base["value"]), led.value, 2e-4 * led.value);
    if (led.angle > 0) {
      EXPECT_NEAR(double(ground["angle"]), led.angle, 1e-3);
      EXPECT_NEAR(double(base["angle"]), led.angle, 1e-3);
    }
    EXPECT_LT(double(ground["gap"]), 1e-12);
    EXPECT_LT(double(base["gap"]), 2e-6);
    // Force on the first body: the box, or the base.
    for (const std::size_t k : {0, 2}) {
      EXPECT_NEAR(double(ground["force"][k]), 5, 0.01);
      EXPECT_NEAR(double(base["force"][k]), -5, 0.01);
    }
  }
}

// Spring, damper, stop and motors of a slider along z, where the weight of 10 N acts.
TEST_F(Joints, HaveSpringsDampersStopsAndMotorsOnTheirWay) {
  const std::string slider = "kind = \"slider\"\naxis = [0, 0, 1]\n";
  for (const char* bodies : {to_the_ground, to_the_base}) {
    const auto value = [&](const std::string& keys) {
      return double(frames_of(led_box(bodies, slider + keys)).back()["joints"]["joint"]["value"]);
    };
    // m z'' = -m g - k z - d z' from rest, with 0.1 s as the time of decay.
    const double decay = 10, w = std::sqrt(400 - decay * decay), end = 0.2;
    const double still = -10.0 / 400;
    const double moved =
        still - still * std::exp(-decay * end) * (std::cos(w * end) + decay / w * std::sin(w * end));
    EXPECT_NEAR(value("stiffness = 400\ndamping = 20"), moved, 2e-5);
    EXPECT_NEAR(value("stiffness = 400\ndamping = 20\nrest = 0.025"), 0, 1e-9);
    const std::string stopped = led_box(bodies, slider + "limits = [-0.05, 1]\ndamping = 20");
    double lowest = 0;
    for (const json& frame : frames_of(stopped))
      lowest = std::min(lowest, double(frame["joints"]["joint"]["value"]));
    EXPECT_NEAR(lowest, -0.05, 1e-3);
    EXPECT_GT(lowest, -0.05 - 1e-5);
    EXPECT_NEAR(value("motor = { force = 30 }"), 0.5 * 20 * end * end, 1e-4);
    EXPECT_NEAR(value("motor = { velocity = 0.7, time_function = { ramp = { from = 0, until = 0.2 } } }"),
                0.07, 1e-4);
    EXPECT_NEAR(value("motor = { position = 0.05, time_function = { ramp = { from = 0, until = 0.1 } } }"),
                0.05, 1e-4);
  }
}

// A box with the moment of inertia m a^2 / 6 about an axis through its centre.
TEST_F(Joints, HaveSpringsDampersStopsAndMotorsOfTheirAngle) {
  const double inertia = 0.01 / 6, end = 0.2;
  for (const char* bodies : {to_the_ground, to_the_base}) {
    const auto value = [&](const std::string& keys) {
      return double(frames_of(led_box(bodies, "kind = \"hinge\"\naxis = [0, 0, 1]\n" + keys))
                        .back()["joints"]["joint"]["value"]);
    };
    EXPECT_NEAR(value("motor = { torque = 0.02 }"), 0.5 * 0.02 / inertia * end * end, 1e-4);
    // To 20 / 3 rad/s in 1 / 60 s, and on at this speed.
    EXPECT_NEAR(value("damping = 0.003\nmotor = { torque = 0.02 }"),
                0.02 / 0.003 * (end - inertia / 0.003 * (1 - std::exp(-end * 0.003 / inertia))), 1e-3);
    EXPECT_NEAR(value("stiffness = 2\ndamping = 0.1\nmotor = { torque = 0.2 }"), 0.1, 5e-3);
    EXPECT_NEAR(value("motor = { velocity = 5, time_function = { ramp = { from = 0, until = 0.1 } } }"), 0.75,
                2e-3);
  }
}

std::string in_statics(const std::string& scene) {
  return "[simulation]\ngravity = [0, 0, -10]\n" + scene.substr(scene.find("\n[contact]"));
}

// Motors push joints beyond their stops; springs hold them against the weight and against each other.
TEST_F(Joints, HaveStopsAndSpringsInStatics) {
  for (const char* bodies : {to_the_ground, to_the_base}) {
    const auto joint = [&](const std::string& keys) {
      return frames_of(in_statics(led_box(bodies, keys))).back()["joints"]["joint"];
    };
    const std::string slider = "kind = \"slider\"\naxis = [0, 0, 1]\n";
    const std::string hinge = "kind = \"hinge\"\naxis = [1, 0, 0]\n";
    EXPECT_NEAR(double(joint(slider + "stiffness = 400")["value"]), -10.0 / 400, 1e-9);
    const json stopped = joint(slider + "limits = [-0.05, 1]\nmotor = { position = -0.1, stiffness = 400 }");
    EXPECT_NEAR(double(stopped["value"]), -0.05, 1e-4);
    EXPECT_NEAR(std::abs(double(stopped["force"][2])), 10, 1e-6);  // motor and stop together
    EXPECT_NEAR(double(joint(hinge + "stiffness = 3\nmotor = { torque = 1.5 }")["value"]), 0.5, 1e-6);
    EXPECT_NEAR(
        double(joint(hinge + "limits = [-0.2, 0.3]\nmotor = { position = 1, stiffness = 3 }")["value"]), 0.3,
        1e-4);
  }
}

/// A rod that a motor turns at 4 rad/s, and a bead of 0.1 kg that slides out along it from 0.2 m.
const std::string bead_on_a_rod = R"(
[simulation]
kind = "dynamic"
dimension = 2
time_step = 0.002
end_time = 0.5
integrator = "tr_bdf2"

[[body]]
name = "rod"
mesh = { box = { size = [1, 0.02], cells = [1, 1], origin = [0, -0.01] } }
rigid = { density = 500 }
velocity_gradient = [[0, -4], [4, 0]]

[[body]]
name = "bead"
mesh = { box = { size = [0.02, 0.02], cells = [1, 1], origin = [0.19, -0.01] } }
rigid = { density = 250 }
velocity_gradient = [[0, -4], [4, 0]]

[[joint]]
name = "shaft"
kind = "hinge"
bodies = ["rod"]
at = [0, 0]
motor = { velocity = 4 }

[[joint]]
name = "slider"
kind = "slider"
bodies = ["rod", "bead"]
at = [0.2, 0]
axis = [1, 0]
)";

// r = 0.2 cosh(4 t), with the force 2 m w r' across the rod.
TEST_F(Joints, LetABeadSlideOutOnATurningRod) {
  const json frame = frames_of(bead_on_a_rod).back();
  const double r = 0.2 * std::cosh(2.0), rate = 0.8 * std::sinh(2.0);
  const json slider = frame["joints"]["slider"];
  EXPECT_NEAR(double(slider["value"]), r - 0.2, 1e-3 * r);
  EXPECT_NEAR(std::hypot(double(slider["force"][0]), double(slider["force"][1])), 2 * 0.1 * 4 * rate, 0.03);
  EXPECT_LT(double(slider["gap"]), 1e-5);
  EXPECT_NEAR(double(frame["joints"]["shaft"]["value"]), 2, 1e-3);
}

/// Two shafts at an angle of 0.5 rad, each in a hinge, joined by a universal joint; a motor turns the first.
const std::string shafts = R"(
[simulation]
load_steps = 4

[[body]]
name = "first"
mesh = { box = { size = [0.3, 0.05, 0.05], cells = [1, 1, 1], origin = [-0.3, -0.025, -0.025] } }
rigid = true

[[body]]
name = "second"
mesh = { box = { size = [0.3, 0.05, 0.05], cells = [1, 1, 1], origin = [0, -0.025, -0.025] } }
rotate = [0, 0, 1, 28.64788975654116]
rigid = true

[[joint]]
name = "motor"
kind = "hinge"
bodies = ["first"]
at = [-0.2, 0, 0]
axis = [1, 0, 0]
motor = { position = 1.2 }

[[joint]]
name = "universal"
kind = "universal"
bodies = ["first", "second"]
at = [0, 0, 0]
axis = [0, 0, 1]
second_axis = [-0.479425538604203, 0.8775825618903728, 0]

[[joint]]
name = "output"
kind = "hinge"
bodies = ["second"]
at = [0.17551651237807455, 0.0958851077208406, 0]
axis = [0.8775825618903728, 0.479425538604203, 0]
)";

TEST_F(Joints, TurnTwoShaftsByAUniversalJoint) {
  const json joints = frames_of(shafts).back()["joints"];
  EXPECT_NEAR(double(joints["motor"]["value"]), 1.2, 1e-6);
  EXPECT_NEAR(double(joints["output"]["value"]), std::atan(std::cos(0.5) * std::tan(1.2)), 1e-5);
  EXPECT_LT(double(joints["universal"]["gap"]), 1e-7);
}

TEST_F(Joints, RefuseKeysThatAreNotTheirs) {
  const auto error = [&](const std::string& keys) { return error_of(led_box(to_the_base, keys), "title=x"); };
  const std::string slider = "kind = \"slider\"\naxis = [1, 0, 0]\n";
  EXPECT_THAT(error(slider + "motor = { torque = 1 }"), HasSubstr("the motor of a slider has a force"));
  EXPECT_THAT(error(slider + "motor = { force = 1, velocity = 1 }"), HasSubstr("one of position, velocity"));
  EXPECT_THAT(error(slider + "motor = { force = 1, stiffness = 1 }"), HasSubstr("has no stiffness"));
  EXPECT_THAT(error(slider + "limits = [0.1, 1]"), HasSubstr("with 0 among them, got [0.1, 1]"));
  EXPECT_THAT(error(slider + "rest = 0.1"), HasSubstr("give stiffness, too"));
  EXPECT_THAT(error("kind = \"hinge\"\naxis = [1, 0, 0]\nlimits = [-4, 4]"),
              HasSubstr("less than a turn apart"));
  EXPECT_THAT(error("kind = \"universal\"\naxis = [1, 0, 0]\nsecond_axis = [1, 1, 0]"),
              HasSubstr("both axes of a universal joint are orthogonal"));
  EXPECT_THAT(error_of(bead_on_a_rod, "joint.1.kind=cylindrical"),
              HasSubstr("joints of this kind are for 3D"));
  EXPECT_THAT(error_of(bead_on_a_rod, "body.1.velocity_gradient=[[0,0],[0,0]]"),
              HasSubstr("one velocity at the joint"));
}

/// Two bars in free flight that turn about the end of the first one.
const std::string free_chain = R"(
[simulation]
kind = "dynamic"
dimension = 2
time_step = 0.005
end_time = 0.2

[[body]]
name = "one"
mesh = { box = { size = [0.08, 0.02], cells = [1, 1], origin = [0, -0.01] } }
rigid = { density = 800 }
velocity_gradient = [[0, -6], [6, 0]]

[[body]]
name = "two"
mesh = { box = { size = [0.04, 0.01], cells = [1, 1], origin = [0.08, -0.005] } }
rigid = { density = 500 }
velocity_gradient = [[0, -6], [6, 0]]

[[joint]]
kind = "ball"
bodies = ["one", "two"]
at = [0.08, 0]
)";

/// The energy guard slows down what bodies do within, not the flight of what is joined.
TEST_F(Joints, KeepTheMomentumOfWhatFliesFreely) {
  for (const std::string integrator : {"backward_euler", "bdf2", "tr_bdf2", "newmark", "midpoint"}) {
    const json frames = frames_of(free_chain, {"simulation.integrator=" + integrator});
    const json start = frames.front()["momentum"]["linear"], end = frames.back()["momentum"]["linear"];
    EXPECT_NEAR(double(start[1]), 6 * (1.28 * 0.04 + 0.2 * 0.1), 1e-12);
    for (std::size_t i : {0, 1}) EXPECT_NEAR(double(end[i]), double(start[i]), 1e-9) << integrator;
  }
}

/// A box on a ball joint, which spins about its axis of symmetry and falls to the side.
const std::string heavy_top = R"(
[simulation]
kind = "dynamic"
gravity = [0, 0, -9.81]
time_step = 0.001
end_time = 0.25
integrator = "newmark"

[[body]]
name = "top"
mesh = { box = { size = [0.2, 0.2, 0.1], cells = [1, 1, 1], origin = [-0.1, -0.1, 0.1] } }
rotate = [1, 0, 0, 28.64788975654116]
rigid = { density = 1000 }
velocity_gradient = [[0, -52.654953713422362, -28.765532316252180], [52.654953713422362, 0, 0],
                     [28.765532316252180, 0, 0]]

[[joint]]
name = "pivot"
kind = "ball"
bodies = ["top"]
at = [0, 0, 0]
)";

// The place of its axis by Runge and Kutta's method.
TEST_F(Joints, CarryAHeavyTop) {
  const json start = frames_of(heavy_top).front(), end = frames_of(heavy_top).back();
  const Vector3 axis(0.616174382078993, -0.5305256786804292, 0.582126820486946);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(double(end["rigid_bodies"]["top"]["position"][i]) / 0.15, axis[static_cast<Eigen::Index>(i)],
                5e-4);
  const double energy = start["energy"]["total"];
  EXPECT_NEAR(energy, 48, 1e-9);
  EXPECT_NEAR(double(end["energy"]["total"]), energy, 5e-3 * energy);
}

/// A crank of 0.1 m that turns at 20 rad/s, a connecting rod of 0.25 m and a slider, which a [[fix]] leads.
const std::string slider_crank = R"(
[simulation]
kind = "dynamic"
dimension = 2
time_step = 0.001
end_time = 0.2
integrator = "tr_bdf2"

[[body]]
name = "crank"
mesh = { box = { size = [0.1, 0.001], cells = [1, 1], origin = [0, -0.0005] } }
rotate = [17.188733853924695]
rigid = { density = 5000 }
velocity_gradient = [[0, -20], [20, 0]]

[[body]]
name = "rod"
mesh = { box = { size = [0.25, 0.001], cells = [1, 1], origin = [0, -0.0005] } }
rotate = [-6.78869720193759]
translate = [0.09553364891256061, 0.029552020666133955]
rigid = { density = 1600 }
velocity = [-0.8184921013887929, 2.6459624516095843]
velocity_gradient = [[0, 7.69665433831972], [-7.69665433831972, 0]]

[[body]]
name = "slider"
mesh = { box = { size = [0.02, 0.02], cells = [1, 1], origin = [0.333780860527411, -0.01] } }
rigid = { density = 2000 }
velocity = [-0.8184921013887929, 0]

[[fix]]
body = "slider"
where = { group = "y_min" }
components = "y"

[[joint]]
name = "shaft"
kind = "hinge"
bodies = ["crank"]
at = [0, 0]

[[joint]]
kind = "hinge"
bodies = ["crank", "rod"]
at = [0.09553364891256061, 0.029552020666133955]

[[joint]]
kind = "hinge"
bodies = ["rod", "slider"]
at = [0.343780860527411, 0]
)";

// Places by Runge and Kutta's method.
TEST_F(Joints, MoveASliderByACrank) {
  const json frames = frames_of(slider_crank);
  const auto place = [&](double time) {
    return double(
        frames[static_cast<std::size_t>(time / 0.001 + 0.5)]["rigid_bodies"]["slider"]["position"][0]);
  };
  EXPECT_NEAR(place(0.05), 0.28858137105659587, 5e-5);
  EXPECT_NEAR(place(0.2), 0.1515818411473112, 5e-5);
  const double energy = frames[0]["energy"]["total"];
  EXPECT_NEAR(energy, 0.9448844766771384, 1e-4);
  for (const json& frame : frames) EXPECT_NEAR(double(frame["energy"]["total"]), energy, 3e-3 * energy);
}

/// An arm of two boxes, of 1 kg each, that stands out from a wall.
const std::string arm = R"(
[simulation]
gravity = [0, 0, -10]

[[body]]
name = "one"
mesh = { box = { size = [0.1, 0.1, 0.1], cells = [1, 1, 1] } }
rigid = { density = 1000 }

[[body]]
name = "two"
mesh = { box = { size = [0.1, 0.1, 0.1], cells = [1, 1, 1], origin = [0.1, 0, 0] } }
rigid = { density = 1000 }

[[joint]]
name = "wall"
kind = "fixed"
bodies = ["one"]
at = [0, 0.05, 0.05]

[[joint]]
name = "elbow"
kind = "hinge"
bodies = ["one", "two"]
at = [0.1, 0.05, 0.05]
axis = [0, 1, 0]
motor = { position = 0 }
)";

TEST_F(Joints, HoldAChainInStatics) {
  const json frame = frames_of(arm).back();
  const json wall = frame["joints"]["wall"], elbow = frame["joints"]["elbow"];
  EXPECT_NEAR(double(wall["force"][2]), 20, 1e-6);
  EXPECT_NEAR(double(wall["moment"][1]), -10 * 0.05 - 10 * 0.15, 1e-5);
  EXPECT_NEAR(double(elbow["force"][2]), -10, 1e-6);  // on the first one
  EXPECT_NEAR(double(elbow["moment"][1]), 10 * 0.05, 1e-5);
  EXPECT_NEAR(double(elbow["value"]), 0, 1e-4);
  folder.write("free.toml", arm.substr(0, arm.find("motor")));
  const ProgramResult free = run_program(folder.path(), {"run", "free.toml"});
  EXPECT_EQ(free.exit_code, 1);
  EXPECT_THAT(free.err,
              HasSubstr("body \"two\" is not constrained: 1 of 6 rigid-body motions are free in a static "
                        "analysis: rotation about y through (0.1, 0.05, 0.05)"));
}

}  // namespace
}  // namespace resilin::testing
