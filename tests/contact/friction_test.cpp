// The energy of friction in a stage, whatever its contacts come from.

#include "resilin/contact/friction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace resilin::testing {
namespace {

constexpr double speed = 0.01;     // [m/s]
constexpr double duration = 0.02;  // [s]
constexpr double eps = speed * duration;

/// Contacts that do not depend on where bodies are: a node against an obstacle that moves, and a node against
/// the inside of a triangle (2D: of an edge) of other nodes.
class SampleSource final : public FrictionSource {
 public:
  explicit SampleSource(int dimension) : dim_(dimension) {}
  std::string_view name_in_reports() const override { return "sample"; }
  void add_friction_contacts(const VectorX&, const VectorX&, const Conditions&,
                             FrictionContacts& contacts) const override {
    const Vector3 normal =
        dim_ == 3 ? Vector3(Vector3(1, 2, -3).normalized()) : Vector3(Vector3(1, 2, 0).normalized());
    const std::array obstacle = {WeightedNode{0, 1}};
    contacts.add({.normal = normal, .limit = 3, .velocity = {0.3, -0.2, dim_ == 3 ? 0.1 : 0}}, obstacle);
    const std::array triangle = {WeightedNode{1, 1}, WeightedNode{2, -0.2}, WeightedNode{3, -0.3},
                                 WeightedNode{4, -0.5}};
    const std::array edge = {WeightedNode{1, 1}, WeightedNode{2, -0.3}, WeightedNode{3, -0.7}};
    const FrictionContact contact{.normal = normal, .limit = 2};
    dim_ == 3 ? contacts.add(contact, triangle) : contacts.add(contact, edge);
  }

 private:
  int dim_;
};

/// Five nodes whose contacts slip by about `slip` times eps.
struct Sample {
  int dimension;
  Friction friction;
  VectorX start, x;
  std::unique_ptr<Energy> term;
  Conditions conditions{};

