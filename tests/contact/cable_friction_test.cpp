// The energy of the friction of a cable in a stage.

#include "resilin/contact/cable_friction.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

namespace resilin::testing::cable_friction {
namespace {

constexpr double speed = 0.01;     // [m/s]
constexpr double duration = 0.02;  // [s]
constexpr double eps = speed * duration;
constexpr double mu = 0.4;

/// A cable through three guides, one of which is on the ground; its ends and a guide are carried by two
/// nodes.
std::shared_ptr<const Cable> sample_cable(int dim) {
  const auto point = [](Index a, Index b) { return CarriedPoint{.nodes = {{a, 0.7}, {b, 0.3}}}; };
  CarriedPoint ground;
  ground.place = {1.2, 0.3, dim == 3 ? 0.4 : 0};
  return std::make_shared<Cable>(
      "cable", dim, std::vector<CarriedPoint>{point(0, 1), point(2, 3), ground, point(3, 4), point(5, 4)},
      Cable::Law{.stiffness = 0, .tension = 5});
}

VectorX random_vector(Eigen::Index size, double amount, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-amount, amount);
  VectorX values(size);
  for (double& value : values) value = uniform(generator);
  return values;
}

/// Six nodes that have moved, so that the cable slips by about `slip` times eps; negative: backwards.
struct Sample {
  int dimension;
  CableFriction friction;
  VectorX start, x;
  std::unique_ptr<Energy> term;
  Conditions conditions{};

  Sample(int dim, double slip, bool is_static) : dimension(dim), friction(sample_cable(dim), mu, speed) {
    start = VectorX::Zero(6 * dim);
    for (int node = 0; node < 6; ++node) {
      start[node * dim] = 0.5 * node;
      start[node * dim + 1] = node % 2 == 0 ? 0 : 0.7;
    }
    start += random_vector(start.size(), 0.1, 1);
    // Along the slope of the length of all pieces but the first, so that all guides slip in one direction.
    VectorX slope = VectorX::Zero(start.size());
    friction.cable().path().add_slopes(start, std::vector<double>{0, 1, 1, 1}, slope);
    x = start - slip * eps * slope / slope.squaredNorm();
    term = is_static ? friction.begin_stage(static_stage(start, duration))
                     : friction.begin_stage({.base_positions = start, .duration = duration, .shape = x});
    term->lagged_term()->form_lag(x, conditions);
  }
  VectorX gradient(const VectorX& at) const {
    VectorX sum = VectorX::Zero(at.size());
    term->add_gradient(at, conditions, sum);
    return sum;
  }
  BlockMatrix hessian(const VectorX& at, Projection projection) const {
    BlockPatternBuilder builder(6);
    term->add_pattern(builder);
    friction.add_pattern(builder);
    BlockMatrix matrix(dimension, std::make_shared<const BlockPattern>(builder.build()));
    term->add_hessian(at, conditions, projection, matrix);
    return matrix;
  }
};

/// Calls `check(sample)` where the cable sticks, is about to slip and slides, both ways.
template <class Check>
void in_all_samples(const Check& check) {
  for (const int dim : {2, 3})
    for (const bool is_static : {true, false})
      for (const double slip : {-30.0, -1.3, -0.2, 0.1, 0.7, 1.6, 30.0}) {
        SCOPED_TRACE(std::to_string(dim) + "D, slip " + std::to_string(slip));
        check(Sample(dim, slip, is_static));
      }
}

TEST(CableFriction, DerivativesAreThoseOfItsEnergy) {
  in_all_samples([](const Sample& sample) {
    const VectorX p = random_vector(sample.x.size(), 1, 5);
    const double h = 1e-4 * eps;
    const double slope =
        sample.term->difference(sample.x - h * p, sample.x + h * p, sample.conditions) / (2 * h);
    const double size = sample.gradient(sample.x).norm();
    EXPECT_GT(size, 0.01);
    EXPECT_NEAR(sample.gradient(sample.x).dot(p), slope, 1e-6 * size);
    VectorX product;
    multiply(sample.hessian(sample.x, Projection::none), p, product);
    const VectorX change = (sample.gradient(sample.x + h * p) - sample.gradient(sample.x - h * p)) / (2 * h);
    EXPECT_LE((product - change).norm(), 1e-4 * change.norm() + 1e-3 * size);
  });
}

TEST(CableFriction, ChangeIsThatOfItsValues) {
  in_all_samples([](const Sample& sample) {
    for (const double amount : {1e-6, 1.0, 50.0}) {
      const VectorX to = sample.x + amount * eps * random_vector(sample.x.size(), 1, 6);
      const double from_value = sample.term->value(sample.x, {}), to_value = sample.term->value(to, {});
      // Lengths of metres are rounded.
      EXPECT_NEAR(sample.term->difference(sample.x, to, {}), to_value - from_value, 1e-14);
      EXPECT_EQ(sample.term->difference(sample.x, sample.x, {}), 0);
      EXPECT_GE(from_value, 0);
    }
  });
}

TEST(CableFriction, ProjectedHessianIsNeverNegative) {
  in_all_samples([](const Sample& sample) {
    for (const Projection projection : {Projection::clamp, Projection::absolute})
      for (unsigned seed = 10; seed < 20; ++seed) {
        const VectorX q = random_vector(sample.x.size(), 1, seed);
        VectorX product;
        multiply(sample.hessian(sample.x, projection), q, product);
        EXPECT_GE(q.dot(product), -1e-12 * q.norm() * product.norm());
      }
  });
}

TEST(CableFriction, MakesHeatThatIsNeverNegative) {
  in_all_samples([](const Sample& sample) {
    for (const VectorX& from : {sample.start, sample.x})
      EXPECT_GE(sample.term->dissipation(from, sample.x, duration), 0);
  });
}

/// Tensions at `x` after a stage from `start`.
std::vector<double> tensions(const Sample& sample) {
  return dynamic_cast<const LaggedCableFriction&>(*sample.term).tensions(sample.x, sample.conditions);
}

TEST(CableFriction, IsThatOfACapstanWhereTheCableSlides) {
  for (const int dim : {2, 3})
    for (const double direction : {-1.0, 1.0}) {
      const Sample sample(dim, direction * 30, true);
      const std::vector<double> all = tensions(sample),
                                turns = sample.friction.cable().path().turns(sample.x);
      ASSERT_EQ(all.size(), 4U);
      EXPECT_EQ(all[0], 5);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_GT(turns[i], 0.3);
        EXPECT_NEAR(all[i + 1] / all[i], std::exp(-direction * mu * turns[i]), 1e-14);
      }
    }
}

