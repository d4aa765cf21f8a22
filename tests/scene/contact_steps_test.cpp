// Contact pairs that steps switch.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "resilin/simulation/simulation.hpp"
#include "scene_text.hpp"

namespace resilin::testing {
namespace {

/// One block is pressed onto another.
const std::string two_blocks = R"(
[simulation]
dimension = 2
load_steps = 2

[[body]]
name = "lower"
mesh = { box = { size = [1, 1], cells = [4, 4] } }
material = { law = "neo_hookean", youngs_modulus = 1e6, poissons_ratio = 0.3, density = 1000 }

[[body]]
name = "upper"
mesh = { box = { size = [1, 1], cells = [3, 3] } }
translate = [0, 1.01]
material = { law = "neo_hookean", youngs_modulus = 1e6, poissons_ratio = 0.3, density = 1000 }

[[fix]]
name = "ground"
body = "lower"
where = { group = "y_min" }

[[fix]]
name = "top"
body = "upper"
where = { group = "y_max" }
displacement = [0, -0.1]
)";

const std::string press_and_part = two_blocks + R"(
[[step]]
name = "press"
activate = ["fix.top"]

[[step]]
name = "part"
deactivate = ["contact.upper/lower"]
)";

std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the scene has no " + from);
  return text.replace(at, from.size(), to);
}

void step_to(Simulation& simulation, double time) {
  while (simulation.state().time < time - 1e-9) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
  }
}

double push_of(const Simulation& simulation, const std::string& name) {
  for (const auto& [known, force] : simulation.frame().reactions)
    if (known == name) return force.y();
  throw std::logic_error("no reaction of " + name);
}

double moved(const Simulation& simulation, std::size_t body) {
  const World& world = simulation.world();
  const auto first = Eigen::Index{2} * world.bodies[body].first_node,
             count = Eigen::Index{2} * world.bodies[body].num_nodes;
  return (simulation.state().positions - world.rest_positions).segment(first, count).cwiseAbs().maxCoeff();
}

TEST(ContactSteps, EndAPairWhoseForcesFade) {
  Simulation blocks(read_text(press_and_part).description);
  step_to(blocks, 1);
  const double push = push_of(blocks, "ground");
  ASSERT_GT(push, 1e4);
  ASSERT_EQ(blocks.frame().contacts.size(), 1u);
  EXPECT_NEAR(push_of(blocks, "top"), -push, 1e-6 * push);
  step_to(blocks, 1.5);
  EXPECT_TRUE(blocks.frame().contacts.empty());
  // Half of the forces are left, exactly: they are dead loads.
  EXPECT_NEAR(push_of(blocks, "ground"), 0.5 * push, 1e-6 * push);
  EXPECT_NEAR(push_of(blocks, "top"), -0.5 * push, 1e-6 * push);
  step_to(blocks, 2);
  EXPECT_NEAR(push_of(blocks, "ground"), 0, 1e-6 * push);
  EXPECT_LT(moved(blocks, 0), 1e-6);         // relieved
  EXPECT_NEAR(moved(blocks, 1), 0.1, 1e-6);  // moves as one, into the other
}

/// Left out while the one passes the other, contact acts from the other side then.
TEST(ContactSteps, BeginBetweenBodiesThatHavePassedEachOther) {
  const std::string passes =
      changed(changed(two_blocks, "displacement = [0, -0.1]", "displacement = [0, -2.2]"),
              "where = { group = \"y_min\" }", "where = { group = \"x_min\" }") +
      R"(
[[fix]]
name = "lift"
body = "upper"
where = { group = "y_min" }
displacement = [0, 0.29]

[[step]]
name = "pass"
activate = ["fix.top"]
deactivate = ["fix.lift"]

[[step]]
name = "push"
activate = ["contact.lower/upper", "fix.lift"]
deactivate = ["fix.top"]
)";
  Simulation blocks(read_text(passes).description);
  step_to(blocks, 1);
  EXPECT_TRUE(blocks.frame().contacts.empty());
  EXPECT_LT(moved(blocks, 0), 1e-9);
  step_to(blocks, 2);
  ASSERT_EQ(blocks.frame().contacts.size(), 1u);
  const double push = blocks.frame().contacts[0].force.y();
  EXPECT_LT(push, -1e3);  // on the upper one, which is below
  EXPECT_NEAR(push_of(blocks, "ground"), push, 1e-6 * std::abs(push));
  EXPECT_NEAR(push_of(blocks, "lift"), -push, 1e-6 * std::abs(push));
}

