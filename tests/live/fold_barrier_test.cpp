#include "resilin/live/fold_barrier.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <random>

#include "every_element.hpp"
#include "playground.hpp"
#include "resilin/world/world.hpp"

namespace resilin::testing {
namespace {

/// A unit block of one element, and the barrier of its cells.
struct EveryElementFoldBarrier : OnEveryElement {
  const World world{[this] {
    Description scene;
    scene.dimension = element.dim;
    scene.is_dynamic = true;
    BodyDescription body;
    body.mesh = block_for(element, Vector3::Ones(), 2);
    body.element = element.name;
    body.material.law = "stable_neo_hookean";
    scene.bodies.push_back(std::move(body));
    return scene;
  }()};
  const std::shared_ptr<const ElasticEnergy> elastic = world.bodies[0].domains.front().energy;
  FoldBarrier barrier{elastic, {3e5 /* Pa */}};

  /// Pressed to this part of its width, nodes moved by a hundredth of what is left of cells.
  VectorX pressed_to(double width) const {
    std::mt19937 random(4);
    std::normal_distribution<double> normal(0, 0.005 * std::abs(width));
    VectorX x = world.rest_positions;
    for (Eigen::Index i = 0; i < x.size(); ++i)
      x[i] = (i % element.dim == 0 ? width : 1) * x[i] + normal(random);
    return x;
  }
  static VectorX any_way(Eigen::Index size) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    VectorX p(size);
    for (double& value : p) value = normal(random);
    return p;
  }
  VectorX gradient(const VectorX& x) const {
    VectorX g = VectorX::Zero(x.size());
    barrier.add_gradient(x, {}, g);
    return g;
  }
  BlockMatrix hessian(const VectorX& x, Projection projection) const {
    BlockMatrix A(element.dim, world.pattern);
    barrier.add_hessian(x, {}, projection, A);
    EXPECT_TRUE(A.extra.empty()) << "its blocks are those of the cells";
    return A;
  }
  double least_ratio(const VectorX& x) const { return elastic->min_volume_ratio(x).ratio; }
};

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryElementFoldBarrier, ::testing::ValuesIn(elements()),
                         name_of_element);

TEST_P(EveryElementFoldBarrier, HasTheSlopesOfItsEnergy) {
  const VectorX x = pressed_to(0.05), p = any_way(x.size());
  ASSERT_GT(least_ratio(x), 0.02);
  const double h = 1e-7;  // J changes by less than a thousandth of itself: the error is h^2 times 1e8 of it
  const VectorX after = x + h * p, before = x - h * p, g = gradient(x);
  const double slope = g.dot(p);
  EXPECT_NEAR(barrier.difference(before, after, {}) / (2 * h), slope, 1e-4 * std::abs(slope));
  EXPECT_NEAR(barrier.difference(before, after, {}), barrier.value(after, {}) - barrier.value(before, {}),
              1e-12 * barrier.value(x, {}));
  VectorX column;
  multiply(hessian(x, Projection::none), p, column);
  EXPECT_LT(((gradient(after) - gradient(before)) / (2 * h) - column).norm(), 1e-4 * column.norm());
  VectorX magnitude = VectorX::Zero(x.size());
  barrier.add_gradient_magnitude(x, {}, magnitude);
  EXPECT_TRUE((magnitude.array() >= g.array().abs() * (1 - 1e-12)).all());
}

TEST_P(EveryElementFoldBarrier, IsConvexOnceProjected) {
  const VectorX x = pressed_to(0.05);
  for (const Projection projection : {Projection::clamp, Projection::absolute}) {
    const BlockMatrix A = hessian(x, projection);
    Eigen::MatrixXd dense(x.size(), x.size());
    VectorX column;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      multiply(A, VectorX::Unit(x.size(), i), column);
      dense.col(i) = column;
    }
    const VectorX values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
    EXPECT_GT(values.minCoeff(), -1e-12 * values.maxCoeff());
  }
}

