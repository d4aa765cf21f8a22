// Steps in sequence: the time functions that they are read into, and what is refused.

#include <gtest/gtest.h>

#include "resilin/simulation/simulation.hpp"
#include "scene_text.hpp"

namespace resilin::testing {
namespace {

const std::string press_and_release = R"(
[simulation]
kind = "static"
load_steps = 2

[[body]]
name = "block"
mesh = { box = { size = [1, 1, 1], cells = [2, 1, 1] } }
material = { law = "neo_hookean", youngs_modulus = 1e6, poissons_ratio = 0.3, density = 1000 }

[[fix]]
name = "wall"
where = { group = "x_min" }

[[fix]]
name = "grip"
where = { group = "x_max" }
components = "z"
displacement = [0, 0, 0.1]

[[load]]
name = "press"
kind = "traction"
where = { group = "x_max" }
value = [-2e4, 0, 0]

[[load]]
name = "shear"
kind = "traction"
where = { group = "x_max" }
value = [0, 1e4, 0]

[[collider]]
name = "plate"
kind = "half_space"
point = [1.5, 0, 0]
normal = [-1, 0, 0]
displacement = [-0.2, 0, 0]

[[step]]
name = "press"
activate = ["load.press"]

[[step]]
name = "move"
activate = ["fix.grip", "collider.plate"]

[[step]]
name = "hold"

[[step]]
name = "release"
deactivate = ["load.press", "collider.plate"]

[[step]]
name = "again"
activate = ["load.press"]

[[probe]]
name = "tip"
at = [1, 0.5, 0.5]
)";

std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the scene has no " + from);
  return text.replace(at, from.size(), to);
}

std::string error_of(const std::string& from, const std::string& to) {
  return input_error([&] { read_text(changed(press_and_release, from, to)); });
}

void expect_values(const TimeFunction& f, const std::vector<std::array<double, 2>>& points) {
  for (const auto& [time, value] : points) EXPECT_NEAR(f.value(time), value, 1e-14) << "at " << time;
}

TEST(Steps, OfStaticsAreRampsOfWhatTheyName) {
  const Description d = read_text(press_and_release).description;
  EXPECT_EQ(d.end_time, 5);
  EXPECT_EQ(d.load_steps, 10);
  expect_values(d.loads[0].time_function,
                {{0, 0}, {0.5, 0.5}, {1, 1}, {3, 1}, {3.5, 0.5}, {4, 0}, {4.25, 0.25}, {5, 1}});
  expect_values(d.fixes[1].time_function, {{0, 0}, {1, 0}, {1.5, 0.5}, {2, 1}, {5, 1}});
  expect_values(d.colliders[0].time_function, {{1, 0}, {2, 1}, {3, 1}, {3.5, 0.5}, {4, 0}, {5, 0}});
  // An entry that no step names belongs to the first.
  expect_values(d.loads[1].time_function, {{0, 0}, {0.5, 0.5}, {1, 1}, {5, 1}});
}

TEST(Steps, OfMotionSwitchLoadsAtOnceAndMoveTheRestEvenly) {
  std::string text = changed(press_and_release, "\"static\"", "\"dynamic\"\ntime_step = 0.1");
  for (const char* name : {"press", "move", "hold", "release", "again"}) {
    const std::string head = "[[step]]\nname = \"" + std::string(name) + "\"";
    text = changed(text, head, head + "\nduration = 0.5");
  }
  const Description d = read_text(text).description;
  EXPECT_EQ(d.end_time, 2.5);
  expect_values(d.loads[0].time_function,
                {{0, 1}, {0.1, 1}, {1.5, 1}, {1.5001, 0}, {2, 0}, {2.0001, 1}, {2.5, 1}});
  EXPECT_EQ(d.loads[0].time_function.rate(1.5), 0);
  EXPECT_EQ(d.loads[0].time_function.rate(1.6), 0);
  expect_values(d.fixes[1].time_function, {{0, 0}, {0.5, 0}, {0.75, 0.5}, {1, 1}, {2.5, 1}});
  EXPECT_TRUE(d.loads[1].time_function.is_constant());
}

VectorX end_of(Simulation& simulation) {
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
    if (report.status != StepReport::Status::converged) break;
  }
  return simulation.state().positions;
}

