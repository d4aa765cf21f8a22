#include "resilin/sweep/parameter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sweep_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<SweepParameter> read(const std::string& text) {
  const SceneValue values = parse_toml(text, "sweep.toml");
  SceneContext context;
  std::vector<SweepParameter> parameters;
  read_parameters({&values, "parameters", &context}, parameters);
  return parameters;
}

std::vector<double> numbers(const SweepParameter& parameter) {
  std::vector<double> numbers;
  for (std::uint64_t i = 0; i < parameter.size(); ++i) {
    const SceneValue value = parameter.value(i);
    const auto* whole = std::get_if<std::int64_t>(&value.data);
    numbers.push_back(whole != nullptr ? static_cast<double>(*whole) : std::get<double>(value.data));
  }
  return numbers;
}

TEST(Parameters, StandInTheOrderOfTheFile) {
  const std::vector<SweepParameter> parameters = read(
      "simulation.gravity = [[0, 0, 1]]\nbody.b.scale = [1, 2]\n\"body.0.mass\" = [\"lumped\"]\nbody.a.scale "
      "= [3]\n");
  std::vector<std::string> keys;
  for (const SweepParameter& parameter : parameters) keys.push_back(parameter.keys.front());
  EXPECT_THAT(keys, ElementsAre("simulation.gravity", "body.b.scale", "body.0.mass", "body.a.scale"));
}

TEST(Parameters, KeepPartsWithDotsTogether) {
  EXPECT_EQ(read("body.\"a.b\".scale = [1]").front().keys.front(), "body.\"a.b\".scale");
}

TEST(Parameters, AreSpacedEvenlyOrInTheLogarithm) {
  EXPECT_THAT(numbers(read("x = { linspace = [1, 2, 5] }").front()), ElementsAre(1, 1.25, 1.5, 1.75, 2));
  EXPECT_THAT(numbers(read("x = { linspace = [3, 4, 1] }").front()), ElementsAre(3));
  const std::vector<double> decades = numbers(read("x = { logspace = [1e3, 1e6, 4] }").front());
  ASSERT_EQ(decades.size(), 4u);
  EXPECT_EQ(decades.front(), 1e3);
  EXPECT_EQ(decades.back(), 1e6);
  EXPECT_NEAR(decades[1], 1e4, 1e-10 * 1e4);
}

TEST(Parameters, RangesHoldTheirLastValueWhereStepsReachIt) {
  EXPECT_THAT(numbers(read("x = { range = [1, 4] }").front()), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(numbers(read("x = { range = [5, 0, -2] }").front()), ElementsAre(5, 3, 1));
  EXPECT_EQ(read("x = { range = [0.0, 1.0, 0.1] }").front().size(), 11u);
  const SweepParameter whole = read("x = { range = [2, 8, 3] }").front();
  EXPECT_TRUE(std::holds_alternative<std::int64_t>(whole.value(1).data));
  EXPECT_TRUE(std::holds_alternative<double>(read("x = { range = [2, 8.0, 3] }").front().value(1).data));
}

TEST(Parameters, DrawFromIntervalsAndLists) {
  const SweepParameter even = read("x = { uniform = [2, 4] }").front();
  EXPECT_EQ(std::get<double>(even.at(0).data), 2);
  EXPECT_EQ(std::get<double>(even.at(0.75).data), 3.5);
  const SweepParameter decades = read("x = { log_uniform = [1, 100] }").front();
  EXPECT_NEAR(std::get<double>(decades.at(0.5).data), 10, 1e-13 * 10);
  const SweepParameter laws = read("x = [\"a\", \"b\", \"c\"]").front();
  EXPECT_EQ(std::get<std::string>(laws.at(0.34).data), "b");
  EXPECT_EQ(std::get<std::string>(laws.at(std::nextafter(1, 0)).data), "c");
}

TEST(Parameters, AreRefusedInOneLine) {
  const auto error = [](const std::string& text) { return error_of([&] { read(text); }); };
  EXPECT_THAT(error("x = []"), HasSubstr("a list of at least one value"));
  EXPECT_THAT(error("x = 3"), HasSubstr("a single value belongs into the base scene"));
  EXPECT_THAT(error("x = { linspaces = [1, 2, 3] }"), HasSubstr("one of values, linspace"));
  EXPECT_THAT(error("x = { linspace = [1, 2] }"), HasSubstr("how many"));
  EXPECT_THAT(error("x = { linspace = [1, 2, 0] }"), HasSubstr(">= 1"));
  EXPECT_THAT(error("x = { logspace = [0, 2, 3] }"), HasSubstr("values and not exponents"));
  EXPECT_THAT(error("x = { uniform = [2, 2] }"), HasSubstr("ends that rise"));
  EXPECT_THAT(error("x = { range = [1, 2, 0] }"), HasSubstr("a step that leads"));
  EXPECT_THAT(error("x = { range = [1, 2, -1] }"), HasSubstr("a step that leads"));
  EXPECT_THAT(error("x = { range = [1, 2, nan] }"), HasSubstr("a number"));
  EXPECT_THAT(error(""), HasSubstr("keys of the scene"));
}

}  // namespace
}  // namespace resilin::testing
