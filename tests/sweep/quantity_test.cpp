#include "resilin/sweep/quantity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "resilin/scene/scene.hpp"
#include "sweep_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::ElementsAre;

Quantity quantity(const std::string& name, const std::string& of, OverSteps over = OverSteps::last) {
  return {.name = name, .of = of, .over = over, .place = of};
}

Description sheet() { return read_scene_from_text(pulled_sheet, "sheet.toml", "").description; }

/// The sheet in motion: three steps under its own weight.
std::vector<std::vector<double>> values_of(const std::vector<Quantity>& quantities,
                                           std::vector<Frame>& frames) {
  Description description = sheet();
  description.is_dynamic = true;
  description.gravity = {0, -10, 0};
  description.time_step = 0.01;
  description.end_time = 0.03;
  Simulation simulation(std::move(description));
  QuantityRecorder recorder(quantities, simulation.world());
  recorder.record(simulation);
  frames = {simulation.frame()};
  while (!simulation.is_finished()) {
    simulation.step();
    recorder.record(simulation);
    frames.push_back(simulation.frame());
  }
  recorder.finish(simulation);
  return recorder.values();
}

TEST(Quantities, AreThoseOfTheFrames) {
  std::vector<Frame> frames;
  const auto values =
      values_of({quantity("a", "reaction.held.y"), quantity("b", "energy.elastic", OverSteps::max),
                 quantity("c", "probe.corner.velocity", OverSteps::mean),
                 quantity("d", "time", OverSteps::all), quantity("e", "energy.kinetic", OverSteps::first),
                 quantity("f", "reaction.pulled.x", OverSteps::max_abs),
                 quantity("g", "min_volume_ratio", OverSteps::min)},
                frames);
  ASSERT_EQ(frames.size(), 4u);
  double most = 0, mean = 0, pull = 0, ratio = 2;
  for (const Frame& frame : frames) {
    most = std::max(most, frame.elastic_energy);
    mean += frame.probes[0].velocity.norm() / 4;
    pull = std::max(pull, std::abs(frame.reactions[1].second[0]));
    ratio = std::min(ratio, frame.min_volume_ratio);
  }
  EXPECT_THAT(values[0], ElementsAre(frames.back().reactions[0].second[1]));
  EXPECT_THAT(values[1], ElementsAre(most));
  EXPECT_NEAR(values[2][0], mean, 1e-14 * std::abs(mean));
  EXPECT_THAT(values[3], ElementsAre(frames[0].time, frames[1].time, frames[2].time, frames[3].time));
  EXPECT_THAT(values[4], ElementsAre(frames[0].kinetic_energy));
  EXPECT_THAT(values[5], ElementsAre(pull));
  EXPECT_THAT(values[6], ElementsAre(ratio));
}

TEST(Quantities, AreExtremesOfFieldsToo) {
  Simulation simulation(sheet());
  const std::vector<Quantity> quantities = {quantity("a", "max.displacement"),
                                            quantity("b", "min.volume_ratio")};
  QuantityRecorder recorder(quantities, simulation.world());
  while (!simulation.is_finished()) simulation.step();
  recorder.finish(simulation);
  EXPECT_NEAR(recorder.values()[0][0], 0.1, 1e-12);
  EXPECT_NEAR(recorder.values()[1][0], simulation.frame().min_volume_ratio, 1e-12);
}

TEST(Quantities, OfNothingAreNoNumbers) {
  Simulation simulation(sheet());
  const std::vector<Quantity> quantities = {quantity("a", "probe.other.displacement.x"),
                                            quantity("b", "frequency", OverSteps::max)};
  QuantityRecorder recorder(quantities, simulation.world());
  recorder.record(simulation);
  recorder.finish(simulation);
  EXPECT_TRUE(std::isnan(recorder.values()[0][0]));
  EXPECT_TRUE(std::isnan(recorder.values()[1][0]));
}

/// In statics the work of supports is the strain energy that there is: Psi is the integral of the reaction.
TEST(Quantities, WorkIsTheIntegralOfTheReaction) {
  Description description = sheet();
  description.load_steps = 100;
  Simulation simulation(std::move(description));
  const std::vector<Quantity> quantities = {quantity("a", "work")};
  QuantityRecorder recorder(quantities, simulation.world());
  double work = 0, force = 0, at = 0;
  while (!simulation.is_finished()) {
    simulation.step();
    const double now = simulation.frame().reactions[1].second[0], place = 0.1 * simulation.frame().load;
    work += 0.5 * (force + now) * (place - at);
    force = now;
    at = place;
  }
  recorder.finish(simulation);
  EXPECT_NEAR(recorder.values()[0][0], work, 1e-4 * work);  // trapezoids of 1/100
}

TEST(Quantities, OfASceneAreAllKnown) {
  const Description description = sheet();
  EXPECT_NO_THROW(check_quantities(usual_quantities(description), description));
  std::vector<Quantity> all;
  for (const std::string& name : quantity_names(description)) all.push_back(quantity(name, name));
  Simulation simulation(description);
  QuantityRecorder recorder(all, simulation.world());
  while (!simulation.is_finished()) simulation.step();
  recorder.finish(simulation);
  for (std::size_t i = 0; i < all.size(); ++i) {
    // Frequencies are of free vibrations, gaps and tractions of bodies in contact.
    const bool may_be_none = all[i].of == "frequency" || all[i].of.find("contact") != std::string::npos ||
                             all[i].of.find("direction") != std::string::npos;
    EXPECT_TRUE(may_be_none || std::isfinite(recorder.values()[i][0])) << all[i].of;
  }
}

}  // namespace
}  // namespace resilin::testing