  Sample(int dim, double slip) : dimension(dim), friction(dim, {std::make_shared<SampleSource>(dim)}, speed) {
    start = random(1, 1);
    x = start + slip * eps * random(1, 2);
    const Vector3 velocity(0.3, -0.2, dim == 3 ? 0.1 : 0);
    x.head(dim) += duration * velocity.head(dim);
    term = friction.begin_stage({.base_positions = start, .duration = duration});
    term->lagged_term()->form_lag(x, conditions);
  }
  VectorX random(double amount, unsigned seed) const {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> uniform(-amount, amount);
    VectorX values(5 * dimension);
    for (double& value : values) value = uniform(generator);
    return values;
  }
  VectorX gradient(const VectorX& at) const {
    VectorX sum = VectorX::Zero(at.size());
    term->add_gradient(at, conditions, sum);
    return sum;
  }
  BlockMatrix hessian(const VectorX& at) const {
    BlockPatternBuilder builder(5);
    BlockMatrix matrix(dimension, std::make_shared<const BlockPattern>(builder.build()));
    term->add_hessian(at, conditions, Projection::none, matrix);
    return matrix;
  }
};

/// Sticking, about to slip and sliding.
constexpr std::array slips = {0.1, 1.0, 30.0};

TEST(TheEnergyOfFriction, HasItsSlopesStickingAndSliding) {
  for (const int dimension : {2, 3})
    for (const double slip : slips) {
      const Sample sample(dimension, slip);
      const VectorX p = sample.random(1, 3), q = sample.random(1, 4);
      // Central differences over parts of eps: error of second order in them; f1 bends at eps.
      const double h = 1e-5 * eps;
      const VectorX after = sample.x + h * p, before = sample.x - h * p;
      const double slope = sample.term->difference(before, after, {}) / (2 * h);
      EXPECT_NEAR(slope, sample.gradient(sample.x).dot(p), 1e-6 * p.norm()) << dimension << " " << slip;
      VectorX product;
      multiply(sample.hessian(sample.x), p, product);
      const double change = q.dot(sample.gradient(after) - sample.gradient(before)) / (2 * h);
      EXPECT_NEAR(q.dot(product), change, 1e-4 * q.norm() * product.norm() + 1e-6)
          << dimension << " " << slip;
      EXPECT_GE(p.dot(product), 0);
    }
}

TEST(TheEnergyOfFriction, HasTheDifferenceOfItsValuesWithItsDigits) {
  for (const int dimension : {2, 3})
    for (const double slip : slips) {
      const Sample sample(dimension, slip);
      const VectorX p = sample.random(eps, 5);
      const double there = sample.term->difference(sample.x, sample.x + p, {});
      const double values = sample.term->value(sample.x + p, {}) - sample.term->value(sample.x, {});
      EXPECT_NEAR(there, values, 1e-12 * sample.term->value(sample.x, {}) + 1e-15);
      EXPECT_NEAR(sample.term->difference(sample.x + p, sample.x, {}), -there, 1e-12 * std::abs(there));
      // A way of 1e-9 of it leaves the value few digits, its slope all.
      const double tiny = 1e-9 / 2;
      const VectorX to = sample.x + tiny * p;
      EXPECT_NEAR(sample.term->difference(sample.x, to, {}), sample.gradient(sample.x).dot(to - sample.x),
                  1e-7 * sample.gradient(sample.x).norm() * (to - sample.x).norm());
    }
}

TEST(TheEnergyOfFriction, IsZeroWithoutSlipAndPullsWithItsLimitBeyondEps) {
  for (const int dimension : {2, 3}) {
    const Sample still(dimension, 0);
    EXPECT_NEAR(still.term->value(still.x, {}), 0, 1e-20);
    EXPECT_LT(still.gradient(still.x).norm(), 1e-9);
    const Sample sliding(dimension, 30);
    const VectorX force = sliding.gradient(sliding.x);
    EXPECT_NEAR(force.head(dimension).norm(), 3, 1e-12);
    // Both sides of a pair are pulled alike, to opposite sides; of one of them the nodes by their weights.
    VectorX sum = VectorX::Zero(dimension);
    for (int node = 1; node < 5; ++node) sum += force.segment(node * dimension, dimension);
    EXPECT_LT(sum.norm(), 1e-15);
    EXPECT_NEAR(force.segment(dimension, dimension).norm(), 2, 1e-12);
    EXPECT_NEAR(force.segment(2 * dimension, dimension).norm(), dimension == 3 ? 0.4 : 0.6, 1e-12);
  }
}

/// f1(y) = 2 y/eps - (y/eps)^2
TEST(TheEnergyOfFriction, PullsByTheMollifierWhileItSticks) {
  Sample sample(2, 0);
  const Vector3 normal = Vector3(1, 2, 0).normalized(), tangent(-normal.y(), normal.x(), 0);
  for (const double part : {0.01, 0.3, 0.99}) {
    const VectorX x = sample.x + part * eps * [&] {
      VectorX way = VectorX::Zero(10);
      way.head(2) = tangent.head(2);
      return way;
    }();
    EXPECT_NEAR(sample.gradient(x).head(2).dot(tangent.head(2)), 3 * (2 * part - part * part), 1e-9);
  }
}

TEST(TheEnergyOfFriction, FollowsTheVelocityAtTheEndOfAStageWhoseUnknownIsAMean) {
  const Friction friction(2, {std::make_shared<SampleSource>(2)}, speed);
  const Sample sample(2, 1);
  Stage stage{.base_positions = sample.start,
              .base_velocities = sample.random(1, 7),
              .duration = duration,
              .is_mean = true};
  const auto term = friction.begin_stage(stage);
  term->lagged_term()->form_lag(sample.x, {});
  // The end 2 x_m - x_0 without a velocity there: v = 2 v_m - v_n and v_m = v_n + c a, so x_0 + c v_0.
  const VectorX still = sample.start + duration * stage.base_velocities;
  const auto backward_euler = friction.begin_stage({.base_positions = still, .duration = duration});
  backward_euler->lagged_term()->form_lag(sample.x, {});
  EXPECT_EQ(term->value(sample.x, {}), backward_euler->value(sample.x, {}));
}

TEST(TheEnergyOfFriction, IsThereInStaticsOnlyWhereALoadIncrementStandsForATime) {
  const Friction friction(2, {std::make_shared<SampleSource>(2)}, speed);
  const VectorX x = VectorX::Zero(10);
  EXPECT_EQ(friction.begin_stage(static_stage(x)), nullptr);
  const auto term = friction.begin_stage(static_stage(x, duration));
  ASSERT_NE(term, nullptr);
  EXPECT_EQ(term->value(x + VectorX::Ones(10), {}), 0) << "before its normal forces are known";
  EXPECT_TRUE(term->lagged_term()->form_lag(x, {}));
  EXPECT_GT(term->value(x + VectorX::Ones(10), {}), 0);
}

TEST(TheEnergyOfFriction, IsNoNumberWhereTheSlipIsNone) {
  const Sample sample(3, 1);
  VectorX x = sample.x;
  x[4] = std::nan("");
  EXPECT_TRUE(std::isnan(sample.term->value(x, {})));
  EXPECT_TRUE(std::isnan(sample.term->difference(sample.x, x, {})));
  EXPECT_TRUE(std::isnan(sample.gradient(x).sum()));
}

/// Force times the way that things rub, whoever goes it.
// Chan, Golub & Mulet's matrix: never negative wherever the search went, and once nothing moves that of x.
TEST(TheHessianOfFriction, FollowsTheSearch) {
  for (const int dim : {2, 3})
    for (const double slip : {0.0, 0.3, 0.99, 5.0, 1000.0}) {
      Sample sample(dim, slip);
      const BlockMatrix at_x = sample.hessian(sample.x);
      VectorX x = sample.x;
      for (unsigned k = 0; k < 20; ++k) {
        const VectorX p = sample.random(std::pow(10.0, int(k % 7) - 4) * eps, 10 + k);
        const double t = k % 3 == 0 ? 0.3 : 1;
        sample.term->lagged_term()->follow(x, p, t);
        x += t * p;
        const BlockMatrix followed = sample.hessian(x);
        VectorX product;
        for (unsigned i = 0; i < 5; ++i) {
          const VectorX q = sample.random(1, 100 + i);
          multiply(followed, q, product);
          EXPECT_GE(q.dot(product), -1e-12 * product.norm() * q.norm()) << dim << "D, slip " << slip;
        }
      }
      VectorX expected, product;
      const VectorX q = sample.random(1, 200);
      multiply(at_x, q, expected);
      sample.term->lagged_term()->follow(sample.x, VectorX::Zero(x.size()), 1);
      multiply(sample.hessian(sample.x), q, product);
      EXPECT_LE((product - expected).norm(), 1e-14 * 3 / eps * q.norm()) << dim << "D, slip " << slip;
    }
}

/// A node that is pressed by so much as it stands high, and not at all below 0.
class PressedByHeight final : public FrictionSource {
 public:
  void add_friction_contacts(const VectorX& x, const VectorX&, const Conditions&,
                             FrictionContacts& contacts) const override {
    for (Index node = 0; node < 2; ++node)
      contacts.add({.normal = Vector3::UnitZ(), .limit = x[3 * node + 2]}, std::array{WeightedNode{node, 1}});
  }
};

/// Limits that follow those in use by straight lines, far too much.
TEST(RelaxedForces, SettleWhereRoundsThrowThemToAndFro) {
  const Friction friction(3, {std::make_shared<PressedByHeight>()}, speed);
  VectorX x(6);
  x << 1, 2, 0, 3, -1, 0;
  const auto limits = [&](const Energy& term) {  // both slip
    VectorX sum = VectorX::Zero(6);
    term.add_gradient(x, {}, sum);
    return Eigen::Vector2d(sum.head<3>().norm(), sum.tail<3>().norm());
  };
  const auto settled = [&](const auto& formed, int rounds) {
    const auto term = friction.begin_stage({.base_positions = VectorX::Zero(6), .duration = duration});
    const auto form = [&](const Eigen::Vector2d& limit) {
      VectorX heights = VectorX::Zero(6);
      heights[2] = limit[0];
      heights[5] = limit[1];
      term->lagged_term()->form_lag(heights, {});
    };
    form({1, 2});
    for (int round = 0; round < rounds; ++round) {
      form(formed(limits(*term)));
      term->lagged_term()->relax_lag();
    }
    return limits(*term);
  };
  const auto lines = [](const Eigen::Vector2d& in_use) {
    return Eigen::Vector2d(4 - 1.5 * in_use[0], 4 - 1.5 * in_use[1]);
  };
  EXPECT_LT((settled(lines, 3) - Eigen::Vector2d(1.6, 1.6)).norm(), 1e-12);
}

/// Contacts that stay, that are left and that are new: between the last and those before, or beyond them.
TEST(RelaxedForces, AreAShareOfTheLastAndTheRestOfThoseBefore) {
  const Friction friction(3, {std::make_shared<PressedByHeight>()}, speed);
  VectorX x(6);
  x << 1, 2, 0, 3, -1, 0;
  const auto gradient = [&](const Energy& term) {
    VectorX sum = VectorX::Zero(6);
    term.add_gradient(x, {}, sum);
    return sum;
  };
  using Limits = std::array<double, 2>;
  std::vector<double> shares;
  for (const auto& [start, before, after] : {std::array{Limits{1, 1}, Limits{4, 2}, Limits{2, -1}},
                                             std::array{Limits{1, 2}, Limits{4, 0}, Limits{3, 1}},
                                             std::array{Limits{1, 1}, Limits{4, 2}, Limits{5, 2.5}},
                                             std::array{Limits{4, 3}, Limits{3, 1.5}, Limits{2.6, -1}}}) {
    const auto term = friction.begin_stage({.base_positions = VectorX::Zero(6), .duration = duration});
    const auto form = [&](const Limits& limits) {
      VectorX heights = VectorX::Zero(6);
      heights[2] = limits[0];
      heights[5] = limits[1];
      term->lagged_term()->form_lag(heights, {});
      return gradient(*term);
    };
    const auto change = [](const Limits& from, const Limits& to) {
      return std::array{std::max(to[0], 0.0) - std::max(from[0], 0.0),
                        std::max(to[1], 0.0) - std::max(from[1], 0.0)};
    };
    Relaxation relaxation;
    form(start);
    const VectorX first = form(before);
    EXPECT_FALSE(term->lagged_term()->relax_lag());
    relaxation.next_share(change(start, before));
    const VectorX last = form(after);
    EXPECT_TRUE(term->lagged_term()->relax_lag());
    const double share = relaxation.next_share(change(before, after));
    VectorX expected = share * last + (1 - share) * first;
    if (share > 1 && after[1] < 0) expected.tail(3).setZero();  // friction never pushes
    EXPECT_LE((gradient(*term) - expected).norm(), 1e-14 * expected.norm()) << share;
    shares.push_back(share);
  }
  EXPECT_LT(std::ranges::min(shares), 0.9);
  EXPECT_GT(std::ranges::max(shares), 1.1);
}

TEST(CoupledForces, AreThoseWithNormalForcesOfTheVeryPlace) {
  const Friction friction(3, {std::make_shared<PressedByHeight>()}, speed);
  VectorX before(6), after(6);
  before << 0, 0, 4, 0, 0, 1;
  after << 1, 2, 2, 3, -1, 5;
  const auto gradient = [](const Energy& term, const VectorX& x) {
    VectorX sum = VectorX::Zero(6);
    term.add_gradient(x, {}, sum);
    return sum;
  };
  const auto term = friction.begin_stage({.base_positions = VectorX::Zero(6), .duration = duration});
  term->lagged_term()->form_lag(after, {});
  const VectorX of_the_place = gradient(*term, after);
  term->lagged_term()->form_lag(before, {});
  const VectorX lagged = gradient(*term, after);
  EXPECT_GT((of_the_place - lagged).norm(), 0.1 * lagged.norm());
  term->lagged_term()->couple_lag(true);
  EXPECT_EQ(gradient(*term, after), of_the_place);
  term->lagged_term()->form_lag(after, {});
  EXPECT_EQ(gradient(*term, after), of_the_place);
  term->lagged_term()->couple_lag(false);
  EXPECT_EQ(gradient(*term, after), lagged);
}

TEST(TheHeatOfFriction, IsTheForceTimesTheSlip) {
  const Sample sample(2, 30);
  const double heat = sample.term->dissipation(sample.start, sample.x, duration);
  EXPECT_NEAR(heat,
              sample.gradient(sample.x).dot(sample.x - sample.start) -
                  duration * sample.gradient(sample.x).head(2).dot(Eigen::Vector2d(0.3, -0.2)),
              1e-12 * heat);
  EXPECT_GT(heat, 0);
}

}  // namespace
}  // namespace resilin::testing