TEST_P(EveryElementFoldBarrier, IsFeltBelowATenthOfTheVolumeOnly) {
  const VectorX roomy = pressed_to(0.2);
  EXPECT_EQ(barrier.value(roomy, {}), 0);
  EXPECT_EQ(gradient(roomy), VectorX::Zero(roomy.size()));
  EXPECT_GT(barrier.value(pressed_to(0.05), {}), 0);
  EXPECT_EQ(barrier.value(pressed_to(-0.05), {}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(barrier.difference(roomy, pressed_to(-0.05), {}), std::numeric_limits<double>::infinity());
  VectorX unknown = roomy;
  unknown[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(std::isfinite(barrier.value(unknown, {})));
}

TEST_P(EveryElementFoldBarrier, EndsStepsBeforeACellIsFlat) {
  for (const double width : {1.0, 0.05, 1e-6}) {
    const VectorX x = pressed_to(width), through = pressed_to(-0.5) - x;
    const double step = barrier.max_step(x, through, {});
    EXPECT_GT(step, 0);
    EXPECT_LT(step, 1);
    EXPECT_GE(least_ratio(x + step * through), 0.099 * least_ratio(x)) << width;
    EXPECT_EQ(barrier.max_step(x, world.rest_positions - x, {}), 1) << "away from it";
  }
}

TEST_P(EveryElementFoldBarrier, RestsFromAFoldUntilAllCellsHaveRoom) {
  const VectorX folded = pressed_to(-0.5), flat = pressed_to(0.05);
  barrier.look_at(flat);
  EXPECT_FALSE(barrier.is_resting());
  barrier.look_at(folded);
  EXPECT_TRUE(barrier.is_resting());
  EXPECT_EQ(barrier.max_step(folded, flat - folded, {}), 1);
  barrier.look_at(flat);
  EXPECT_TRUE(barrier.is_resting());
  EXPECT_EQ(barrier.value(flat, {}), 0);
  EXPECT_EQ(gradient(flat), VectorX::Zero(flat.size()));
  barrier.look_at(pressed_to(0.3));
  EXPECT_FALSE(barrier.is_resting());
  EXPECT_GT(barrier.value(flat, {}), 0);
}

TEST_P(EveryElementFoldBarrier, IsTheSameForAStageThatKeepsWhatItFinds) {
  const auto own = barrier.begin_stage({});
  const auto expect_same_at = [&](const VectorX& x) {
    EXPECT_EQ(own->value(x, {}), barrier.value(x, {}));
    VectorX g = VectorX::Zero(x.size());
    own->add_gradient(x, {}, g);
    EXPECT_EQ(g, gradient(x));
  };
  const VectorX start = pressed_to(0.2), p = pressed_to(0.05) - start;
  EXPECT_EQ(own->max_step(start, p, {}), barrier.max_step(start, p, {}));
  for (const double t : {0.0, 0.3, 0.9, 1.0, 1.1}) expect_same_at(start + t * p);
  expect_same_at(pressed_to(0.06));
  barrier.look_at(start + p);
  expect_same_at(start + p);
}

/// A block on a held foot is thrown down flat and springs back: cells that were never inside out are not
/// damped.
struct FlatCellsInMotion : OnEveryElement {};

TEST_P(FlatCellsInMotion, KeepTheirPace) {
  Description scene;
  scene.dimension = element.dim;
  scene.is_dynamic = true;
  scene.time_step = 1e-4;
  BodyDescription body;
  body.mesh = block_for(element, Vector3::Constant(0.4), element.degree == 2 ? 1 : 2);
  body.element = element.name;
  body.material.law = "stable_neo_hookean";
  body.material.constants = {{"youngs_modulus", 1e4}, {"poissons_ratio", 0.3}};
  scene.bodies.push_back(std::move(body));
  FixDescription foot;
  foot.name = "foot";
  foot.where.kind = Where::Kind::plane;
  foot.where.axis = element.dim - 1;
  foot.where.at = 0;
  scene.fixes.push_back(foot);
  LiveScene live(scene);
  VectorX velocities = VectorX::Zero(live.state().positions.size());
  for (Eigen::Index i = element.dim - 1; i < velocities.size(); i += element.dim)
    velocities[i] = -20 /* 1/s */ * live.world().rest_positions[i];
  live.place(live.state().positions, velocities);
  double before = 0, flattest = 1, ratio = 0;
  for (int i = 0; i < 5000 && !(flattest < FoldBarrier::activation_ratio && ratio > 0.5); ++i) {
    const LiveReport& report = live.step(unhurried);
    if (i == 0) before = report.kinetic_energy + report.elastic_energy;
    ratio = report.min_volume_ratio;
    flattest = std::min(flattest, ratio);
    ASSERT_EQ(report.inverted_cells, 0);
    ASSERT_EQ(report.words.find("damped"), std::string::npos) << report.words;
  }
  EXPECT_LT(flattest, FoldBarrier::activation_ratio) << "too calm to show anything";
  EXPECT_GT(ratio, 0.5) << "it has not sprung back";
  // Backward Euler takes a third, waves as short as cells; longer steps would take nearly all.
  EXPECT_GT(live.report().kinetic_energy + live.report().elastic_energy, 0.5 * before);
}
INSTANTIATE_TEST_SUITE_P(Catalogue, FlatCellsInMotion, ::testing::ValuesIn(elements()), name_of_element);

}  // namespace
}  // namespace resilin::testing
