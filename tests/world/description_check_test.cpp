#include "resilin/world/description_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "resilin/core/text.hpp"
#include "resilin/world/load_catalog.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

struct Wrong {
  std::string name;
  std::function<void(Description&)> change;
  std::string message;
};
void PrintTo(const Wrong& wrong, std::ostream* stream) { *stream << wrong.name; }

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> load_kind_names() {
  std::vector<std::string> names;
  for (const LoadKind& kind : load_kinds()) names.push_back(kind.name);
  return names;
}

std::vector<Wrong> wrong_descriptions() {
  using D = Description;
  return {
      {"projection", [](D& d) { d.newton.projection = static_cast<ProjectionChoice>(9); },
       "newton.projection: expected one of auto, none, clamp, absolute, got the number 9"},
      {"inversion_bound", [](D& d) { d.newton.inversion_bound = static_cast<InversionBound>(2); },
       "newton.inversion_bound: expected one of points, everywhere"},
      {"mass", [](D& d) { d.bodies[0].mass = static_cast<MassKind>(-1); },
       "mass: expected one of lumped, consistent"},
      {"load_control", [](D& d) { d.load_control = static_cast<LoadControlKind>(5); },
       "simulation.load_control: expected one of load, arc_length"},
      {"unstable_modes", [](D& d) { d.unstable_modes = static_cast<UnstableModes>(3); },
       "simulation.unstable_modes: expected one of auto, count, skip"},
      {"on_jump", [](D& d) { d.on_jump = static_cast<OnJump>(2); },
       "simulation.on_jump: expected one of follow, stop"},
      {"format", [](D& d) { d.output.formats = {static_cast<OutputFormat>(3)}; },
       "output.formats: expected one of vtu, html, usda"},
      {"load_steps", [](D& d) { d.load_steps = 0; },
       "simulation.load_steps: expected a whole number >= 1, got 0"},
      {"max_steps", [](D& d) { d.max_steps = -3; }, "simulation.max_steps: expected a whole number >= 1"},
      {"every", [](D& d) { d.output.every = 0; }, "output.every: expected a whole number >= 1"},
      {"iterations", [](D& d) { d.newton.max_iterations = 0; }, "newton.max_iterations: expected"},
      {"tolerance", [](D& d) { d.newton.tolerance = nan; }, "newton.tolerance: expected a finite number > 0"},
      {"time_step", [](D& d) { d.time_step = -0.01; }, "simulation.time_step: expected a finite number > 0"},
      {"end_time", [](D& d) { d.end_time = infinity; }, "simulation.end_time: expected a finite number > 0"},
      {"gravity", [](D& d) { d.gravity.y() = nan; }, "simulation.gravity: expected finite numbers"},
      {"scale", [](D& d) { d.bodies[0].scale = 0; }, "scale: expected a finite number > 0"},
      {"dimension", [](D& d) { d.dimension = 4; }, "simulation.dimension: expected 2 or 3, got 4"},
      {"integrator", [](D& d) { d.integrator = "newmarc"; }, "simulation.integrator: expected one of"},
      {"solver", [](D& d) { d.solver.kind = "choleski"; }, "did you mean \"cholesky\"?"},
      {"load_kind",
       [](D& d) {
         d.loads.emplace_back();
         d.loads[0].place = "[[load]] 0";
         d.loads[0].kind = "tracton";
       },
       "[[load]] 0.kind: expected one of " + join(load_kind_names()) +
           ", got \"tracton\"; did you mean \"traction\"?"},
      {"axis_of_a_support", [](D& d) { d.fixes[0].where.axis = 1000; },
       "plane.axis: expected x, y or z (0, 1 or 2), got 1000"},
      {"axis_of_a_section",
       [](D& d) {
         d.sections.emplace_back();
         d.sections[0].axis = -1;
       },
       "plane.axis: expected x, y or z (0, 1 or 2), got -1"},
      {"kind_of_a_support", [](D& d) { d.fixes[0].where.kind = static_cast<Where::Kind>(17); },
       "expected a kind of selection, got the number 17"},
      {"adaptive", [](D& d) { d.adaptive.emplace().tolerance = 0; },
       "simulation.adaptive.tolerance: expected"},
  };
}

struct WrongDescription : ::testing::TestWithParam<Wrong> {};

TEST_P(WrongDescription, IsRefusedByWorldWithItsPlace) {
  Description description = small_bar(3, true);
  ASSERT_NO_THROW(World{description});
  GetParam().change(description);
  EXPECT_THAT(refusal_of(description), HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(All, WrongDescription, ::testing::ValuesIn(wrong_descriptions()),
                         [](const ::testing::TestParamInfo<Wrong>& wrong) { return wrong.param.name; });

TEST(Spelling, LeadsFromAWordToItsValueAndBack) {
  for (const std::string& word : all_spellings<ProjectionChoice>())
    EXPECT_EQ(spelling(find_spelled<ProjectionChoice>(word).value()), word);
  EXPECT_EQ(find_spelled<ProjectionChoice>("clmap"), std::nullopt);
}

}  // namespace
}  // namespace resilin::testing
