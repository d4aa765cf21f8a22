// Functions of time and adaptive steps in scenes: what is read and what is refused.

#include <gtest/gtest.h>

#include "scene_text.hpp"
#include "test_names.hpp"

namespace resilin::testing {
namespace {

std::vector<std::string> in_motion(std::vector<std::string> overrides) {
  overrides.insert(overrides.begin(), "simulation.kind=dynamic");
  return overrides;
}

TimeFunction function_of_the_load(const std::string& value) {
  return read_good_scene_with(in_motion({"load.pull.time_function=" + value}))
      .description.loads[0]
      .time_function;
}

TEST(TimeFunctions, AreReadFromTheScene) {
  const TimeFunction table = function_of_the_load("{table=[[0,0],[1,2],[3,-2]]}");
  EXPECT_EQ(table.value(-1), 0);
  EXPECT_EQ(table.value(0.5), 1);
  EXPECT_EQ(table.value(2), 0);
  EXPECT_EQ(table.value(4), -2);
  EXPECT_EQ(table.rate(1), 2);  // from before
  const TimeFunction ramp = function_of_the_load("{ramp={from=1,until=3}}");
  EXPECT_EQ(ramp.value(1), 0);
  EXPECT_EQ(ramp.value(2), 0.5);
  EXPECT_EQ(ramp.value(9), 1);
  const TimeFunction sine = function_of_the_load("{sine={frequency=0.25,amplitude=3,phase=90,offset=1}}");
  EXPECT_DOUBLE_EQ(sine.value(0), 4);
  EXPECT_NEAR(sine.value(1), 1, 1e-14);
}

TEST(TimeFunctions, HaveTheRatesOfTheirValues) {
  for (const char* text : {"{table=[[0,0],[1,2],[3,-2]]}", "{ramp={from=0.1,until=3}}",
                           "{sine={frequency=0.3,amplitude=3,phase=20}}"}) {
    const TimeFunction f = function_of_the_load(text);
    const double h = 1e-4;
    for (const double t : {0.3, 0.8, 1.7, 2.6}) {
      EXPECT_NEAR(f.rate(t), (f.value(t + h) - f.value(t - h)) / (2 * h), 1e-5) << text;
      EXPECT_NEAR(f.second_rate(t), (f.rate(t + h) - f.rate(t - h)) / (2 * h), 1e-5) << text;
    }
  }
}

TEST(TimeFunctions, HaveIntegralsWhoseRatesAreTheirValues) {
  for (const char* text : {"{table=[[0.2,1],[1,2],[3,-2]]}", "{ramp={from=0.1,until=2}}",
                           "{sine={frequency=0.3,amplitude=3,phase=20,offset=1}}"}) {
    const TimeFunction f = function_of_the_load(text);
    EXPECT_EQ(f.integral(0), 0);
    const double h = 1e-4;
    for (const double t : {0.05, 0.3, 0.8, 1.7, 2.6, 3.5})
      EXPECT_NEAR(f.value(t), (f.integral(t + h) - f.integral(t - h)) / (2 * h), 1e-5) << text << " at " << t;
  }
  EXPECT_EQ(TimeFunction().integral(3), 3);
}

struct WrongFunction {
  std::string value;
  std::string message;
};
void PrintTo(const WrongFunction& wrong, std::ostream* stream) { *stream << wrong.value; }
class EveryWrongFunction : public ::testing::TestWithParam<WrongFunction> {};

TEST_P(EveryWrongFunction, IsRefusedInOneLine) {
  const auto& [value, expected] = GetParam();
  const std::string message = error_with(in_motion({"load.pull.time_function=" + value}));
  EXPECT_NE(message.find(expected), message.npos) << message;
  EXPECT_EQ(message.find('\n'), message.npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    Scene, EveryWrongFunction,
    ::testing::Values(WrongFunction{"{table=[[0,0],[2,1],[1,0]]}",
                                    "time_function.table: expected rising times, got 1 after 2"},
                      WrongFunction{"{table=[[0,0],[0,1]]}", "expected rising times, got 0 after 0"},
                      WrongFunction{"{table=[]}", "expected points [t, f], at least one"},
                      WrongFunction{"{table=[[0,nan]]}", "expected a number, got nan"},
                      WrongFunction{"{table=[[0,1,2]]}", "expected a list of 2 numbers"},
                      WrongFunction{"{table=3}", "expected a list of points [t, f]"},
                      WrongFunction{"{table=\"none.csv\"}", "none.csv"},
                      WrongFunction{"{sine={}}", "the key \"frequency\" is missing"},
                      WrongFunction{"{sine={frequency=0}}", "expected a number > 0"},
                      WrongFunction{"{ramp={from=1,until=1}}", "expected `until` after `from`"},
                      WrongFunction{"{ramp={to=1}}", "unknown key \"to\""},
                      WrongFunction{"{}", "expected a table with one of table, sine, ramp"},
                      WrongFunction{"{ramp={},sine={frequency=1}}",
                                    "expected a table with one of table, sine, ramp"},
                      WrongFunction{"1", "expected a table with one of table, sine, ramp"}),
    numbered_name<WrongFunction>);

TEST(TimeFunctions, AreRefusedWhereTheyWouldDoNothing) {
  const std::string ramp = "time_function={ramp={until=1}}";
  EXPECT_EQ(error_with({"load.pull." + ramp}), "");
  EXPECT_NE(error_with(in_motion({"fix.wall." + ramp})).find("is a factor on displacement"),
            std::string::npos);
  EXPECT_EQ(error_with(in_motion({"fix.wall." + ramp, "fix.wall.displacement=[0,0,1]"})), "");
}

TEST(AdaptiveSteps, AreReadAndChecked) {
  const Scene scene = read_good_scene_with(in_motion({"simulation.adaptive={tolerance=1e-3,max_step=0.1}"}));
  ASSERT_TRUE(scene.description.adaptive.has_value());
  EXPECT_EQ(scene.description.adaptive->tolerance, 1e-3);
  EXPECT_EQ(scene.description.adaptive->max_step, 0.1);
  EXPECT_FALSE(scene.description.adaptive->min_step.has_value());
  EXPECT_NE(error_with(in_motion({"simulation.adaptive={tolerance=0}"}))
                .find("adaptive.tolerance: expected a number > 0"),
            std::string::npos);
  EXPECT_NE(error_with(in_motion({"simulation.adaptive={min_step=1,max_step=0.1}"})).find("min_step"),
            std::string::npos);
  EXPECT_NE(error_with({"simulation.adaptive={}"}).find("dynamics only"), std::string::npos);
}

TEST(Modes, AreReadAndChecked) {
  const Description d =
      read_good_scene_with({"simulation.kind=modes", "simulation.modes={count=4,about=\"load\"}"})
          .description;
  ASSERT_TRUE(d.modes.has_value());
  EXPECT_EQ(d.modes->count, 4);
  EXPECT_TRUE(d.modes->is_loaded);
  EXPECT_FALSE(d.is_dynamic);
  EXPECT_EQ(read_good_scene_with({"simulation.kind=modes"}).description.modes->count, 10);
  EXPECT_NE(error_with({"simulation.modes={count=4}"}).find("simulation.kind = \"modes\" only"),
            std::string::npos);
  EXPECT_NE(error_with({"simulation.kind=modes", "simulation.modes={count=0}"}).find("a whole number >= 1"),
            std::string::npos);
}

TEST(Damping, IsReadAndChecked) {
  const Scene scene = read_good_scene_with(
      in_motion({"body.beam.damping={mass=1,stiffness=2,shear_viscosity=3,bulk_viscosity=4}"}));
  const DampingDescription& damping = scene.description.bodies[0].damping;
  EXPECT_EQ(damping.mass, 1);
  EXPECT_EQ(damping.stiffness, 2);
  EXPECT_EQ(damping.shear_viscosity, 3);
  EXPECT_EQ(damping.bulk_viscosity, 4);
  EXPECT_NE(error_with({"body.beam.damping={mass=1}"}).find("dynamics only"), std::string::npos);
  EXPECT_NE(error_with(in_motion({"body.beam.damping={mass=-1}"})).find("expected a number >= 0"),
            std::string::npos);
}

}  // namespace
}  // namespace resilin::testing
