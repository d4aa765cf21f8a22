#include "resilin/material/volume_energy.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "resilin/core/cpu.hpp"

namespace resilin::testing {
namespace {

/// U = lambda/2 (ln J)^2 at more states than a block of lanes has, each with a constant of its own.
TEST(VolumeSlopes, AreThoseOfNeoHookean) {
  std::vector<double> j, lambda;
  for (int i = 0; i < 11; ++i) {
    j.push_back(0.1 * i - 0.5);
    lambda.push_back(1e5 * (1 + i));
  }
  const double mu = 1;
  const std::array<Column, 2> constants = {Column{&mu, 0}, Column{lambda.data(), 1}};
  const std::vector<VolumeSlopes> slopes =
      volume_slopes(require_law("neo_hookean", "law"), j, constants, preferred_instruction_set());
  ASSERT_EQ(slopes.size(), j.size());
  for (std::size_t i = 0; i < j.size(); ++i) {
    const double J = 1 + j[i];
    EXPECT_NEAR(slopes[i].pressure, lambda[i] * std::log(J) / J, 1e-12 * lambda[i]);
    EXPECT_NEAR(slopes[i].stiffness, lambda[i] * (1 - std::log(J)) / (J * J), 1e-12 * lambda[i] / (J * J));
  }
}

}  // namespace
}  // namespace resilin::testing
