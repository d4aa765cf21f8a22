// Joints, springs and cables, from the scene file to the report.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

struct Scenes : ::testing::Test {
  TemporaryFolder folder;

  json frames_of(const std::string& scene, const std::vector<std::string>& settings = {}) const {
    folder.write("scene.toml", scene);
    std::vector<std::string> arguments = {"run", "scene.toml", "--quiet", "--set", "output.formats=[]"};
    for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
    const ProgramResult result = run_program(folder.path(), arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_json(folder / "out/scene/report.json")["frames"];
  }
  std::string error_of(const std::string& scene, const std::string& setting) const {
    folder.write("scene.toml", scene);
    const ProgramResult result = run_program(folder.path(), {"check", "scene.toml", "--set", setting});
    EXPECT_EQ(result.exit_code, 1) << setting;
    return result.err;
  }
};

struct Joints : Scenes {};
struct Cables : Scenes {};

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
  EXPECT_THAT(error("joint.0.kind=slider"), HasSubstr("\"ball\", \"hinge\", \"fixed\" or \"distance\""));
  EXPECT_THAT(error("body.0.velocity=[1,0,0]"), HasSubstr("one velocity at the joint"));
  const std::string fixed = hanging_box + R"(
[[fix]]
body = "box"
where = { group = "z_max" }
)";
  EXPECT_THAT(error_of(fixed, "title=x"), HasSubstr("leave the joint or a [[fix]] out"));
}

TEST_F(Cables, SwingABoxOnASpring) {
  const std::string spring = hanging_box.substr(0, hanging_box.find("[[joint]]")) + R"(
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

/// A block on a foot that a cable through its top pulls to the side of x.
const std::string pulled_block = R"(
[[body]]
name = "block"
mesh = { box = { size = [0.1, 0.1, 0.3], cells = [2, 2, 6] } }
element = "P1"
material = { law = "neo_hookean", youngs_modulus = 1e5, poissons_ratio = 0.3 }

[[fix]]
name = "foot"
where = { group = "z_min" }

[[cable]]
name = "cable"
points = [{ at = [0.2, 0.05, 0] }, { body = "block", at = [0.1, 0.05, 0.15] }, { body = "block", at = [0.1, 0.05, 0.3] }]
tension = 5
)";

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