/// The state at the end of the first step is that of the load alone, and releasing all leads back.
TEST(Steps, ArePathsThatLeadThereAndBack) {
  const std::string all =
      changed(changed(changed(press_and_release, "activate = [\"fix.grip\", \"collider.plate\"]", ""),
                      "[\"load.press\", \"collider.plate\"]", "[\"load.press\", \"load.shear\"]"),
              "activate = [\"load.press\"]\n\n[[step]]\nname = \"move\"",
              "activate = [\"load.press\", \"load.shear\"]\n\n[[step]]\nname = \"move\"");
  const std::string there_and_back =
      changed(changed(all, "[[step]]\nname = \"again\"\nactivate = [\"load.press\"]", ""),
              "displacement = [0, 0, 0.1]", "");
  std::string without = there_and_back;
  without.erase(without.find("[[step]]"), without.find("[[probe]]") - without.find("[[step]]"));
  Simulation whole(read_text(there_and_back).description), only(read_text(without).description);
  const VectorX loaded = end_of(only), rest = whole.world().rest_positions;
  const double moved = (loaded - rest).norm();
  ASSERT_GT(moved, 1e-3);
  int num_met = 0;
  while (!whole.is_finished()) {
    ASSERT_EQ(whole.step().status, StepReport::Status::converged);
    const double time = whole.state().time;
    if (std::abs(time - 1) > 1e-12 && std::abs(time - 3) > 1e-12) continue;
    ++num_met;
    EXPECT_LT((whole.state().positions - loaded).norm(), 1e-7 * moved) << "at " << time;
  }
  EXPECT_EQ(num_met, 2);
  EXPECT_LT((whole.state().positions - rest).norm(), 1e-7 * moved);
}

TEST(Steps, GoOnFromACheckpointInsideOneToTheSameBits) {
  const Description d = read_text(press_and_release).description;
  Simulation whole(d), resumed(d);
  while (whole.state().time < 1.25) ASSERT_EQ(whole.step().status, StepReport::Status::converged);
  const State saved = deserialize_state(serialize(whole.state()), "here");
  resumed.resume_from(saved, "here");
  const VectorX a = end_of(whole), b = end_of(resumed);
  EXPECT_TRUE(a == b);
}

/// Each step gets as many increments, however long it is.
TEST(Steps, OfUnequalDurationHaveEqualNumbersOfIncrements) {
  std::string text = press_and_release;
  for (const auto& [name, duration] : {std::pair{"move", "0.001"}, {"hold", "1000"}, {"again", "7"}})
    text = changed(text, "name = \"" + std::string(name) + "\"\n",
                   "name = \"" + std::string(name) + "\"\nduration = " + duration + "\n");
  Simulation block(read_text(text).description);
  std::vector<double> times;
  while (!block.is_finished()) {
    const StepReport report = block.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
    times.push_back(block.state().time);
  }
  const std::vector<double> asked = {0.5,      1,        1.0005,   1.001,    501.001,
                                     1001.001, 1001.501, 1002.001, 1005.501, 1009.001};
  ASSERT_EQ(times.size(), asked.size());
  for (std::size_t i = 0; i < asked.size(); ++i) EXPECT_NEAR(times[i], asked[i], 1e-9 * asked[i]);
  Simulation equal(read_text(press_and_release).description);
  EXPECT_LT((end_of(equal) - block.state().positions).norm(), 1e-7);
}

TEST(Steps, RefuseInOneLineWhatIsWrong) {
  struct Wrong {
    std::string from, to, message;
  };
  const std::string hold = "name = \"hold\"";
  for (const auto& [from, to, expected] : {
           Wrong{"\"fix.grip\"", "\"fix.gripp\"", "did you mean \"fix.grip\"?"},
           Wrong{hold, "name = \"press\"", "another step is called \"press\""},
           Wrong{hold, hold + "\nduration = 0", "expected a number > 0, got 0"},
           Wrong{hold, hold + "\nactivate = [\"load.press\"]", "\"load.press\" is active already"},
           Wrong{hold, hold + "\nactivate = \"load.press\"", "expected a list of names"},
           Wrong{hold, hold + "\nactivate = [\"fix.wall\"]", "it has no displacement"},
           Wrong{hold, hold + "\nactivate = [\"fix.grip\"]", "\"fix.grip\" is active already"},
           Wrong{hold, hold + "\nactivate = [\"gravity\"]", "what a step can switch in this scene"},
           Wrong{hold, hold + "\nactivate = [\"contact.block/blok\"]",
                 "did you mean \"contact.block/block\"?"},
           Wrong{hold, hold + "\ndeactivate = [\"load.shear\"]", "no step before activates \"load.shear\""},
           Wrong{"[\"load.press\", \"collider.plate\"]", "[\"load.press\", \"load.press\"]",
                 "is twice in one step"},
           Wrong{"name = \"again\"", "name = \"again\"\ndeactivate = [\"collider.plate\"]",
                 "\"collider.plate\" is not active here"},
           Wrong{"value = [-2e4, 0, 0]", "value = [-2e4, 0, 0]\nuntil = 3", "says when it acts"},
           Wrong{"load_steps = 2", "end_time = 3", "add up to the end"},
           Wrong{"load_steps = 2", "load_control = \"arc_length\"", "one load path"},
           Wrong{"\"static\"", "\"modes\"", "a modal analysis has no steps"},
           Wrong{"\"static\"", "\"dynamic\"", "needs the key \"duration\""},
       }) {
    const std::string message = error_of(from, to);
    EXPECT_NE(message.find(expected), message.npos) << to << ": " << message;
    EXPECT_EQ(message.find('\n'), message.npos) << message;
  }
}