TEST(ContactSteps, CannotBeginBetweenBodiesThatOverlap) {
  for (const bool is_dynamic : {false, true}) {
    std::string text = two_blocks + R"(
[[step]]
name = "press"
duration = 1
activate = ["fix.top"]

[[step]]
name = "meet"
duration = 1
activate = ["contact.lower/upper"]
)";
    if (is_dynamic) text = changed(text, "load_steps = 2", "kind = \"dynamic\"\ntime_step = 0.1");
    Simulation blocks(read_text(text).description);
    step_to(blocks, 1);
    const int steps = blocks.state().step;
    for (int again = 0; again < 2; ++again) {
      const StepReport report = blocks.step();
      EXPECT_EQ(report.status, StepReport::Status::not_converged);
      EXPECT_NE(report.reason.find("contact cannot begin in the step after \"press\": bodies \"lower\" and"),
                std::string::npos)
          << report.reason;
      EXPECT_EQ(blocks.state().step, steps);
    }
  }
}

TEST(ContactSteps, GoOnFromACheckpointToTheSameBits) {
  for (const bool is_dynamic : {false, true}) {
    std::string text = press_and_part;
    if (is_dynamic) {
      text = changed(text, "load_steps = 2", "kind = \"dynamic\"\ntime_step = 0.05");
      for (const char* name : {"press", "part"})
        text = changed(text, "name = \"" + std::string(name) + "\"",
                       "name = \"" + std::string(name) + "\"\nduration = 1");
    }
    text += "\n[contact]\nfriction = 0.3\n";
    const Description d = read_text(text).description;
    for (const double at : {0.5, 1.0, 1.5}) {
      Simulation whole(d), resumed(d);
      step_to(whole, at);
      resumed.resume_from(deserialize_state(serialize(whole.state()), "here"), "here");
      step_to(whole, 2);
      step_to(resumed, 2);
      EXPECT_TRUE(whole.state().positions == resumed.state().positions) << at;
    }
  }
}

/// The energy of the layers between the bodies counts as lost.
TEST(ContactSteps, EndAPairAtOnceInMotion) {
  std::string text = changed(press_and_part, "load_steps = 2",
                             "kind = \"dynamic\"\ntime_step = 0.001\nintegrator = \"midpoint\"");
  text = changed(changed(text, "name = \"press\"", "name = \"press\"\nduration = 1"), "name = \"part\"",
                 "name = \"part\"\nduration = 0.01");
  Simulation blocks(read_text(text).description);
  step_to(blocks, 1);
  ASSERT_EQ(blocks.frame().contacts.size(), 1u);
  const double energy = blocks.frame().total_energy() + blocks.state().dissipated_energy;
  step_to(blocks, 1.01);
  EXPECT_TRUE(blocks.frame().contacts.empty());
  EXPECT_NEAR(blocks.frame().total_energy() + blocks.state().dissipated_energy, energy, 0.02 * energy);
}

TEST(ContactSteps, RefuseInOneLineWhatIsWrong) {
  const auto error_of = [](const std::string& from, const std::string& to) {
    return input_error([&] { World(read_text(changed(press_and_part, from, to)).description); });
  };
  const std::string part = "deactivate = [\"contact.upper/lower\"]", press = "activate = [\"fix.top\"]";
  for (const auto& [from, to, expected] : std::vector<std::array<std::string, 3>>{
           {part, "deactivate = [\"contact.uper/lower\"]", "did you mean \"contact.upper/lower\"?"},
           {part, "activate = [\"contact.upper/lower\"]\n" + part, "is twice in one step"},
           {part, part + "\n[contact]\nenabled = false", "contact between bodies is disabled"},
           {press, press + "\n" + part, "\"contact.upper/lower\" is not active here"},
       }) {
    const std::string message = error_of(from, to);
    EXPECT_NE(message.find(expected), std::string::npos) << to << ": " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace resilin::testing
