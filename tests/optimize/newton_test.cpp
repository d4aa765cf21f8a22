#include "resilin/optimize/newton.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "chain.hpp"
#include "resilin/core/relaxation.hpp"

namespace resilin {
namespace {

using testing::Chain;

constexpr Index num_nodes = 12;

VectorX straight_line() {
  VectorX x = VectorX::Zero(2 * num_nodes);
  for (Index i = 0; i < num_nodes; ++i) x[2 * i] = i;
  return x;
}

VectorX weight() {
  VectorX force = VectorX::Zero(2 * num_nodes);
  for (Index i = 0; i < num_nodes; ++i) force[2 * i + 1] = -5;
  return force;
}

std::vector<std::uint8_t> both_ends_fixed() {
  std::vector<std::uint8_t> is_fixed(2 * num_nodes, 0);
  is_fixed[0] = is_fixed[1] = is_fixed[2 * num_nodes - 2] = is_fixed[2 * num_nodes - 1] = 1;
  return is_fixed;
}

NewtonReport solve(const VectorX& start, const VectorX& targets, NewtonSettings settings, VectorX& x,
                   const std::string& solver = "ldlt", const NewtonObserver& observer = {}) {
  Chain chain(num_nodes, weight());
  Newton newton(2, chain.pattern(), make_linear_solver({.kind = solver}, 2 * num_nodes));
  x = start;
  return newton.minimize(chain, both_ends_fixed(), targets, settings, x, observer);
}

TEST(Newton, FindsTheHangingChainWithEveryPolicyThatProjects) {
  for (const auto policy : {ProjectionPolicy::clamp, ProjectionPolicy::absolute, ProjectionPolicy::on_failure,
                            ProjectionPolicy::adaptive}) {
    VectorX x;
    const NewtonReport report = solve(straight_line(), straight_line(), {.projection = policy}, x);
    EXPECT_TRUE(report.converged()) << report.reason;
    EXPECT_LE(report.residual, 1e-8 * report.force_scale);
    EXPECT_NEAR(x[2 * 5 + 1], x[2 * 6 + 1], 1e-6);  // the two middle nodes hang equally deep
    EXPECT_LT(x[2 * 5 + 1], -1);
  }
}

TEST(Newton, RespondsToForcesByItsLastMatrix) {
  const Chain chain(num_nodes, weight());
  for (const std::string solver : {"ldlt", "cg_jacobi"}) {
    Newton newton(2, chain.pattern(), make_linear_solver({.kind = solver}, 2 * num_nodes));
    EXPECT_FALSE(newton.response(weight(), both_ends_fixed(), 1e-10)) << "there is no matrix yet";
    VectorX x = 1.2 * straight_line();  // a chain that is not tight gives way sideways
    x[9] = -0.3;
    newton.form_matrix(chain, both_ends_fixed(), x);
    const std::optional<VectorX> way = newton.response(weight(), both_ends_fixed(), 1e-10);
    ASSERT_TRUE(way);
    BlockMatrix hessian(2, chain.pattern());
    chain.hessian(x, Projection::clamp, hessian);
    VectorX force;
    multiply(hessian, *way, force);
    for (Index i = 0; i < 2 * num_nodes; ++i) {
      if (both_ends_fixed()[static_cast<std::size_t>(i)] != 0) {
        EXPECT_EQ((*way)[i], 0);
      } else {
        EXPECT_NEAR(force[i], weight()[i], 1e-8 * weight().norm());
      }
    }
  }
}

/// A search that begins at the solution forms no matrix, and none of an earlier one is left.
TEST(Newton, ForgetsTheMatrixOfTheSearchBefore) {
  Chain chain(num_nodes, weight());
  Newton newton(2, chain.pattern(), make_linear_solver({.kind = "ldlt"}, 2 * num_nodes));
  VectorX x = straight_line();
  ASSERT_TRUE(newton.minimize(chain, both_ends_fixed(), x, {}, x).converged());
  EXPECT_TRUE(newton.response(weight(), both_ends_fixed(), 1e-10));
  ASSERT_TRUE(newton.minimize(chain, both_ends_fixed(), x, {}, x).converged());
  EXPECT_FALSE(newton.response(weight(), both_ends_fixed(), 1e-10));
}

TEST(Newton, LowersTheObjectiveInEveryIteration) {
  Chain chain(num_nodes, weight());
  VectorX start = straight_line();
  for (Index i = 1; i + 1 < num_nodes; ++i) start.segment<2>(2 * i) = Eigen::Vector2d(0.3 * (i % 3), 0.1 * i);
  Newton newton(2, chain.pattern(), make_linear_solver({.kind = "ldlt"}, 2 * num_nodes));
  VectorX x = start;
  VectorX previous = start;
  int observed = 0;
  const NewtonReport report =
      newton.minimize(chain, both_ends_fixed(), straight_line(), {}, x, [&](const NewtonReport&) {
        EXPECT_LT(chain.difference(previous, x), 1e-12 * chain.magnitude(x));
        previous = x;
        ++observed;
        return true;
      });
  EXPECT_TRUE(report.converged()) << report.reason;
  EXPECT_EQ(observed, report.iterations);
}

TEST(Newton, ConvergesQuadratically) {
  std::vector<double> residuals;
  VectorX x;
  NewtonSettings settings;
  settings.tolerance = 1e-13;
  solve(straight_line(), straight_line(), settings, x, "ldlt", [&](const NewtonReport& report) {
    residuals.push_back(report.relative_residual());
    return true;
  });
  // From below 1e-3 on, each residual is of the order of the square of the one before.
  bool is_tested = false;
  for (std::size_t i = 1; i < residuals.size(); ++i) {
    if (residuals[i - 1] > 1e-3 || residuals[i] < 1e-13) continue;
    EXPECT_LT(residuals[i], 1e3 * residuals[i - 1] * residuals[i - 1]);
    is_tested = true;
  }
  EXPECT_TRUE(is_tested);
}

TEST(Newton, LeadsFixedUnknownsToTheirTargetsExactly) {
  VectorX targets = straight_line();
  targets[2 * num_nodes - 2] += 3;
  targets[2 * num_nodes - 1] += 1;
  VectorX x;
  const NewtonReport report = solve(straight_line(), targets, {}, x);
  EXPECT_TRUE(report.converged()) << report.reason;
  EXPECT_EQ(x[2 * num_nodes - 2], targets[2 * num_nodes - 2]);
  EXPECT_EQ(x[2 * num_nodes - 1], targets[2 * num_nodes - 1]);
  EXPECT_EQ(x[0], 0);
}

TEST(Newton, SaysThatTheLimitOfIterationsWasReached) {
  VectorX x;
  const NewtonReport report = solve(straight_line(), straight_line(), {.max_iterations = 2}, x);
  EXPECT_EQ(report.status, NewtonReport::Status::max_iterations);
  EXPECT_EQ(report.iterations, 2);
  EXPECT_FALSE(report.reason.empty());
  EXPECT_GE(report.worst_unknown, 2);
}

TEST(Newton, StopsWhenTheObserverAsksForIt) {
  VectorX x;
  const NewtonReport report =
      solve(straight_line(), straight_line(), {}, x, "ldlt", [](const NewtonReport&) { return false; });
  EXPECT_EQ(report.status, NewtonReport::Status::interrupted);
  EXPECT_EQ(report.iterations, 1);
}

TEST(Newton, GivesTheSameBitsWhenAskedAgain) {
  VectorX first;
  VectorX second;
  solve(straight_line(), straight_line(), {}, first);
  solve(straight_line(), straight_line(), {}, second);
  EXPECT_TRUE((first.array() == second.array()).all());
}

/// A chain that is pushed across where its middle was last known to be: forces without a potential, which
/// throw it around the place of balance.
class PushedAcross final : public Objective {
 public:
  /// @param ratio  of the push to the stiffness of springs: from 0.15 on rounds alone do not settle
  explicit PushedAcross(double ratio) : push_(ratio * 2 * Chain::stiffness) {}