TEST(CableFriction, GivesTheForcesOfTheTensionsWithThatOfTheCable) {
  for (const double slip : {-30.0, -0.2, 0.7, 30.0}) {
    const Sample sample(3, slip, true);
    VectorX sum = sample.gradient(sample.x), expected = VectorX::Zero(sum.size());
    sample.friction.cable().add_gradient(sample.x, {}, sum);
    sample.friction.cable().path().add_slopes(sample.x, tensions(sample), expected);
    EXPECT_LE((sum - expected).norm(), 1e-13 * expected.norm());
  }
}

TEST(CableFriction, DoesNotSlipWhereAllTurns) {
  Sample sample(3, 0, true);
  // The point on the ground turns about itself.
  const Vector3 ground(1.2, 0.3, 0.4);
  const Eigen::AngleAxisd turn(2.0, Vector3(1, 2, 3).normalized());
  for (Index node = 0; node < 6; ++node) {
    const Vector3 place = node_position(3, node, sample.start);
    sample.x.segment(Eigen::Index{node} * 3, 3) = turn * (place - ground) + ground;
  }
  sample.term->lagged_term()->form_lag(sample.x, {});
  for (const double tension : tensions(sample)) EXPECT_NEAR(tension, 5, 1e-10);
}

TEST(CableFriction, HardlySlipsInStagesOfAMotionThatTurns) {
  // Errors of velocities of second order: 1/3 (w dt)^3 r / dt with BDF2.
  const Sample sample(3, 0, true);
  const Vector3 ground(1.2, 0.3, 0.4);
  const double angle = 0.02;
  const auto turned = [&](double by) {
    VectorX x = sample.start;
    const Eigen::AngleAxisd turn(by, Vector3(1, 2, 3).normalized());
    for (Index node = 0; node < 6; ++node)
      x.segment(Eigen::Index{node} * 3, 3) = turn * (node_position(3, node, sample.start) - ground) + ground;
    return x;
  };
  const VectorX x = turned(angle);
  const Stage stage{.base_positions = (4 * sample.start - turned(-angle)) / 3, .duration = 1};
  const CableFriction coarse(sample_cable(3), mu, 1e-3);
  const LaggedCableFriction friction(coarse, stage);
  for (const double tension : friction.tensions(x, {})) EXPECT_NEAR(tension, 5, 0.01);
}

TEST(CableFriction, HasNoneWhereNoTimePasses) {
  const CableFriction friction(sample_cable(3), mu, speed);
  EXPECT_EQ(friction.begin_stage(static_stage(VectorX::Zero(18))), nullptr);
}

}  // namespace
}  // namespace resilin::testing::cable_friction
