// Properties that every integrator in the catalogue must have, seen on a harmonic oscillator, whose stages
// have a closed solution: min_x 1/(2 s) (x - x~)^2 + w^2/2 x^2 gives x = x~ / (1 + s w^2).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/integrator/stage_sequence.hpp"

namespace resilin {
namespace {

Motion at(double position, double velocity) {
  return {.positions = VectorX::Constant(1, position),
          .velocities = VectorX::Constant(1, velocity),
          .accelerations = {}};
}

/// Steps of the given lengths.
Motion advance(const Integrator& integrator, const Motion& start, double frequency,
               const std::vector<double>& time_steps) {
  History history{.now = start};
  history.now.accelerations = -frequency * frequency * start.positions;
  for (const double dt : time_steps) {
    StageSequence stages(integrator, std::move(history), dt);
    for (int i = 0; i < integrator.num_stages(); ++i) {
      const Stage stage = stages.begin();
      stages.end(stage, stage.motion(stage.target() / (1 + stage.scale() * frequency * frequency)));
    }
    history = stages.after(stages.finish());
  }
  return history.now;
}

Motion advance(const Integrator& integrator, const Motion& start, double frequency, double time_step,
               int num_steps) {
  return advance(integrator, start, frequency,
                 std::vector<double>(static_cast<std::size_t>(num_steps), time_step));
}

double error_at_one_second(const Integrator& integrator, int num_steps) {
  const double w = 3;
  const Motion end = advance(integrator, at(1.0, 0.5), w, 1.0 / num_steps, num_steps);
  return std::abs(end.positions[0] - (std::cos(w) + 0.5 / w * std::sin(w)));
}

/// Properties that every scheme of the catalogue must have.
struct EveryIntegrator : ::testing::TestWithParam<std::string> {
  const std::unique_ptr<Integrator> integrator = make_integrator(GetParam(), "test");
};

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryIntegrator, ::testing::ValuesIn(integrator_names()),
                         [](const auto& entry) { return entry.param; });

TEST_P(EveryIntegrator, HasItsNameAndAtLeastOneStage) {
  EXPECT_EQ(integrator->name(), GetParam());
  EXPECT_GE(integrator->num_stages(), 1);
}

TEST_P(EveryIntegrator, HasTheOrderThatItClaims) {
  const double order =
      std::log2(error_at_one_second(*integrator, 512) / error_at_one_second(*integrator, 1024));
  EXPECT_NEAR(order, integrator->order(), 0.1);
}

/// A stage's velocity is a difference of places over its duration, which may be a small part of the step.
double shortest_stage(const Integrator& integrator) {
  const StepCoefficients step = integrator.coefficients(1);
  return std::ranges::min(step.stages, {}, &StageCoefficients::duration).duration;
}

TEST_P(EveryIntegrator, KeepsAFreeNodeAtItsSpeed) {
  const double time_step = 0.125, place = 2.25;
  const int num_steps = 8;
  const Motion end = advance(*integrator, at(2.0, 0.25), 0, time_step, num_steps);
  // Each stage rounds a few sums of places of this size; steps add what they leave.
  const double rounding =
      4 * num_steps * integrator->num_stages() * std::numeric_limits<double>::epsilon() * place;
  EXPECT_NEAR(end.positions[0], place, rounding);
  EXPECT_NEAR(end.velocities[0], 0.25, rounding / (shortest_stage(*integrator) * time_step));
}

TEST_P(EveryIntegrator, StaysWhereNothingMoves) {
  const Motion end = advance(*integrator, at(0, 0), 3, 0.1, 8);
  EXPECT_EQ(end.positions[0], 0);
  EXPECT_EQ(end.velocities[0], 0);
}

double energy(const Motion& m, double frequency) {
  return 0.5 * frequency * frequency * m.positions.squaredNorm() + 0.5 * m.velocities.squaredNorm();
}

TEST_P(EveryIntegrator, KeepsItsOrderWhenStepsChange) {
  const auto error = [&](int num_pairs) {
    std::vector<double> steps;
    for (int i = 0; i < num_pairs; ++i) steps.insert(steps.end(), {0.4 / num_pairs, 0.6 / num_pairs});
    const double w = 3;
    return std::abs(advance(*integrator, at(1, 0), w, steps).positions[0] - std::cos(w));
  };
  EXPECT_NEAR(std::log2(error(256) / error(512)), integrator->order(), 0.1);
}

TEST_P(EveryIntegrator, KnowsItsLocalError) {
  // To leading order in the step: a tenth more or less at this length.
  const double w = 3;
  const double dt = 2e-3;
  History start{.now = at(std::cos(w), -w * std::sin(w))};
  start.now.accelerations = -w * w * start.now.positions;
  std::vector<Motion> solutions;
  for (int i = 0; i < integrator->num_stages(); ++i) {
    const Stage stage = integrator->begin_stage(i, start, solutions, dt);
    solutions.push_back(stage.motion(stage.target() / (1 + stage.scale() * w * w)));
  }
  const Motion end = integrator->finish(start, std::move(solutions), dt);
  const double exact = std::cos(w * (1 + dt));
  const double error = end.positions[0] - exact;
  EXPECT_NEAR(integrator->local_error(start, end, dt)[0], error, 0.1 * std::abs(error));
}

/// Contact with a force that rises in time from nothing is taken as that of the end: dt^2/3 of its change.
TEST_P(EveryIntegrator, KnowsTheErrorByContact) {
  const double dt = 2e-3, by_contact = 7;
  History start{.now = at(0.5, 0.25)};
  start.now.accelerations = VectorX::Zero(1);
  start.previous_positions = start.now.positions - dt * start.now.velocities;
  start.previous_velocities = start.now.velocities;
  start.previous_time_step = dt;
  Motion end = start.now;
  end.positions += dt * start.now.velocities;
  end.positions[0] += 0.5 * dt * dt * by_contact;
  const double error = integrator->local_error(start, end, dt)[0] - dt * dt * by_contact / 6;
  EXPECT_NEAR(error, dt * dt / 3 * by_contact, 1e-9 * dt * dt * by_contact);
}

/// A vibration far below the step keeps all or nothing: nothing grows.
TEST_P(EveryIntegrator, FeedsNoVibrationThatItDoesNotResolve) {
  const double w = 1e4;
  double last = energy(at(1, 0), w);
  for (int steps = 10; steps <= 60; steps += 10) {
    const double left = energy(advance(*integrator, at(1, 0), w, 0.1, steps), w);
    EXPECT_LE(left, last * (1 + 1e-8)) << steps << " steps";
    last = left;
  }
}

/// A mass point of 1 kg over a floor at z = 0 that pushes it up by k z inside: how a stage takes a force of
/// contact, without finite elements.
struct PointOverFloor {
  double k;                               ///< [N/m]
  double g;                               ///< downwards [m/s^2]
  double mean_force = 0, last_force = 0;  ///< force of the floor, over the last step and at its end [N]