  bool form_lag(const VectorX& x) override {
    before_ = std::exchange(lag_, x);
    return true;
  }
  bool relax_lag() override {
    if (before_.size() == 0) return false;
    const VectorX change = lag_ - before_;
    const double share = relaxation_.next_share({change.data(), static_cast<std::size_t>(change.size())});
    lag_ = before_ + share * change;
    return share != 1;
  }
  void couple_lag(bool is_coupled) override { is_coupled_ = is_coupled; }
  double difference(const VectorX& from, const VectorX& to) const override {
    return chain.difference(from, to) - force(lag_).dot(to - from);
  }
  double magnitude(const VectorX& x) const override { return chain.magnitude(x); }
  void gradient(const VectorX& x, VectorX& g) const override {
    chain.gradient(x, g);
    g -= force(is_coupled_ ? x : lag_);
  }
  void gradient_magnitude(const VectorX& x, VectorX& m) const override { chain.gradient_magnitude(x, m); }
  void hessian(const VectorX& x, Projection projection, BlockMatrix& H) const override {
    chain.hessian(x, projection, H);
  }
  double max_step(const VectorX&, const VectorX&) const override { return 1; }
  VectorX force_scales(const VectorX& x, const VectorX& g, const ConnectedComponents& parts) const override {
    return chain.force_scales(x, g, parts);
  }
  VectorX distinct_acting_scales(const VectorX& x, const VectorX& r,
                                 const ConnectedComponents& parts) const override {
    return chain.distinct_acting_scales(x, r, parts);
  }

  Chain chain{num_nodes, weight()};

 private:
  VectorX force(const VectorX& x) const {
    VectorX f = VectorX::Zero(2 * num_nodes);
    const Eigen::Index middle = num_nodes / 2;
    if (x.size() > 0)
      f.segment<2>(2 * middle) = push_ * Eigen::Vector2d(-x[2 * middle + 1], x[2 * middle] - middle);
    return f;
  }

  double push_;
  VectorX lag_{}, before_{};
  Relaxation relaxation_{};
  bool is_coupled_ = false;
};

TEST(Newton, SettlesWhatLagsWhereRoundsAloneDoNot) {
  const std::vector<std::uint8_t> ends = both_ends_fixed();
  for (const double ratio : {0.02, 0.05, 0.1, 0.15, 0.2}) {
    PushedAcross objective(ratio);
    Newton newton(2, objective.chain.pattern(), make_linear_solver({.kind = "ldlt"}, 2 * num_nodes));
    VectorX x = 1.2 * straight_line();
    const VectorX targets = x;
    const NewtonReport report =
        newton.minimize(objective, ends, targets, {.tolerance = 1e-10, .lag_rounds = 50}, x);
    ASSERT_TRUE(report.converged()) << ratio << ": " << report.reason;
    EXPECT_EQ(report.lag_mismatch, 0) << ratio;
    VectorX g;
    objective.couple_lag(true);
    objective.gradient(x, g);
    for (std::size_t i = 0; i < ends.size(); ++i)
      if (ends[i] != 0) g[static_cast<Eigen::Index>(i)] = 0;
    EXPECT_LE(g.norm(), 1e-9 * report.force_scale) << ratio;
  }
}

}  // namespace
}  // namespace resilin
