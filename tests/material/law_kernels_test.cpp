// The laws compiled for lanes against the same laws in plain doubles.
#include "resilin/material/law_kernels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "resilin/core/simd.hpp"
#include "sample_states.hpp"

namespace resilin {
namespace {

constexpr std::size_t lanes = block_size;

/// Eight random points of strain about `size`, one of them at rest and the last outside the domain of
/// logarithms.
std::array<double, 3 * lanes> sample_variables(double size, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::array<double, 3 * lanes> variables{};
  for (std::size_t lane = 1; lane < lanes; ++lane) {
    variables[2 * lanes + lane] = size * uniform(random);
    variables[lane] = size * size * (1.5 + uniform(random));
    variables[lanes + lane] = size * size * (1.5 + uniform(random));
  }
  variables[2 * lanes + lanes - 1] = -1.25;
  return variables;
}

void expect_equal(double lane_value, double plain, double scale, const std::string& where) {
  if (std::isfinite(plain))
    EXPECT_NEAR(lane_value, plain, 1e-14 * (scale + std::abs(plain)))
        << where;  // a few round-offs of the terms
  else
    EXPECT_TRUE(std::isnan(plain) ? std::isnan(lane_value) : lane_value == plain) << where;
}

TEST(LawKernels, GiveWhatPlainDoublesGiveOnEveryInstructionSet) {
  std::mt19937 random(5);
  for (const InstructionSet set : available_instruction_sets())
    for (const LawInfo* law : laws())
      for (const double size : {0.9, 0.3, 1e-3, 1e-8}) {
        const std::string where = std::string(law->name) + " " + std::string(name(set));
        const Material material = testing::sample_material(*law);
        std::vector<double> constants;
        for (const double constant : material.constants) constants.insert(constants.end(), lanes, constant);
        const auto variables = sample_variables(size, random);
        std::array<double, lanes> energy;
        std::array<double, gradient_rows * lanes> gradient;
        std::array<double, curvature_rows * lanes> curvature;
        const LawKernels& kernels = law_kernels(law->index, set);
        kernels.energy({1, variables.data(), constants.data(), 0, energy.data()});
        kernels.gradient({1, variables.data(), constants.data(), 0, gradient.data()});
        kernels.curvature({1, variables.data(), constants.data(), 0, curvature.data()});
        for (std::size_t lane = 0; lane < lanes; ++lane) {
          const LawValues plain =
              law->evaluate(material.constants.data(),
                            {variables[lane], variables[lanes + lane], variables[2 * lanes + lane]});
          const double mu = testing::sample_hooke().mu, strong = lane + 1 == lanes ? 100 : 10;
          expect_equal(energy[lane], plain.energy, strong * mu * size * size, where);
          for (std::size_t i = 0; i < 3; ++i) {
            expect_equal(gradient[i * lanes + lane], plain.slope[i], strong * mu, where);
            expect_equal(curvature[i * lanes + lane], plain.slope[i], strong * mu, where);
          }
          for (std::size_t k = 0; k < 6; ++k)
            expect_equal(curvature[(3 + k) * lanes + lane], plain.curvature[k],
                         strong * mu + 10 * std::abs(plain.curvature[k]), where);
        }
      }
}

}  // namespace
}  // namespace resilin
