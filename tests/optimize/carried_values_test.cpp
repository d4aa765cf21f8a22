#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <vector>

#include "resilin/optimize/newton.hpp"

namespace resilin {
namespace {

/// A point in the plane that is drawn to a place and held near the curve x y = 1 by a large bulk modulus:
///
///   E = k/2 |x - a|^2 + K/2 (x y - 1)^2,   with the pressure p = K (x y - 1) as internal value.
///
/// The Hessian on carried pressures leads whole steps along the curve, which raise the energy at first.
class NearlyIncompressible final : public Objective {
 public:
  explicit NearlyIncompressible(bool carries_pressure) : carries_pressure_(carries_pressure) {}

  double energy(const VectorX& x) const {
    return 0.5 * (x - attractor).squaredNorm() + 0.5 * bulk * volume(x) * volume(x);
  }
  double difference(const VectorX& from, const VectorX& to) const override {
    return energy(to) - energy(from);
  }
  double magnitude(const VectorX& x) const override { return energy(x); }
  void gradient(const VectorX& x, VectorX& g) const override {
    g = x - attractor + bulk * volume(x) * volume_slope(x);
  }
  void gradient_magnitude(const VectorX& x, VectorX& m) const override {
    m = (x - attractor).cwiseAbs() + bulk * std::abs(volume(x)) * volume_slope(x).cwiseAbs();
  }
  void hessian(const VectorX& x, Projection projection, BlockMatrix& H) const override {
    hessian_at({}, x, projection, H);
  }
  VectorX internal_values(const VectorX& x) const override {
    return carries_pressure_ ? VectorX::Constant(1, bulk * volume(x)) : VectorX();
  }
  VectorX predicted_internal_values(const VectorX& x, const VectorX& p, double t) const override {
    return internal_values(x).array() + t * bulk * volume_slope(x).dot(p);
  }
  void hessian_at(const VectorX& internal, const VectorX& x, Projection projection,
                  BlockMatrix& H) const override {
    const double pressure = internal.size() > 0 ? internal[0] : bulk * volume(x);
    Eigen::Matrix2d block =
        Eigen::Matrix2d::Identity() + bulk * volume_slope(x) * volume_slope(x).transpose();
    block(0, 1) += pressure;
    block(1, 0) += pressure;
    if (projection != Projection::none) {
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(block);
      Eigen::Vector2d values = eigen.eigenvalues().cwiseAbs();
      if (projection == Projection::clamp) values = eigen.eigenvalues().cwiseMax(1e-6);
      block = eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
    }
    H.add_block(0, 0, block.data());
  }
  double max_step(const VectorX&, const VectorX&) const override { return 1; }
  VectorX force_scales(const VectorX&, const VectorX&, const ConnectedComponents&) const override {
    return VectorX::Constant(1, attractor.norm());
  }
  VectorX distinct_acting_scales(const VectorX&, const VectorX&, const ConnectedComponents&) const override {
    return VectorX::Constant(1, attractor.norm());
  }
  void follow(const VectorX& x, const VectorX& p, double t) override {
    if (energies.empty()) energies.push_back(energy(x));
    energies.push_back(energy(x + t * p));
  }

  std::vector<double> energies{};  ///< where the search has been

 private:
  static constexpr double bulk = 1e5;
  const Eigen::Vector2d attractor{2, 0.4};

  static double volume(const VectorX& x) { return x[0] * x[1] - 1; }
  static Eigen::Vector2d volume_slope(const VectorX& x) { return {x[1], x[0]}; }

  bool carries_pressure_;
};

struct Found {
  NewtonReport report;
  VectorX x;
  std::vector<double> energies;
};

Found found(bool carries_pressure, int relaxed_steps, int max_iterations = 1000) {
  NearlyIncompressible objective(carries_pressure);
  Newton newton(2, std::make_shared<const BlockPattern>(BlockPatternBuilder(1).build()),
                make_linear_solver({.kind = "ldlt"}, 2));
  VectorX x = Eigen::Vector2d(1, 1);
  const std::vector<std::uint8_t> is_fixed(2, 0);
  const NewtonReport report = newton.minimize(
      objective, is_fixed, x, {.max_iterations = max_iterations, .relaxed_steps = relaxed_steps}, x);
  return {report, x, objective.energies};
}

/// The longest row of places whose energy is above the lowest one before.
int longest_rise(const std::vector<double>& energies) {
  int longest = 0, now = 0;
  double lowest = energies.front();
  for (std::size_t i = 1; i < energies.size(); ++i) {
    now = energies[i] > lowest * (1 + 1e-12) ? now + 1 : 0;
    lowest = std::min(lowest, energies[i]);
    longest = std::max(longest, now);
  }
  return longest;
}

TEST(CarriedValues, LeadToTheSameMinimumInFarFewerIterations) {
  const Found plain = found(false, 0), carried = found(true, 5);
  ASSERT_TRUE(plain.report.converged()) << plain.report.reason;
  ASSERT_TRUE(carried.report.converged()) << carried.report.reason;
  EXPECT_LT((carried.x - plain.x).norm(), 1e-6);
  EXPECT_LT(2 * carried.report.iterations, plain.report.iterations);
}

TEST(Watchdog, LetsOnlySoManyStepsInARowStayAboveTheLowestEnergy) {
  EXPECT_EQ(longest_rise(found(true, 0).energies), 0);
  for (const int relaxed_steps : {1, 2, 5}) {
    const Found by = found(true, relaxed_steps);
    ASSERT_TRUE(by.report.converged()) << by.report.reason;
    EXPECT_GT(longest_rise(by.energies), 0);
    EXPECT_LE(longest_rise(by.energies), relaxed_steps);
    EXPECT_LT((by.x - found(false, 0).x).norm(), 1e-6);
  }
}

TEST(Watchdog, EndsWhereTheEnergyWasLowest) {
  const Found cut = found(true, 5, /*max_iterations=*/1);
  EXPECT_EQ(cut.report.status, NewtonReport::Status::max_iterations);
  ASSERT_EQ(cut.energies.size(), 2U);
  EXPECT_GT(cut.energies[1], cut.energies[0]) << "the step along the curve has raised it";
  EXPECT_EQ(cut.x, VectorX(Eigen::Vector2d(1, 1)));
}

}  // namespace
}  // namespace resilin
