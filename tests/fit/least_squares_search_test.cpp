// The search behind every fit, on problems whose answers are known.
#include "resilin/fit/least_squares_search.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "resilin/core/error.hpp"

namespace resilin {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Residuals from functions.
class GivenResiduals : public Residuals {
 public:
  using Values = std::function<VectorX(const VectorX&)>;
  using Slopes = std::function<DenseMatrix(const VectorX&)>;
  GivenResiduals(Values values, Slopes slopes) : values_(std::move(values)), slopes_(std::move(slopes)) {}
  bool evaluate(const VectorX& values, VectorX& r) override {
    there_ = values;
    r = values_(values);
    return r.size() > 0;
  }
  void accept() override { here_ = there_; }
  bool linearise(DenseMatrix& slopes) override {
    slopes = slopes_(here_);
    return true;
  }

 private:
  Values values_;
  Slopes slopes_;
  VectorX here_, there_;
};

VectorX vector(std::initializer_list<double> values) {
  return Eigen::Map<const VectorX>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

std::vector<ParameterTransform> plain(int count, double lower = -infinity, double upper = infinity) {
  std::vector<ParameterTransform> all;
  for (int i = 0; i < count; ++i) all.push_back(ParameterTransform::in_box(false, lower, upper));
  return all;
}

/// r = (10 (y - x^2), 1 - x), least at (1, 1).
GivenResiduals rosenbrock() {
  return {[](const VectorX& p) { return vector({10 * (p[1] - p[0] * p[0]), 1 - p[0]}); },
          [](const VectorX& p) {
            DenseMatrix J(2, 2);
            J << -20 * p[0], 10, -1, 0;
            return J;
          }};
}

TEST(LeastSquaresSearch, FollowsTheValleyOfRosenbrock) {
  GivenResiduals residuals = rosenbrock();
  LeastSquaresSearch search(residuals, plain(2), {});
  ASSERT_TRUE(search.run(vector({-1.2, 1})));
  EXPECT_TRUE(search.is_converged());
  EXPECT_LT((search.values() - vector({1, 1})).norm(), 1e-12);
  EXPECT_LE(search.evaluations(), 40);
}

/// With x <= 0.5 the least sum is at (0.5, 0.25): (1 - 0.5)^2.
TEST(LeastSquaresSearch, EndsAtABoundAndSaysSo) {
  GivenResiduals residuals = rosenbrock();
  std::vector<ParameterTransform> transforms = plain(2);
  transforms[0] = ParameterTransform::in_box(false, -2, 0.5);
  LeastSquaresSearch search(residuals, transforms, {});
  ASSERT_TRUE(search.run(vector({-1.2, 1})));
  EXPECT_TRUE(search.is_converged());
  EXPECT_EQ(search.values()[0], 0.5);
  EXPECT_NEAR(search.values()[1], 0.25, 1e-12);
  EXPECT_NEAR(search.sum_of_squares(), 0.25, 1e-14);
  EXPECT_TRUE(search.is_held(0));
  EXPECT_FALSE(search.is_held(1));
}

/// A corner of two bounds, from the corner opposite; and the bounds of logarithms to the last bit.
TEST(LeastSquaresSearch, EndsInACornerOfLogarithms) {
  GivenResiduals residuals([](const VectorX& p) { return vector({p[0] - 9, p[1] - 0.01, p[0] * p[1]}); },
                           [](const VectorX& p) {
                             DenseMatrix J(3, 2);
                             J << 1, 0, 0, 1, p[1], p[0];
                             return J;
                           });
  LeastSquaresSearch search(
      residuals, {ParameterTransform::in_box(true, 0.3, 7), ParameterTransform::in_box(true, 0.3, 7)}, {});
  ASSERT_TRUE(search.run(search.z_of(vector({0.3, 7}))));
  EXPECT_TRUE(search.is_converged());
  EXPECT_EQ(search.values()[0], 7);
  EXPECT_EQ(search.values()[1], 0.3);
}

/// Only x + y is determined: the search ends on that line, as near to the start as it may.
TEST(LeastSquaresSearch, TakesTheShortestWayWhereTheDataLeaveNumbersOpen) {
  GivenResiduals residuals([](const VectorX& p) { return vector({p[0] + p[1] - 3, 2 * (p[0] + p[1] - 3)}); },
                           [](const VectorX&) {
                             DenseMatrix J(2, 2);
                             J << 1, 1, 2, 2;
                             return J;
                           });
  LeastSquaresSearch search(residuals, plain(2), {});
  ASSERT_TRUE(search.run(vector({0, 1})));
  EXPECT_TRUE(search.is_converged());
  EXPECT_LT((search.values() - vector({1, 2})).norm(), 1e-9);
}

/// A number that no residual depends on stays where it is.
TEST(LeastSquaresSearch, LeavesANumberWithoutEffectAlone) {
  GivenResiduals residuals([](const VectorX& p) { return vector({std::exp(p[0]) - 2, p[0] - 1}); },
                           [](const VectorX& p) {
                             DenseMatrix J = DenseMatrix::Zero(2, 2);
                             J(0, 0) = std::exp(p[0]);
                             J(1, 0) = 1;
                             return J;
                           });
  LeastSquaresSearch search(residuals, plain(2), {});
  ASSERT_TRUE(search.run(vector({0, 5})));
  EXPECT_TRUE(search.is_converged());
  EXPECT_EQ(search.values()[1], 5);
  EXPECT_NEAR(std::exp(search.values()[0]) * (std::exp(search.values()[0]) - 2) + search.values()[0] - 1, 0,
              1e-9);
}

/// A full step goes where there are no residuals, says so in one of three ways, and is shortened.
TEST(LeastSquaresSearch, GoesAroundPlacesWithoutResiduals) {
  enum class Absence { none, not_finite, error };
  for (const Absence absence : {Absence::none, Absence::not_finite, Absence::error}) {
    GivenResiduals residuals(
        [=](const VectorX& p) {
          const double x = p[0];
          if (x <= 0 && absence == Absence::none) return VectorX();
          if (x <= 0 && absence == Absence::error) throw InputError("scene", "an equilibrium", "none");
          return vector({x <= 0 ? std::nan("") : std::log(x)});
        },
        [](const VectorX& p) { return DenseMatrix::Constant(1, 1, 1 / p[0]); });
    int without = 0;
    LeastSquaresSearch search(residuals, plain(1), {.on_trial = [&](const SearchTrial& trial) {
                                if (std::isfinite(trial.sum_of_squares)) return;
                                ++without;
                                EXPECT_FALSE(trial.is_better);
                                EXPECT_EQ(trial.problem.empty(), absence != Absence::error);
                              }});
    ASSERT_TRUE(search.run(vector({20})));  // the step of Gauss and Newton ends at 20 (1 - log 20) < 0
    EXPECT_TRUE(search.is_converged());
    EXPECT_NEAR(search.values()[0], 1, 1e-12);
    EXPECT_GT(without, 0);
  }
}

TEST(LeastSquaresSearch, KnowsWhenItCannotBegin) {
  GivenResiduals residuals([](const VectorX&) { return vector({std::nan("")}); },
                           [](const VectorX&) { return DenseMatrix(1, 1); });
  LeastSquaresSearch search(residuals, plain(1), {});
  EXPECT_FALSE(search.run(vector({1})));
}

TEST(LeastSquaresSearch, SaysWhyItHasEnded) {
  GivenResiduals residuals = rosenbrock();
  LeastSquaresSearch few(residuals, plain(2), {.most_evaluations = 5});
  ASSERT_TRUE(few.run(vector({-1.2, 1})));
  EXPECT_EQ(few.ending(), SearchEnding::too_many_evaluations);
  EXPECT_EQ(few.evaluations(), 5);
  // Slopes of the wrong sign: no step is better.
  GivenResiduals wrong([](const VectorX& p) { return vector({p[0] - 1, 1}); },
                       [](const VectorX&) {
                         DenseMatrix J(2, 1);
                         J << -1, 0;
                         return J;
                       });
  LeastSquaresSearch lost(wrong, plain(1), {});
  ASSERT_TRUE(lost.run(vector({0})));
  EXPECT_EQ(lost.ending(), SearchEnding::no_better_step);
  EXPECT_EQ(lost.values()[0], 0);
}

/// A gain or a step that does not count ends the search before it is evaluated.
TEST(LeastSquaresSearch, EndsWhereAStepDoesNotCount) {
  GivenResiduals residuals = rosenbrock();
  LeastSquaresSearch exact(residuals, plain(2), {}), rough(residuals, plain(2), {.tolerance = 1e-2}),
      content(residuals, plain(2), {.negligible_gain = [](double sum) { return sum; }});
  for (LeastSquaresSearch* search : {&exact, &rough, &content}) {
    ASSERT_TRUE(search->run(vector({-1.2, 1})));
    EXPECT_TRUE(search->is_converged());
  }
  EXPECT_LT(rough.evaluations(), exact.evaluations());
  EXPECT_LT((rough.values() - vector({1, 1})).norm(), 0.1);
  EXPECT_EQ(content.evaluations(), 1);
}

/// u^T R u of all numbers: the least |p - d|^2 + a |p|^2 is d / (1 + a).
class Ridge : public Prior {
 public:
  explicit Ridge(double weight) : weight_(weight) {}
  double value(const VectorX& z) const override { return weight_ * z.squaredNorm(); }
  SearchStep best_step(const VectorX& z, const VectorX& r, const DenseMatrix& J) override {
    const DenseMatrix H = J.transpose() * J + weight_ * DenseMatrix::Identity(z.size(), z.size());
    const VectorX g = J.transpose() * r + weight_ * z, change = -H.ldlt().solve(g);
    return {change, -g.dot(change)};
  }

 private:
  double weight_;
};

TEST(LeastSquaresSearch, MeetsAPrior) {
  GivenResiduals linear([](const VectorX& p) { return VectorX(p - vector({1, -2, 3})); },
                        [](const VectorX&) { return DenseMatrix::Identity(3, 3); });
  Ridge prior(0.5);
  LeastSquaresSearch search(linear, plain(3), {.first_damping = 0}, nullptr, &prior);
  ASSERT_TRUE(search.run(VectorX::Zero(3)));
  EXPECT_TRUE(search.is_converged());
  EXPECT_LT((search.values() - vector({1, -2, 3}) / 1.5).norm(), 1e-14);
  EXPECT_LE(search.evaluations(), 3);
  // Where the full step is too long it is shortened: the gradient of sum and prior vanishes at the end.
  GivenResiduals curved = rosenbrock();
  LeastSquaresSearch bent(curved, plain(2), {.first_damping = 0, .damping_after_failure = 2}, nullptr,
                          &prior);
  ASSERT_TRUE(bent.run(vector({-1.2, 1})));
  EXPECT_TRUE(bent.is_converged());
  EXPECT_LT((bent.slopes().transpose() * bent.residuals() + 0.5 * bent.values()).norm(), 1e-6);
}

/// x + y >= 4, which the point of least squares violates.
class Halfplane : public InequalityConstraints {
 public:
  double violation(const VectorX& p) const override { return std::max(0.0, 4 - p.sum()); }
  bool linearise(const VectorX& p, VectorX& g, DenseMatrix& slopes) const override {
    g = vector({p.sum() - 4});
    slopes = DenseMatrix::Ones(1, 2);
    return true;
  }
};

TEST(LeastSquaresSearch, KeepsConditionsFromAStartThatDoesNot) {
  GivenResiduals residuals([](const VectorX& p) { return vector({p[0] - 1, p[1] - 0.5}); },
                           [](const VectorX&) { return DenseMatrix::Identity(2, 2); });
  const Halfplane constraint;
  for (const bool has_bound : {false, true}) {
    std::vector<ParameterTransform> transforms = plain(2);
    if (has_bound) transforms[1] = ParameterTransform::in_box(true, 1e-3, 1.5);
    LeastSquaresSearch search(residuals, transforms, {}, &constraint);
    ASSERT_TRUE(search.run(search.z_of(vector({0.2, 0.1}))));
    const VectorX expected = has_bound ? vector({2.5, 1.5}) : vector({2.25, 1.75});
    EXPECT_LT((search.values() - expected).norm(), 1e-6) << has_bound;
    EXPECT_EQ(search.is_held(1), false);  // the sum of squares would have it smaller
  }
}

/// Each transform is its own inverse's inverse, with the slope of a difference.
TEST(ParameterTransform, HasAnInverseAndASlope) {
  for (const ParameterTransform& transform :
       {ParameterTransform::in_box(false, -1, 5), ParameterTransform::in_box(true, 0, infinity),
        ParameterTransform::within(false, -1, 5), ParameterTransform::within(true, 0.1, 5),
        ParameterTransform::within(true, 0, 5)}) {
    const double value = 0.7, z = transform.to(value), h = 1e-5;
    EXPECT_NEAR(transform.from(z), value, 1e-15);
    EXPECT_NEAR(transform.slope(z), (transform.from(z + h) - transform.from(z - h)) / (2 * h), 1e-9);
  }
  EXPECT_NEAR(ParameterTransform::within(true, 0.1, 5).from(800), 5, 1e-14);
  EXPECT_EQ(ParameterTransform::within(false, 0.1, 5).upper(), infinity);
  EXPECT_FALSE(ParameterTransform::in_box(false, 0, 1).is_relative());
  EXPECT_TRUE(ParameterTransform::within(false, 0, 1).is_relative());
}

}  // namespace
}  // namespace resilin
