#include "resilin/optimize/path_follower.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "chain.hpp"

namespace resilin {
namespace {

using testing::Chain;

/// Von Mises' truss: two bars of length 1 m lean against each other at 20 degrees and are pressed down at the
/// top. It snaps through. With y the height of the top and l^2 = a^2 + y^2 its equilibria are
///   2 k (1 - 1 / l^2) y = -t P.
struct Truss final : LoadFamily {
  static constexpr double pressed = 20;  ///< P [N]; the truss carries 3.34 N before it snaps
  const double a = std::cos(std::numbers::pi / 9), top = std::sin(std::numbers::pi / 9);

  std::unique_ptr<Objective> at(double load) const override {
    VectorX force = VectorX::Zero(6);
    force[3] = -load * pressed;
    return std::make_unique<Chain>(3, force);
  }
  void place_fixed(double, VectorX& x) const override {
    x[0] = x[1] = x[5] = 0;
    x[4] = 2 * a;
  }
  VectorX rest() const { return VectorX{{0, 0, a, top, 2 * a, 0}}; }
  double load_at(double y) const { return -2 * Chain::stiffness * (1 - 1 / (a * a + y * y)) * y / pressed; }
  std::shared_ptr<const BlockPattern> pattern() const { return Chain(3, VectorX::Zero(6)).pattern(); }
};

const std::vector<std::uint8_t> supports_fixed = {1, 1, 0, 0, 1, 1};

std::vector<PathPoint> follow(const Truss& truss, double arc_length, std::vector<Index>* unstable = nullptr) {
  PathFollower follower(2, truss.pattern());
  ExactStiffness stiffness(2, truss.pattern());
  std::vector<PathPoint> path = {{truss.rest(), 0}};
  PathPoint point = path[0];
  const PathSettings settings{.tolerance = 1e-10, .arc_length = arc_length, .load_weight = 0.3};
  while (point.load < 1 && path.size() < 500) {
    const NewtonReport report =
        follower.advance(truss, supports_fixed, settings, path[path.size() > 1 ? path.size() - 2 : 0], point);
    EXPECT_TRUE(report.converged()) << report.reason;
    if (!report.converged()) break;
    path.push_back(point);
    if (unstable == nullptr) continue;
    unstable->push_back(
        stiffness.factorize(*truss.at(point.load), supports_fixed, point.positions).negative_pivots);
  }
  return path;
}

TEST(PathFollower, FollowsVonMisesTrussThroughBothLimitPoints) {
  const Truss truss;
  const std::vector<PathPoint> path = follow(truss, 0.05);
  EXPECT_GE(path.back().load, 1);
  EXPECT_LT(path.back().positions[3], -truss.top);  // the other side
  int num_turns = 0;
  double largest = 0, smallest = 1;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double y = path[i].positions[3];
    // The stopping rule leaves 1e-10 of the forces at the supports, which are three times the load.
    EXPECT_NEAR(path[i].load, truss.load_at(y), 1e-8) << "at height " << y;
    EXPECT_NEAR(path[i].positions[2], truss.a, 1e-9);
    if (i + 1 < path.size())
      num_turns += (path[i].load - path[i - 1].load) * (path[i + 1].load - path[i].load) < 0 ? 1 : 0;
    if (y > -truss.top) {
      largest = std::max(largest, path[i].load);
      smallest = std::min(smallest, path[i].load);
    }
  }
  EXPECT_EQ(num_turns, 2);
  // The limit load: d/dy of the formula above is zero at l^4 = a^2 - y^2.
  const double a2 = truss.a * truss.a;
  const double y_limit = std::sqrt((-(2 * a2 + 1) + std::sqrt(8 * a2 + 1)) / 2);
  EXPECT_NEAR(largest, truss.load_at(y_limit), 0.02 * truss.load_at(y_limit));  // the arc cuts the top
  EXPECT_NEAR(smallest, -truss.load_at(y_limit), 0.02 * truss.load_at(y_limit));
}

TEST(PathFollower, KeepsItsDistanceFromPointToPoint) {
  const Truss truss;
  const std::vector<PathPoint> path = follow(truss, 0.05);
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double du = (path[i].positions - path[i - 1].positions).norm();
    const double dt = 0.3 * (path[i].load - path[i - 1].load);
    EXPECT_NEAR(std::hypot(du, dt), 0.05, 0.05 * 1e-3);  // the constraint is met to the first order
  }
}

TEST(PathFollower, PassesOneUnstableModeBetweenTheLimitPoints) {
  const Truss truss;
  std::vector<Index> unstable;
  const std::vector<PathPoint> path = follow(truss, 0.02, &unstable);
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double y = path[i].positions[3], l2 = truss.a * truss.a + y * y;
    const bool is_between = l2 * l2 < truss.a * truss.a - y * y;
    EXPECT_EQ(unstable[i - 1], is_between ? 1 : 0) << "at height " << y;
  }
}

TEST(PathFollower, SettlesAtALoadThatIsGiven) {
  const Truss truss;
  PathFollower follower(2, truss.pattern());
  PathPoint point{truss.rest(), 0.04};
  EXPECT_TRUE(follower.settle(truss, supports_fixed, {.tolerance = 1e-12}, point).converged());
  EXPECT_NEAR(truss.load_at(point.positions[3]), 0.04, 1e-10);
}

}  // namespace
}  // namespace resilin