  double energy(const Motion& m) const {
    const double z = m.positions[0], depth = std::min(z, 0.0);
    return 0.5 * m.velocities.squaredNorm() + g * z + 0.5 * k * depth * depth;
  }
  /// The minimiser over x of 1/(2 s) (x - x~)^2 + g x + w k/2 min(z, 0)^2, z = e x - (e - 1) x_0.
  double solve(const Stage& stage) const {
    const double s = stage.scale(), e = stage.end_slope(), shift = (e - 1) * stage.base_positions[0];
    const double free = stage.target()[0] - s * g;
    if (e * free >= shift) return free;
    const double stiffness = stage.contact_weight * e * k;
    return (free / s + stiffness * shift) / (1 / s + stiffness * e);
  }
  /// Force of the floor at the end of the stage [N].
  double force(const Stage& stage, double x) const {
    const double e = stage.end_slope();
    return -k * std::min(e * x - (e - 1) * stage.base_positions[0], 0.0);
  }
  /// One step; what the force of contact does to the velocity is kept out of the history.
  void advance(const Integrator& integrator, History& history, double dt) {
    mean_force = 0;
    StageSequence stages(integrator, history, dt);
    for (int i = 0; i < integrator.num_stages(); ++i) {
      const Stage stage = stages.begin();
      Motion found = stage.motion(VectorX::Constant(1, solve(stage)));
      last_force = force(stage, found.positions[0]);
      const VectorX impulses = VectorX::Constant(1, last_force * stage.count_of_impulse());
      mean_force += stage.jump_by(impulses)[0] / dt;
      found.accelerations = impulses.array() - g;  // without the rounding of a hard floor
      stages.end(stage, std::move(found), impulses);
    }
    history = stages.after(stages.finish());
  }
};

/// Contact at the end of a stage only takes energy, however long the step and however hard the floor: in
/// every step where nothing else acts. With weight the sum changes within a bounce, but is never more than at
/// first.
TEST_P(EveryIntegrator, GainsNoEnergyOnAFloor) {
  for (const double k : {1.0, 1e3, 1e9}) {
    for (const double speed : {0.0, 1.0, 100.0}) {
      for (const double dt : {1e-4, 1e-2, 0.3, 3.0}) {
        PointOverFloor point{.k = k, .g = speed == 1 ? 0.0 : 9.81};
        History history{.now = at(1.5 * dt * (speed + 1), -speed)};
        history.now.accelerations = VectorX::Constant(1, -point.g);
        double energy = point.energy(history.now);
        const double tolerance = 1e-12 * energy;
        double lowest = 1;
        for (int step = 0; step < 100; ++step) {
          point.advance(*integrator, history, dt);
          const double now = point.energy(history.now);
          ASSERT_LE(now, energy + tolerance) << "k " << k << ", dt " << dt << ", step " << step;
          if (point.g == 0) energy = now;
          lowest = std::min(lowest, history.now.positions[0]);
        }
        // With speed 1 a step ends where the floor begins, up to rounding.
        EXPECT_LE(speed == 0 ? 0 : lowest, 1e-14 * dt) << "it has not touched the floor";
      }
    }
  }
}

/// Where the floor bears it, a point has no velocity, and the floor's force is its weight in every stage:
/// impulses move what rests as far up as weight moves it down.
TEST_P(EveryIntegrator, RestsOnAFloor) {
  for (const double k : {1e3, 1e9}) {
    for (const double dt : {1e-4, 1e-2, 0.3}) {
      PointOverFloor point{.k = k, .g = 9.81};
      const double place = -point.g / k;
      History history{.now = at(place, 0)};
      history.now.accelerations = VectorX::Constant(1, -point.g);
      for (int step = 0; step < 20; ++step) {
        point.advance(*integrator, history, dt);
        ASSERT_NEAR(history.now.velocities[0], 0, 1e-9 * point.g * dt) << "step " << step;
        ASSERT_NEAR(history.now.positions[0], place, 1e-9 * (point.g * dt * dt - place));
        ASSERT_NEAR(point.mean_force, point.g, 1e-6 * point.g);
        ASSERT_NEAR(point.last_force, point.g, 1e-6 * point.g);
      }
    }
  }
}

/// Stages are sums over known motions whose values sum to one: what rests far from the origin stays there to
/// the last digit, and does not begin to move by rounding.
TEST_P(EveryIntegrator, LeavesABodyAtRestWhereItIsToTheLastDigit) {
  for (const double place : {1.7, 1 / 3.0, -1e6 / 7, 1e-9 / 11}) {
    for (const double ratio : {1.0, 0.3, 1.9}) {
      const Motion rest{VectorX::Constant(1, place), VectorX::Zero(1), VectorX::Zero(1)};
      const double dt = 0.01;
      const History history{.now = rest,
                            .previous_positions = rest.positions,
                            .previous_velocities = rest.velocities,
                            .previous_time_step = dt / ratio};
      for (const StageCoefficients& stage : integrator->coefficients(ratio).stages) {
        double sum = stage.start.value + stage.previous;
        for (const MotionWeight& weight : stage.stages) sum += weight.value;
        EXPECT_NEAR(sum, 1, 1e-15);
      }
      std::vector<Motion> solutions;
      for (int i = 0; i < integrator->num_stages(); ++i) {
        const Stage stage = integrator->begin_stage(i, history, solutions, dt);
        EXPECT_EQ(stage.target()[0], place) << "stage " << i;
        solutions.push_back(stage.motion(rest.positions));
      }
      const Motion end = integrator->finish(history, std::move(solutions), dt);
      EXPECT_EQ(end.positions[0], place);
      EXPECT_EQ(end.velocities[0], 0);
    }
  }
}

TEST(Integrators, HaveTheOrdersOfTheirSources) {
  const std::map<std::string, int> orders = {
      {"backward_euler", 1}, {"bdf2", 2}, {"tr_bdf2", 2}, {"newmark", 2}, {"midpoint", 2}};
  for (const auto& [name, order] : orders) EXPECT_EQ(make_integrator(name, "test")->order(), order) << name;
}

TEST(DissipativeIntegrators, LoseEnergyHoweverLongTheStep) {
  for (const std::string name : {"backward_euler", "tr_bdf2"}) {
    for (const double dt : {1e-2, 1.0, 1e3}) {
      const Motion end = advance(*make_integrator(name, "test"), at(1, 0.5), 3, dt, 1);
      EXPECT_LT(energy(end, 3), energy(at(1, 0.5), 3)) << name << " " << dt;
    }
  }
}

TEST(StiffVibrations, AreDampedAwayByTheOnesThatSaySo) {
  const std::map<std::string, double> left = {
      {"backward_euler", 0}, {"bdf2", 0}, {"tr_bdf2", 0}, {"newmark", 1}, {"midpoint", 1}};
  for (const auto& [name, share] : left) {
    const double w = 1e4;
    const Motion end = advance(*make_integrator(name, "test"), at(1, 0), w, 0.1, 60);
    EXPECT_NEAR(energy(end, w) / energy(at(1, 0), w), share, 1e-8) << name;
  }
}

TEST(Integrator, UnknownNameListsTheKnownOnes) {
  try {
    make_integrator("rk4", "scene.toml: simulation.integrator");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), "scene.toml: simulation.integrator: expected one of " +
                                             join(integrator_names()) + ", got \"rk4\"");
  }
}

}  // namespace
}  // namespace resilin
