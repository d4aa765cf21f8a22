// The functions of lanes against those of the C library in long double, whose errors are far below one ulp of
// a double. An error is counted in ulps: distances between neighbouring doubles at the result.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "every_instruction_set.hpp"

namespace resilin::testing {
namespace {

using Real = long double;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double least_normal = std::numeric_limits<double>::min();

double ulp(Real value) {
  int exponent = 0;
  std::frexp(static_cast<double>(value), &exponent);
  return std::ldexp(1.0, std::max(exponent - 53, -1074));
}

/// Numbers of both signs (or one) between two sizes, as many in each binary order of magnitude.
std::vector<double> spread(double smallest, double largest, bool has_negative, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> exponent(std::log2(smallest), std::log2(largest));
  std::vector<double> x(40000);
  for (double& number : x) {
    number = std::exp2(exponent(random));
    if (has_negative && random() % 2 == 0) number = -number;
  }
  return x;
}

std::vector<double> between(double low, double high, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(low, high);
  std::vector<double> x(40000);
  for (double& number : x) number = uniform(random);
  return x;
}

/// These too, and the last one repeated until the size is a multiple of 8.
std::vector<double> with(std::vector<double> x, const std::vector<double>& special) {
  x.insert(x.end(), special.begin(), special.end());
  while (x.size() % 8 != 0) x.push_back(x.back());
  return x;
}

std::vector<double> values(LanesProbe::Function function, const std::vector<double>& x) {
  std::vector<double> y(x.size());
  function(x.size(), x.data(), y.data());
  return y;
}

/// Largest error over all arguments [ulp]; says where it is when it is above `most`.
template <class Exact>
void expect_within(double most, LanesProbe::Function function, const std::vector<double>& x,
                   const Exact& exact) {
  const std::vector<double> y = values(function, x);
  double worst = 0, where = 0, got = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Real expected = exact(static_cast<Real>(x[i]));
    const Real error = std::abs(static_cast<Real>(y[i]) - expected) / static_cast<Real>(ulp(expected));
    if (!(error <= static_cast<Real>(worst))) worst = static_cast<double>(error), where = x[i], got = y[i];
  }
  EXPECT_LE(worst, most) << "at " << where << ": " << got;
}

Real exact_log1p_minus(Real x) {
  if (std::abs(x) > 0.25L) return std::log1p(x) - x;
  Real sum = 0;
  for (int k = 60; k >= 2; --k) sum = sum * x + (k % 2 == 0 ? -1.0L : 1.0L) / k;
  return sum * x * x;
}

Real exact_expm1_minus(Real x) {
  if (std::abs(x) > 1) return std::expm1(x) - x;
  Real sum = 0;
  for (int k = 30; k >= 2; --k) sum = (1 + sum * x) / k;  // 1/2 (1 + x/3 (1 + x/4 ...))
  return sum * x * x;
}

struct SimdMath : EveryInstructionSet {
  /// Strains from tiny to huge, down to those that squash a body flat.
  std::vector<double> above_minus_one() const {
    std::vector<double> x =
        with(spread(1e-300, 1e300, false, 1), {0.0, -0.0, 1e-16, 0.41421356, 0.4142136, -0.29289321});
    for (const double number : spread(1e-300, 0.999, false, 2)) x.push_back(-number);
    for (const double number : spread(1e-15, 0.1, false, 3)) x.push_back(number - 1);
    return with(std::move(x), between(-0.5, 2, 4));
  }
};

TEST_P(SimdMath, RootsAreThoseOfTheProcessorAndTheirReciprocalsNear) {
  const std::vector<double> x = with(spread(least_normal, 1e308, false, 5), {least_normal, 1, 2, 4, 1e-290});
  expect_within(0.5001, probe.sqrt, x, [](Real a) { return std::sqrt(a); });
  expect_within(2.5, probe.reciprocal_sqrt, x, [](Real a) { return 1 / std::sqrt(a); });
}

TEST_P(SimdMath, PowersOfTwoAreExact) {
  std::vector<double> n;
  for (int i = -1022; i <= 1023; ++i) n.push_back(i);
  expect_within(0, probe.power_of_two, with(std::move(n), {0}), [](Real a) { return std::exp2(a); });
}

TEST_P(SimdMath, LogarithmsAreAccurateFromTinyStrainsToHugeOnes) {
  expect_within(3, probe.log1p, above_minus_one(), [](Real a) { return std::log1p(a); });
}

TEST_P(SimdMath, LogarithmsLessTheirArgumentLoseNoDigits) {
  expect_within(24, probe.log1p_minus, above_minus_one(), exact_log1p_minus);
  expect_within(4, probe.log1p_minus, with(spread(1e-150, 0.29, true, 11), {0.0, -0.0}), exact_log1p_minus);
}

TEST_P(SimdMath, CubeRootsLessOneAreAccurateFromTinyStrainsToHugeOnes) {
  expect_within(6, probe.cbrt1p, above_minus_one(), [](Real a) { return std::expm1(std::log1p(a) / 3); });
}

TEST_P(SimdMath, ExponentialsAreAccurateOverTheirDomain) {
  const std::vector<double> x = with(spread(1e-300, 708, true, 6), {0.0, -0.0, 0.34657359, 0.3465736,
                                                                    -0.34657359, -0.3465736, 709.78, -708});
  const std::vector<double> near = between(-2, 2, 7);
  for (const auto& arguments : {x, near}) {
    expect_within(1, probe.exp, arguments, [](Real a) { return std::exp(a); });
    expect_within(2, probe.expm1, arguments, [](Real a) { return std::expm1(a); });
    expect_within(9, probe.expm1_minus, arguments, exact_expm1_minus);
  }
}

TEST_P(SimdMath, ExponentialsEndInInfinityAndInTheSmallestPower) {
  const std::vector<double> x = {709.79, 1e4, 1e300, infinity, -708.5, -1e4, -1e300, -infinity};
  const std::vector<double> exp = values(probe.exp, x), expm1 = values(probe.expm1, x);
  const std::vector<double> expm1_minus = values(probe.expm1_minus, x);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(exp[i], infinity);
    EXPECT_EQ(expm1[i], infinity);
    if (x[i] < infinity) {
      EXPECT_EQ(expm1_minus[i], infinity) << x[i];
    }
  }
  for (std::size_t i = 4; i < 8; ++i) {
    EXPECT_NEAR(exp[i], std::exp(-708.0), 1e-15 * std::exp(-708.0));
    EXPECT_EQ(expm1[i], -1);
    EXPECT_EQ(expm1_minus[i], -1 - x[i]);
  }
}

