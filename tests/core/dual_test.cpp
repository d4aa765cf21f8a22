#include "resilin/core/dual.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace resilin::testing {
namespace {

/// A real type like the lanes, but with so many digits that differences of it show second derivatives well.
struct Long {
  long double x = 0;
  Long() = default;
  Long(double number) : x(number) {}  // as Lanes has it
  static Long of(long double number) {
    Long result;
    result.x = number;
    return result;
  }
  friend Long operator+(Long a, Long b) { return of(a.x + b.x); }
  friend Long operator-(Long a, Long b) { return of(a.x - b.x); }
  friend Long operator*(Long a, Long b) { return of(a.x * b.x); }
  friend Long operator/(Long a, Long b) { return of(a.x / b.x); }
  friend Long operator-(Long a) { return of(-a.x); }
};
Long log1p(Long a) { return Long::of(std::log1p(a.x)); }
Long log1p_minus(Long a) { return Long::of(std::log1p(a.x) - a.x); }
Long exp(Long a) { return Long::of(std::exp(a.x)); }
Long expm1(Long a) { return Long::of(std::expm1(a.x)); }
Long expm1_minus(Long a) { return Long::of(std::expm1(a.x) - a.x); }
Long cbrt1p(Long a) { return Long::of(std::cbrt(1 + a.x) - 1); }
Long positive_part(Long a) { return Long::of(std::max(a.x, 0.0L)); }
Long step(Long a) { return Long::of(a.x > 0 ? 1 : 0); }
Long square_of_positive_part(Long a) { return square(positive_part(a)); }

using First = Dual<Long>;
using Second = Dual2<Long>;
using Place = std::array<long double, 3>;
constexpr Place place = {0.3L, -0.2L, 0.45L};

/// A function of three variables, as a law is one.
struct Function {
  std::string name;
  std::function<Long(Long, Long, Long)> real;
  std::function<First(First, First, First)> first;
  std::function<Second(Second, Second, Second)> second;
};

template <class F>
Function function(std::string name, F f) {
  return {std::move(name), f, f, f};
}

/// Each operation of dual.hpp, on arguments with slopes and curvatures of their own.
std::vector<Function> functions() {
  const auto curved = [](auto x, auto y, auto z) { return x * y + 0.5 * (z * z) - 0.25 * (x * z); };
  return {
      function("sum", [](auto x, auto y, auto z) { return x * x + y * z; }),
      function("difference", [](auto x, auto y, auto z) { return x * y - z * z; }),
      function("negative", [](auto x, auto y, auto z) { return -(x * y * z); }),
      function("product", [=](auto x, auto y, auto z) { return curved(x, y, z) * (x * x + y); }),
      function("plain_numbers",
               [](auto x, auto y, auto z) { return 2.0 + 3.0 * (x * y) - (1.5 - z) * (z - 0.5); }),
      function("square", [=](auto x, auto y, auto z) { return square(curved(x, y, z)); }),
      function("reciprocal", [=](auto x, auto y, auto z) { return reciprocal(1.0 + curved(x, y, z)); }),
      function("quotient", [=](auto x, auto y, auto z) { return (x * y) / (2.0 + curved(z, x, y)); }),
      function("number_over", [=](auto x, auto y, auto z) { return 3.0 / (1.0 + curved(x, y, z)); }),
      function("log1p", [=](auto x, auto y, auto z) { return log1p(curved(x, y, z)); }),
      function("log1p_minus", [=](auto x, auto y, auto z) { return log1p_minus(curved(x, y, z)); }),
      function("exp", [=](auto x, auto y, auto z) { return exp(curved(x, y, z)); }),
      function("expm1", [=](auto x, auto y, auto z) { return expm1(curved(x, y, z)); }),
      function("expm1_minus", [=](auto x, auto y, auto z) { return expm1_minus(curved(x, y, z)); }),
      function("cbrt1p", [=](auto x, auto y, auto z) { return cbrt1p(curved(x, y, z)); }),
      function("positive_part", [=](auto x, auto y, auto z) { return positive_part(curved(x, y, z)) * x; }),
      function("no_positive_part",
               [=](auto x, auto y, auto z) { return positive_part(-curved(z, z, y)) * x; }),
      function("square_of_positive_part",
               [=](auto x, auto y, auto z) { return square_of_positive_part(1.0 + curved(x, y, z)); }),
      function("step", [=](auto x, auto y, auto z) { return step(curved(z, z, y)) * (x * y); }),
  };
}

long double value_at(const Function& f, Place p) {
  return f.real(Long::of(p[0]), Long::of(p[1]), Long::of(p[2])).x;
}

/// Central differences to the fourth order.
template <class F>
long double slope(const F& f, long double step = 1e-3L) {
  return (8 * (f(step) - f(-step)) - (f(2 * step) - f(-2 * step))) / (12 * step);
}

long double derivative(const Function& f, int i, Place p = place) {
  return slope([&](long double t) {
    Place moved = p;
    moved[static_cast<std::size_t>(i)] += t;
    return value_at(f, moved);
  });
}

long double second_derivative(const Function& f, int i, int j) {
  return slope([&](long double t) {
    Place moved = place;
    moved[static_cast<std::size_t>(j)] += t;
    return derivative(f, i, moved);
  });
}

template <class T>
T variable(int i) {
  return T::variable(Long::of(place[static_cast<std::size_t>(i)]), i);
}

/// Differences of long double have about 12 right digits here.
constexpr double tolerance = 1e-10;

struct EveryFunction : ::testing::TestWithParam<Function> {
  const Function& f = GetParam();
  const Second second = f.second(variable<Second>(0), variable<Second>(1), variable<Second>(2));
};

TEST_P(EveryFunction, HasItsValueSlopesAndCurvatures) {
  EXPECT_EQ(second.value.x, value_at(f, place));
  for (int i = 0, k = 0; i < 3; ++i) {
    EXPECT_NEAR(static_cast<double>(second.slope[i].x), static_cast<double>(derivative(f, i)), tolerance)
        << i;
    for (int j = i; j < 3; ++j, ++k)
      EXPECT_NEAR(static_cast<double>(second.curvature[k].x), static_cast<double>(second_derivative(f, i, j)),
                  tolerance)
          << i << " " << j;
  }
}

TEST_P(EveryFunction, HasTheSameValueAndSlopesWithoutCurvatures) {
  const First first = f.first(variable<First>(0), variable<First>(1), variable<First>(2));
  EXPECT_EQ(first.value.x, second.value.x);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(first.slope[i].x, second.slope[i].x) << i;
}

INSTANTIATE_TEST_SUITE_P(Dual, EveryFunction, ::testing::ValuesIn(functions()),
                         [](const auto& entry) { return entry.param.name; });

/// An operator along d: what it gives for a function is the slope along d.
TEST(Dual2, CarriesOtherDifferentialOperators) {
  using Number = Dual2<Long, 3, 1>;
  Number x[3];
  const double d[3] = {0.5, -2, 0.25};
  for (int i = 0; i < 3; ++i) {
    x[i] = Number::variable(Long::of(place[static_cast<std::size_t>(i)]), i);
    x[i].other[0] = d[i];
  }
  const Number f = exp(x[0] * x[1]) / (1.0 + cbrt1p(square(x[2]) + log1p(x[0])));
  long double along = 0;
  for (int i = 0; i < 3; ++i) along += d[i] * f.slope[i].x;
  EXPECT_NEAR(static_cast<double>(f.other[0].x), static_cast<double>(along), 1e-17);
}

/// A law's constants are numbers with derivatives under those of its variables.
TEST(Dual2, OfDualsHasDerivativesOfItsSlopesAndCurvatures) {
  using Constant = Dual<Long, 1>;
  using Number = Dual2<Constant, 3>;
  const auto f = [](auto mu, auto x, auto y) { return mu * log1p(x * y) + exp((0.5 * (mu * mu)) * y) * x; };
  const auto at = [&](long double mu) {
    return f(Long::of(mu), Second::variable(Long::of(place[0]), 0), Second::variable(Long::of(place[1]), 1));
  };
  const long double start = 0.7L;
  const Constant mu = Constant::variable(Long::of(start), 0);
  const auto variable_of = [](int i) {
    Constant value(0.0);
    value.value = Long::of(place[static_cast<std::size_t>(i)]);
    return Number::variable(value, i);
  };
  const Number both = f(mu, variable_of(0), variable_of(1));
  const auto expect_slope = [&](const Constant& got, const auto& part) {
    EXPECT_NEAR(static_cast<double>(got.value.x), static_cast<double>(part(at(start)).x), 1e-18);
    const long double expected = slope([&](long double t) { return part(at(start + t)).x; });
    EXPECT_NEAR(static_cast<double>(got.slope[0].x), static_cast<double>(expected), tolerance);
  };
  expect_slope(both.value, [](const Second& a) { return a.value; });
  for (int i = 0; i < 2; ++i) expect_slope(both.slope[i], [i](const Second& a) { return a.slope[i]; });
  for (int k : {0, 1, 3}) expect_slope(both.curvature[k], [k](const Second& a) { return a.curvature[k]; });
}

TEST(Dual, PositivePartHasNoSlopeAtZero) {
  for (const double x : {-1.0, 0.0, 1.0}) {
    const First a = positive_part(First::variable(x, 1));
    EXPECT_EQ(a.value.x, x > 0 ? 1 : 0);
    EXPECT_EQ(a.slope[1].x, x > 0 ? 1 : 0);
    const Second b = square_of_positive_part(Second::variable(x, 0));
    EXPECT_EQ(b.slope[0].x, x > 0 ? 2 : 0);
    EXPECT_EQ(b.curvature[0].x, x > 0 ? 2 : 0);
  }
}

}  // namespace
}  // namespace resilin::testing
