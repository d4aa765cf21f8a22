// The order of what a step computes, forwards and transposed, for every scheme.

#include "resilin/integrator/stage_sequence.hpp"

#include <gtest/gtest.h>

#include <random>

namespace resilin {
namespace {

constexpr double dt = 0.25;
constexpr Eigen::Index size = 4;

class Numbers {
 public:
  VectorX vector() {
    VectorX values(size);
    for (double& value : values) value = uniform_(random_);
    return values;
  }
  Motion motion() { return {vector(), vector(), vector()}; }
  History history() {
    return {.now = motion(),
            .previous_positions = vector(),
            .previous_velocities = vector(),
            .previous_time_step = 0.5 * dt};
  }

 private:
  std::mt19937 random_{1};
  std::uniform_real_distribution<> uniform_{-1, 1};
};

double product(const Motion& a, const Motion& b) {
  return a.positions.dot(b.positions) + a.velocities.dot(b.velocities) + a.accelerations.dot(b.accelerations);
}

double product(const History& a, const History& b) {
  return product(a.now, b.now) + a.previous_positions.dot(b.previous_positions) +
         a.previous_velocities.dot(b.previous_velocities);
}

struct EverySequence : ::testing::TestWithParam<std::string> {
  std::unique_ptr<Integrator> scheme = make_integrator(GetParam(), "test");
};

/// Stages whose unknowns and impulses are given: what comes out is linear in these and in the start, and
/// slopes of it by these are those that the transposed sequence finds.
TEST_P(EverySequence, IsTransposed) {
  for (const bool has_impulses : {false, true}) {
    Numbers numbers;
    const auto count = static_cast<std::size_t>(scheme->num_stages());
    const History start = numbers.history();
    std::vector<VectorX> xs, impulses(count), wheres(count);
    std::vector<Stage> stages;
    StageSequence forward(*scheme, start, dt);
    for (std::size_t i = 0; i < count; ++i) {
      stages.push_back(forward.begin());
      xs.push_back(numbers.vector());
      if (has_impulses) {
        impulses[i] = numbers.vector();
        wheres[i] = (VectorX(size) << 1, 0, 0, 2).finished();
        impulses[i][1] = impulses[i][2] = 0;
      }
      forward.end(stages.back(), stages.back().motion(xs.back()), impulses[i], wheres[i]);
    }
    const History next = forward.after(forward.finish());
    EXPECT_EQ(next.previous_time_step, dt);

    const History by_next = numbers.history();
    double sum = 0;
    TransposedSequence back(*scheme, by_next, wheres.back(), dt, start.previous_time_step);
    for (std::size_t i = count; i-- > 0;) {
      const TransposedSequence::End by = back.end(stages[i], wheres[i]);
      sum += by.by_x.dot(xs[i]);
      EXPECT_EQ(by.by_impulses.size() > 0, has_impulses);
      if (has_impulses) sum += by.by_impulses.dot(impulses[i]);
      back.begin(by.by_stage);
    }
    sum += product(std::move(back).finish(), start);
    EXPECT_NEAR(product(by_next, next), sum, 1e-12 * std::abs(sum)) << has_impulses;
  }
}

/// Where an impulse acts, what is known moves at even speed to where it has acted; elsewhere nothing changes.
TEST_P(EverySequence, LooksBackAtEvenSpeed) {
  Numbers numbers;
  const History start = numbers.history();
  StageSequence stages(*scheme, start, dt);
  const VectorX impulses = (VectorX(size) << 0, 3, 0, -2).finished();
  VectorX jump;
  for (int i = 0; i < scheme->num_stages(); ++i) {
    const Stage stage = stages.begin();
    const Motion found = stage.motion(numbers.vector());
    stages.end(stage, found, impulses);
    EXPECT_EQ(stages.last_positions(), found.positions);
    EXPECT_EQ(stages.solutions().back().accelerations, found.accelerations - impulses);
    jump = stage.jump_by(impulses);
  }
  const History next = stages.after(stages.finish());
  for (const Eigen::Index i : {0, 2}) {
    EXPECT_EQ(next.previous_positions[i], start.now.positions[i]);
    EXPECT_EQ(next.previous_velocities[i], start.now.velocities[i]);
  }
  for (const Eigen::Index i : {1, 3}) {
    EXPECT_NEAR(next.previous_positions[i] + dt * next.now.velocities[i], next.now.positions[i], 1e-15);
    EXPECT_EQ(next.previous_velocities[i], start.now.velocities[i] + jump[i]);
  }
}

/// The slowing of a step is added to the motion before it, too.
TEST_P(EverySequence, WasAsSlowBefore) {
  Numbers numbers;
  const History start = numbers.history();
  StageSequence stages(*scheme, start, dt);
  for (int i = 0; i < scheme->num_stages(); ++i) {
    const Stage stage = stages.begin();
    stages.end(stage, stage.motion(numbers.vector()));
  }
  const VectorX slowing = numbers.vector();
  const History next = stages.after(stages.finish(), slowing);
  EXPECT_EQ(next.previous_positions, start.now.positions - dt * slowing);
  EXPECT_EQ(next.previous_velocities, start.now.velocities + slowing);
}

INSTANTIATE_TEST_SUITE_P(All, EverySequence, ::testing::ValuesIn(integrator_names()),
                         [](const ::testing::TestParamInfo<std::string>& scheme) { return scheme.param; });

}  // namespace
}  // namespace resilin
