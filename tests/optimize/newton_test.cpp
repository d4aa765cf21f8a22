#include "resilin/optimize/newton.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace resilin {
namespace {

/// A chain of nodes in the plane with neo-Hookean-like springs between neighbours and a barrier at length
/// zero:
///   E = sum_i k/2 (l_i^2 - 1 - 2 ln l_i) - f.x,  l_i = |x_{i+1} - x_i|.
/// Its Hessian is indefinite where springs are pressed, as that of solids is.
class Chain final : public Objective {
 public:
  Chain(Index num_nodes, VectorX force) : num_nodes_(num_nodes), force_(std::move(force)) {}

  std::shared_ptr<const BlockPattern> pattern() const {
    BlockPatternBuilder builder(num_nodes_);
    for (Index i = 0; i + 1 < num_nodes_; ++i) builder.add_pair(i, i + 1);
    return std::make_shared<BlockPattern>(builder.build());
  }

  double difference(const VectorX& from, const VectorX& to) const override {
    double sum = -force_.dot(to - from);
    for (Index i = 0; i + 1 < num_nodes_; ++i) sum += energy(span(to, i)) - energy(span(from, i));
    return sum;
  }
  double magnitude(const VectorX& x) const override {
    double sum = std::abs(force_.dot(x));
    for (Index i = 0; i + 1 < num_nodes_; ++i) sum += std::abs(energy(span(x, i)));
    return sum;
  }
  void gradient(const VectorX& x, VectorX& g) const override {
    g = -force_;
    for (Index i = 0; i + 1 < num_nodes_; ++i) {
      const Eigen::Vector2d d = span(x, i);
      const Eigen::Vector2d pull = stiffness * (1 - 1 / d.squaredNorm()) * d;
      g.segment<2>(2 * i) -= pull;
      g.segment<2>(2 * (i + 1)) += pull;
    }
  }
  void gradient_magnitude(const VectorX& x, VectorX& m) const override {
    m = force_.cwiseAbs();
    for (Index i = 0; i + 1 < num_nodes_; ++i) {
      const Eigen::Vector2d d = span(x, i);
      const Eigen::Vector2d pull = (stiffness * (1 + 1 / d.squaredNorm()) * d).cwiseAbs();
      m.segment<2>(2 * i) += pull;
      m.segment<2>(2 * (i + 1)) += pull;
    }
  }
  void hessian(const VectorX& x, Projection projection, BlockMatrix& H) const override {
    for (Index i = 0; i + 1 < num_nodes_; ++i) {
      const Eigen::Vector2d d = span(x, i);
      const double l2 = d.squaredNorm();
      const Eigen::Matrix2d along = d * d.transpose() / l2;
      const auto filter = [projection](double value) {
        if (projection == Projection::none) return value;
        return projection == Projection::clamp ? std::max(value, 0.0) : std::abs(value);
      };
      const Eigen::Matrix2d k = filter(stiffness * (1 + 1 / l2)) * along +
                                filter(stiffness * (1 - 1 / l2)) * (Eigen::Matrix2d::Identity() - along);
      const Eigen::Matrix2d minus = -k;
      H.add_block(i, i, k.data());
      H.add_block(i + 1, i + 1, k.data());
      H.add_block(i, i + 1, minus.data());
    }
  }
  double max_step(const VectorX&, const VectorX&) const override { return 1; }
  double force_scale(const VectorX&, const VectorX& g) const override {
    return std::max(force_.norm(), g.head<2>().norm());
  }

 private:
  static constexpr double stiffness = 100;
  static double energy(const Eigen::Vector2d& d) {
    const double l2 = d.squaredNorm();
    return l2 > 0 ? 0.5 * stiffness * (l2 - 1 - std::log(l2)) : std::numeric_limits<double>::infinity();
  }
  Eigen::Vector2d span(const VectorX& x, Index i) const {
    return x.segment<2>(2 * (i + 1)) - x.segment<2>(2 * i);
  }

  Index num_nodes_;
  VectorX force_;
};

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
  const Chain chain(num_nodes, weight());
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

TEST(Newton, LowersTheObjectiveInEveryIteration) {
  const Chain chain(num_nodes, weight());
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

}  // namespace
}  // namespace resilin