/// A bar that is pulled, let go, and held again where it then is.
const std::string pulled_bar = R"(
[simulation]
kind = "static"
load_steps = 2

[[body]]
name = "bar"
mesh = { box = { size = [2, 1, 1], cells = [3, 1, 1] } }
material = { law = "neo_hookean", youngs_modulus = 1e6, poissons_ratio = 0.3, density = 1000 }

[[fix]]
name = "wall"
where = { group = "x_min" }

[[fix]]
name = "grip"
where = { group = "x_max" }
displacement = [0.3, 0, 0]

[[load]]
name = "shear"
kind = "traction"
where = { group = "x_max" }
value = [0, 1e4, 0]

[[step]]
name = "pull"
activate = ["fix.grip"]

[[step]]
name = "let go"
deactivate = ["fix.grip"]

[[step]]
name = "shear"
activate = ["load.shear"]

[[step]]
name = "hold"
activate = ["fix.grip"]

[[step]]
name = "unload"
deactivate = ["load.shear"]
)";

void step_to(Simulation& simulation, double time) {
  while (simulation.state().time < time - 1e-9) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
  }
}

const Vector3& reaction_of(const Simulation& simulation, const std::string& name) {
  for (const auto& [known, force] : simulation.frame().reactions)
    if (known == name) return force;
  throw std::logic_error("no reaction of " + name);
}

/// The mean displacement of the grip.
Vector3 grip_of(const Simulation& simulation) {
  const World& world = simulation.world();
  Vector3 sum = Vector3::Zero();
  for (const Index node : world.supports[1].nodes)
    sum += (simulation.state().positions - world.rest_positions).segment(3 * node, 3);
  return sum / static_cast<double>(world.supports[1].nodes.size());
}

