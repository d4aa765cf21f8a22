#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "resilin/sensitivity/derivatives.hpp"

namespace resilin::testing {

inline VectorX random_numbers(Eigen::Index size, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  VectorX numbers(size);
  for (double& number : numbers) number = uniform(generator);
  return numbers;
}

/// Slopes of some result by everything that comes out of a run: random weights of places, velocities and
/// reactions of each frame.
inline std::vector<FrameChange> random_slopes(const Derivatives& run) {
  std::vector<FrameChange> slopes;
  for (int k = 0; k < run.num_frames(); ++k) {
    const auto seed = static_cast<unsigned>(10 * k);
    const Eigen::Index size = run.world().rest_positions.size();
    FrameChange of{.positions = random_numbers(size, seed + 1)};
    if (run.world().is_dynamic) of.velocities = 0.01 * random_numbers(size, seed + 2);
    const VectorX weights =
        1e-4 * random_numbers(3 * static_cast<Eigen::Index>(run.world().supports.size()), seed);
    for (Eigen::Index s = 0; k > 0 && s < weights.size(); s += 3) {
      of.reactions.emplace_back(weights.segment<3>(s));
      if (run.world().dimension == 2) of.reactions.back()[2] = 0;
    }
    slopes.push_back(std::move(of));
  }
  return slopes;
}

/// The result with these slopes, to first order.
inline double product(const std::vector<FrameChange>& slopes, const std::vector<FrameChange>& changes) {
  double sum = 0;
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    sum += slopes[k].positions.dot(changes[k].positions);
    if (slopes[k].velocities.size() > 0) sum += slopes[k].velocities.dot(changes[k].velocities);
    for (std::size_t s = 0; s < slopes[k].reactions.size(); ++s)
      sum += slopes[k].reactions[s].dot(changes[k].reactions[s]);
  }
  return sum;
}

/// Results of a run of the scene, less those of another one.
inline std::vector<FrameChange> results_beside(const Description& scene, Derivatives& base) {
  Simulation simulation(scene);
  std::vector<FrameChange> results;
  const auto take = [&] {
    FrameChange of{.positions = simulation.state().positions - base.positions(simulation.state().step)};
    if (scene.is_dynamic) of.velocities = simulation.state().velocities;
    for (std::size_t s = 0; s < simulation.world().supports.size(); ++s)
      of.reactions.push_back(simulation.frame().reactions[s].second);
    results.push_back(std::move(of));
  };
  take();
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
    if (report.status != StepReport::Status::converged) break;
    take();
  }
  return results;
}

/// The slope of the result along a change of one parameter, from four runs.
inline double difference_quotient(const Description& scene, Derivatives& base,
                                  const std::vector<FrameChange>& slopes, const Parameter& parameter,
                                  const VectorX& change, double step) {
  const auto result = [&](double t) {
    Description changed = scene;
    parameter.set(parameter.value + t * change, changed);
    return product(slopes, results_beside(changed, base));
  };
  return (8 * (result(step) - result(-step)) - (result(2 * step) - result(-2 * step))) / (12 * step);
}

/// A change of the numbers of a parameter by about its own size, or that of the scene.
inline VectorX sample_change(const Parameter& parameter, unsigned seed) {
  VectorX change = random_numbers(parameter.value.size(), seed);
  if (parameter.name.starts_with("collider.") && parameter.value.size() > 1) return 0.05 * change;
  const bool is_place = parameter.name.ends_with("positions");
  const double size = is_place ? 0.1 : parameter.value.cwiseAbs().maxCoeff();
  if (parameter.name.ends_with("poissons_ratio")) return 0.1 * change;
  return (size > 0 ? size : 1) * change;
}

/// A change of the i-th of all parameters alone.
inline std::vector<VectorX> change_of_one(const Derivatives& run, std::size_t i) {
  std::vector<VectorX> changes;
  for (const Parameter& parameter : run.parameters())
    changes.push_back(VectorX::Zero(parameter.value.size()));
  changes[i] = sample_change(run.parameters()[i], static_cast<unsigned>(i));
  return changes;
}

/// Both identities that derivatives of a scene have to satisfy, for all of its parameters: transposed and
/// forward products agree, and both with differences of runs.
/// @param step  of the difference quotients, of the parameters
inline void expect_right_derivatives(const Description& scene, const std::vector<std::string>& wrt = {},
                                     double tolerance = 1e-6, double step = 2e-4) {
  const auto made = std::make_shared<const Description>(scene);
  const std::vector<std::string> names = wrt.empty() ? parameter_names(World(made)) : wrt;
  const auto run = Derivatives::run(scene, names);
  const std::vector<FrameChange> slopes = random_slopes(*run);
  const std::vector<VectorX> gradient = run->transposed(slopes);
  for (std::size_t i = 0; i < names.size(); ++i) {
    SCOPED_TRACE(names[i]);
    const Parameter& parameter = run->parameters()[i];
    const std::vector<VectorX> changes = change_of_one(*run, i);
    const std::vector<FrameChange> frames = run->forward(changes);
    const double forward = product(slopes, frames), transposed = gradient[i].dot(changes[i]);
    double scale = 0, of_velocities = 0;
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      scale += slopes[k].positions.norm() * frames[k].positions.norm();
      if (slopes[k].velocities.size() > 0)
        of_velocities += slopes[k].velocities.norm() * frames[k].velocities.norm();
    }
    EXPECT_NEAR(forward, transposed, 1e-11 * std::max(scale + of_velocities, std::abs(forward)));
    // Runs are solved to some 1e-14, which a short step of the quotient magnifies; over a long one forces of
    // contact bend. One of them has the digits.
    double quotient = 0, allowed = 0;
    for (const double part : {1.0, 0.3, 0.1}) {
      quotient = difference_quotient(scene, *run, slopes, parameter, changes[i], part * step);
      allowed = tolerance * std::max(scale, std::abs(quotient)) + 1e-10;
      if (std::abs(transposed - quotient) <= allowed) break;
    }
    EXPECT_NEAR(transposed, quotient, allowed);
  }
}

}  // namespace resilin::testing
