// The energy of Mullins softening and its derivative.

#include "resilin/energy/softening.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace resilin {
namespace {

TEST(Softening, EnergyIsTheIntegralOfTheFactor) {
  const Softening softening{.r = 1.7, .m = 0.3, .beta = 0.4};
  for (const double most : {1e-6, 0.5, 3.0, 40.0})
    for (const double share : {0.001, 0.02, 0.3, 0.8, 0.999, 1.4}) {
      const double W = share * most;
      double sum = 0;  // Simpson's rule of 2,000 intervals, in two halves about W_max
      const double break_at = std::min(W, most);
      for (int i = 0; i <= 2000; ++i)
        sum += (i == 0 || i == 2000 ? 1 : i % 2 == 1 ? 4 : 2) * softening.factor(break_at * i / 2000, most);
      const double integral = sum * break_at / 6000 + (W - break_at);
      EXPECT_NEAR(softening.energy(W, most), integral, 1e-12 * W) << W << " of " << most;
    }
}

TEST(Softening, SlopeIsThatOfTheFactor) {
  const Softening softening{.r = 2, .m = 0.1, .beta = 0.1};
  for (const double W : {0.2, 0.9, 1.4}) {
    const double h = 1e-6;
    EXPECT_NEAR(softening.factor_slope(W, 1),
                (softening.factor(W + h, 1) - softening.factor(W - h, 1)) / (2 * h), 1e-7);
  }
}

TEST(Softening, LeavesTheFirstLoadingAlone) {
  const Softening softening{.r = 2, .m = 0, .beta = 0.1};
  EXPECT_EQ(softening.factor(0, 0), 1);
  EXPECT_EQ(softening.energy(0.3, 0), 0.3);
  EXPECT_EQ(softening.factor(0.3, 0.3), 1);
  EXPECT_EQ(softening.factor_slope(0.3, 0.3), 0);
}

}  // namespace
}  // namespace resilin