TEST(Steps, ReleaseASupportWhoseForceFadesInStatics) {
  Simulation bar(read_text(pulled_bar).description);
  step_to(bar, 1);
  EXPECT_EQ(bar.frame().step_name, "pull");
  const double pull = reaction_of(bar, "grip").x();
  ASSERT_GT(pull, 1e5);
  step_to(bar, 1.5);
  EXPECT_EQ(bar.frame().step_name, "let go");
  EXPECT_NEAR(reaction_of(bar, "grip").x(), 0.5 * pull, 1e-9 * pull);
  EXPECT_NEAR(reaction_of(bar, "wall").x(), -0.5 * pull, 1e-6 * pull);
  step_to(bar, 2);
  EXPECT_LT((bar.state().positions - bar.world().rest_positions).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(reaction_of(bar, "grip").norm(), 0);
  step_to(bar, 3);
  const Vector3 sheared = grip_of(bar);
  EXPECT_GT(sheared.y(), 1e-2);
  // Held where it is, it moves from there by its displacement.
  step_to(bar, 4);
  EXPECT_LT((grip_of(bar) - sheared - Vector3(0.3, 0, 0)).norm(), 1e-12);
  step_to(bar, 5);
  EXPECT_LT((grip_of(bar) - sheared - Vector3(0.3, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(bar.frame().step_name, "unload");
}

/// Reactions that a load leaves when it goes are rounding, which no search could balance.
TEST(Steps, ReleaseASupportWhoseForceIsRounding) {
  Simulation strip(read_text(R"(
[simulation]
dimension = 2
load_steps = 3

[[body]]
name = "strip"
mesh = { box = { size = [0.024995406216807046, 0.0062488515542017615], cells = [4, 2] } }
material = { law = "neo_hookean", youngs_modulus = 340176.82404949534, poissons_ratio = 0.3, density = 1000 }

[[fix]]
name = "wall"
where = { group = "x_min" }

[[fix]]
name = "far"
where = { group = "x_max" }

[[fix]]
name = "top"
where = { group = "y_max" }

[[load]]
name = "shear"
kind = "traction"
where = { group = "y_min" }
value = [886.2370884199961, -284.26714584240426]

[[step]]
name = "load"
activate = ["load.shear"]

[[step]]
name = "unload"
deactivate = ["load.shear"]

[[step]]
name = "let go"
deactivate = ["fix.far", "fix.top"]

[newton]
tolerance = 1e-10
)")
                       .description);
  step_to(strip, 1);
  EXPECT_GT(reaction_of(strip, "top").norm(), 1);
  step_to(strip, 3);
  EXPECT_EQ(reaction_of(strip, "top").norm(), 0);
  EXPECT_LT((strip.state().positions - strip.world().rest_positions).cwiseAbs().maxCoeff(), 1e-15);
}

/// The grip takes over what the load has held.
TEST(Steps, HoldASupportFromALaterStepOn) {
  std::string text = changed(pulled_bar, "displacement = [0.3, 0, 0]", "");
  text =
      changed(text, "activate = [\"fix.grip\"]\n\n[[step]]\nname = \"let go\"\ndeactivate = [\"fix.grip\"]",
              "deactivate = [\"fix.grip\"]");
  Simulation bar(read_text(text).description);
  step_to(bar, 2);
  const VectorX sheared = bar.state().positions;
  ASSERT_GT(grip_of(bar).y(), 1e-2);
  EXPECT_EQ(reaction_of(bar, "grip").norm(), 0);
  step_to(bar, 4);
  EXPECT_LT((bar.state().positions - sheared).cwiseAbs().maxCoeff(), 1e-6);
  for (const Index node : bar.world().supports[1].nodes)
    EXPECT_TRUE(bar.state().positions.segment(3 * node, 3) == sheared.segment(3 * node, 3));
  EXPECT_NEAR(reaction_of(bar, "grip").y(), 1e4, 0.1);
}

TEST(Steps, GoOnFromACheckpointInsideAReleaseToTheSameBits) {
  for (const bool is_dynamic : {false, true}) {
    std::string text = pulled_bar;
    if (is_dynamic) {
      text = changed(text, "\"static\"", "\"dynamic\"\ntime_step = 0.01\nintegrator = \"newmark\"");
      for (const char* name : {"pull", "let go", "shear", "hold", "unload"}) {
        const std::string head = "[[step]]\nname = \"" + std::string(name) + "\"";
        text = changed(text, head, head + "\nduration = 0.05");
      }
    }
    const Description d = read_text(text).description;
    for (const double at : {1.0, 1.5, 3.0, 3.5, 4.5}) {
      Simulation whole(d), resumed(d);
      step_to(whole, is_dynamic ? 0.05 * at : at);
      const State saved = deserialize_state(serialize(whole.state()), "here");
      resumed.resume_from(saved, "here");
      const VectorX a = end_of(whole), b = end_of(resumed);
      EXPECT_TRUE(a == b) << at;
    }
  }
}

TEST(Steps, ReleaseASupportAtOnceInMotion) {
  std::string text =
      changed(pulled_bar, "\"static\"", "\"dynamic\"\ntime_step = 0.002\nintegrator = \"midpoint\"");
  text = text.substr(0, text.find("[[load]]")) +
         "[[step]]\nname = \"pull\"\nduration = 1\nactivate = [\"fix.grip\"]\n"
         "[[step]]\nname = \"let go\"\nduration = 0.1\ndeactivate = [\"fix.grip\"]\n";
  Simulation bar(read_text(text).description);
  step_to(bar, 1);
  const double energy = bar.frame().total_energy();
  EXPECT_NEAR(grip_of(bar).x(), 0.3, 1e-12);
  EXPECT_GT(reaction_of(bar, "grip").x(), 1e5);
  step_to(bar, 1.002);
  EXPECT_EQ(reaction_of(bar, "grip").norm(), 0);
  EXPECT_LT(grip_of(bar).x(), 0.3 - 1e-4);
  double least = 1;
  while (!bar.is_finished()) {
    ASSERT_EQ(bar.step().status, StepReport::Status::converged);
    least = std::min(least, grip_of(bar).x());
    EXPECT_NEAR(bar.frame().total_energy(), energy, 0.02 * energy);
  }
  EXPECT_LT(least, -0.1);  // it swings back through its rest shape
}

TEST(Steps, OfStaticsMayHaveGravity) {
  std::string with = pulled_bar.substr(0, pulled_bar.find("[[fix]]\nname = \"grip\""));
  std::string by_force = with;
  with = changed(with, "load_steps = 2", "gravity = [0, -9.81, 0]") +
         "[[step]]\nname = \"one\"\n[[step]]\nname = \"two\"\nactivate = [\"gravity\"]\n"
         "[[step]]\nname = \"three\"\ndeactivate = [\"gravity\"]\n";
  by_force += "[[load]]\nname = \"weight\"\nkind = \"body_force\"\nwhere = \"all\"\nvalue = [0, -9810, 0]\n";
  Simulation a(read_text(with).description), b(read_text(by_force).description);
  step_to(a, 1);
  EXPECT_TRUE(a.state().positions == a.world().rest_positions);
  step_to(a, 2);
  const VectorX heavy = end_of(b);
  const double moved = (heavy - b.world().rest_positions).norm();
  ASSERT_GT(moved, 1e-2);
  EXPECT_LT((a.state().positions - heavy).norm(), 1e-6 * moved);
  step_to(a, 3);
  EXPECT_LT((a.state().positions - a.world().rest_positions).norm(), 1e-7 * moved);
  // Named by no step it belongs to the first.
  const std::string unnamed =
      changed(changed(with, "activate = [\"gravity\"]", ""), "deactivate = [\"gravity\"]", "");
  Simulation c(read_text(unnamed).description);
  step_to(c, 1);
  EXPECT_LT((c.state().positions - heavy).norm(), 1e-6 * moved);
}

TEST(Steps, SwitchFriction) {
  const std::string sliding = R"(
[simulation]
dimension = 2
load_steps = 4

[[body]]
name = "block"
mesh = { box = { size = [0.2, 0.1], cells = [6, 3] } }
material = { law = "neo_hookean", youngs_modulus = 1e6, poissons_ratio = 0.3, density = 1000 }

[[fix]]
name = "top"
where = { group = "y_max" }
displacement = [0.02, -0.01]

[[collider]]
name = "floor"
kind = "half_space"
point = [0, -0.001]
normal = [0, 1]
friction = 0.4

[[step]]
name = "press"
activate = ["fix.top"]

[[step]]
name = "stick"
activate = ["collider.floor.friction"]

[[step]]
name = "slip"
deactivate = ["collider.floor.friction"]
)";
  Simulation block(read_text(sliding).description);
  step_to(block, 1);
  EXPECT_GT(reaction_of(block, "floor").y(), 1e3);
  EXPECT_LT(std::abs(reaction_of(block, "floor").x()), 1e-9 * reaction_of(block, "floor").y());
  std::string always = changed(sliding, "activate = [\"collider.floor.friction\"]", "");
  always = changed(always, "deactivate = [\"collider.floor.friction\"]", "");
  Simulation rubbing(read_text(always).description);
  step_to(rubbing, 1);
  EXPECT_LT(reaction_of(rubbing, "floor").x(), -0.1 * reaction_of(rubbing, "floor").y());
  step_to(block, 3);
  EXPECT_LT(std::abs(reaction_of(block, "floor").x()), 1e-9 * reaction_of(block, "floor").y());
}

TEST(Steps, ReleaseNoSupportThatLeavesABodyLoose) {
  const std::string loose =
      changed(pulled_bar, "deactivate = [\"fix.grip\"]", "deactivate = [\"fix.wall\", \"fix.grip\"]");
  const std::string message = input_error([&] { Simulation simulation(read_text(loose).description); });
  EXPECT_NE(message.find("step \"let go\": "), message.npos) << message;
  EXPECT_NE(message.find("body \"bar\" is not constrained"), message.npos) << message;
}

TEST(Steps, ReleaseNoSupportBesideWhatFollowsVertices) {
  const std::string tied = pulled_bar +
                           "[[constraint]]\nname = \"level\"\nkind = \"equal\"\ncomponents = \"y\"\n"
                           "where = { plane = { axis = \"x\", at = 0.667, tolerance = 0.1 } }\n";
  const std::string message = input_error([&] { Simulation simulation(read_text(tied).description); });
  EXPECT_NE(message.find("no step that releases it beside a constraint"), message.npos) << message;
}

}  // namespace
}  // namespace resilin::testing
