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
           Wrong{hold, hold + "\ndeactivate = [\"fix.grip\"]", "steps release no support"},
           Wrong{hold, hold + "\ndeactivate = [\"load.shear\"]", "no step before activates \"load.shear\""},
           Wrong{"[\"load.press\", \"collider.plate\"]", "[\"load.press\", \"load.press\"]",
                 "is twice in one step"},
           Wrong{"name = \"again\"", "name = \"again\"\ndeactivate = [\"collider.plate\"]",
                 "\"collider.plate\" is not active here"},
           Wrong{"value = [-2e4, 0, 0]", "value = [-2e4, 0, 0]\nuntil = 3", "says when it acts"},
           Wrong{"load_steps = 2", "end_time = 3", "add up to the end"},
           Wrong{"load_steps = 2", "gravity = [0, 0, -9.81]", "kind \"body_force\""},
           Wrong{"load_steps = 2", "load_control = \"arc_length\"", "one load path"},
           Wrong{"\"static\"", "\"modes\"", "a modal analysis has no steps"},
           Wrong{"\"static\"", "\"dynamic\"", "needs the key \"duration\""},
       }) {
    const std::string message = error_of(from, to);
    EXPECT_NE(message.find(expected), message.npos) << to << ": " << message;
    EXPECT_EQ(message.find('\n'), message.npos) << message;
  }
}

}  // namespace
}  // namespace resilin::testing