TEST_P(SimdMath, ANumberThatIsNoneStaysNone) {
  const std::vector<double> x(8, std::numeric_limits<double>::quiet_NaN());
  for (const auto function : {probe.exp, probe.expm1, probe.expm1_minus})
    for (const double y : values(function, x)) EXPECT_TRUE(std::isnan(y));
}

TEST_P(SimdMath, PowerDifferencesAreAccurateAndHaveTheirLimitAtZero) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> uniform(-4, 4);
  std::vector<double> x = with(spread(1e-300, 100, false, 9), {0, 0, 0, 0, 0, 0, 0, 0});
  for (const double number : spread(1e-300, 0.99, false, 10)) x.push_back(-number);
  std::vector<double> alpha(x.size()), y(x.size());
  for (double& number : alpha) number = uniform(random);
  probe.power_difference(x.size(), x.data(), alpha.data(), y.data());
  double worst = 0, where = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Real z = static_cast<Real>(alpha[i]) * std::log1p(static_cast<Real>(x[i]));
    const Real expected = x[i] == 0 ? static_cast<Real>(alpha[i]) : std::expm1(z) / static_cast<Real>(x[i]);
    // An error of z is one of e^z, |z| times as large.
    const Real allowed = static_cast<Real>(ulp(expected)) * (1 + std::abs(z));
    const Real error = std::abs(static_cast<Real>(y[i]) - expected) / allowed;
    if (!(error <= static_cast<Real>(worst))) worst = static_cast<double>(error), where = x[i];
  }
  EXPECT_LE(worst, 6) << "at " << where;
}

INSTANTIATE_TEST_SUITE_P(Lanes, SimdMath, ::testing::ValuesIn(available_instruction_sets()), name_of_set);

}  // namespace
}  // namespace resilin::testing
