#include "resilin/energy/hand.hpp"

#include <gtest/gtest.h>

namespace resilin::testing {
namespace {

const MaterialPoint place = {.nodes = {0, 2, 3}, .weights = {0.2, 0.5, 0.3}};
const Vector3 target(0.3, -0.2, 0.9);

VectorX nodes_with_place_at(double distance) {
  VectorX x(12);
  x << 0.1, 0.2, 0.3, 5, 6, 7, -0.4, 0.2, 0.1, 0.8, -0.3, 0.2;
  const Vector3 y = place.position(3, x);
  const Vector3 shift = target + distance * Vector3(1, 2, -2) / 3 - y;
  for (int node = 0; node < 4; ++node) x.segment(3 * node, 3) += shift;
  return x;
}

/// k = 100 N/m and at most 30 N: the spring yields 0.3 m from the target.
const Hand hand(3, place, target, 100, 30);

TEST(Hand, NeverPullsHarderThanItIsTold) {
  EXPECT_NEAR(hand.force(nodes_with_place_at(0.1)).norm(), 10, 1e-12);
  EXPECT_NEAR(hand.force(nodes_with_place_at(0.3)).norm(), 30, 1e-12);
  EXPECT_NEAR(hand.force(nodes_with_place_at(50)).norm(), 30, 1e-11);
}

TEST(Hand, HasTheSlopesOfItsEnergyOnBothSidesOfTheYield) {
  for (const double distance : {0.1, 0.29, 0.31, 2.0}) {
    const VectorX x = nodes_with_place_at(distance);
    VectorX gradient = VectorX::Zero(12);
    hand.add_gradient(x, {}, gradient);
    BlockPatternBuilder builder(4);
    const std::vector<Index> cell = {0, 1, 2, 3};
    builder.add_cells(cell, 4);
    BlockMatrix hessian(3, std::make_shared<const BlockPattern>(builder.build()));
    hessian.set_zero();
    hand.add_hessian(x, {}, Projection::none, hessian);
    const double h = 1e-5;  // error h^2 times third derivatives of order 1e3
    for (Eigen::Index i = 0; i < 12; ++i) {
      VectorX after = x, before = x;
      after[i] += h;
      before[i] -= h;
      EXPECT_NEAR(hand.difference(before, after, {}) / (2 * h), gradient[i], 1e-6);
      EXPECT_NEAR((hand.value(after, {}) - hand.value(before, {})) / (2 * h), gradient[i], 1e-6);
      VectorX slope_after = VectorX::Zero(12), slope_before = slope_after, column;
      hand.add_gradient(after, {}, slope_after);
      hand.add_gradient(before, {}, slope_before);
      multiply(hessian, VectorX::Unit(12, i), column);
      EXPECT_LT(((slope_after - slope_before) / (2 * h) - column).norm(), 1e-5) << distance;
    }
  }
}

TEST(Hand, DifferenceAcrossTheYieldIsThatOfTheValues) {
  const VectorX near = nodes_with_place_at(0.2), far = nodes_with_place_at(0.7);
  EXPECT_NEAR(hand.difference(near, far, {}), hand.value(far, {}) - hand.value(near, {}), 1e-12);
  EXPECT_NEAR(hand.difference(far, near, {}), hand.value(near, {}) - hand.value(far, {}), 1e-12);
}

}  // namespace
}  // namespace resilin::testing
