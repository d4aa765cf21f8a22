#include "resilin/optimize/true_tangent.hpp"

#include <cmath>
#include <vector>

#include "resilin/optimize/residual.hpp"

namespace resilin {
namespace {

constexpr int most_iterations = 30;

/// J p by a central difference that moves no node farther than 1e-8 of the body's extent: far less than gaps.
void multiply_tangent(const Objective& objective, std::span<const std::uint8_t> is_fixed,
                      const ProcessGroup& share, const VectorX& x, const VectorX& p, VectorX& product) {
  const double extent = share.largest(x.maxCoeff()) - share.smallest(x.minCoeff());
  const double length = 1e-8 * extent / share.largest(p.cwiseAbs().maxCoeff());
  VectorX before;
  objective.gradient(x + length * p, product);
  objective.gradient(x - length * p, before);
  product = (product - before) / (2 * length);
  set_fixed_to_zero(is_fixed, product);
}

/// The rotation that takes (a, b) to (r, 0).
struct Givens {
  double c = 1, s = 0;

  static Givens of(double a, double b) {
    const double r = std::hypot(a, b);
    return r > 0 ? Givens{a / r, b / r} : Givens{};
  }
  void turn(double& a, double& b) const {
    const double turned = c * a + s * b;
    b = c * b - s * a;
    a = turned;
  }
};

}  // namespace

TangentReport solve_with_true_tangent(const Objective& objective, std::span<const std::uint8_t> is_fixed,
                                      const ProcessGroup& share, const VectorX& x, const VectorX& b,
                                      const NearSolve& near, double tolerance, VectorX& p) {
  TangentReport report;
  p.setZero(b.size());
  const double size = share.norm(b);
  if (size == 0) return {0, 0};
  std::vector<VectorX> basis = {b / size}, corrections;
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(most_iterations + 1, most_iterations);
  Eigen::VectorXd rest = Eigen::VectorXd::Zero(most_iterations + 1);
  rest[0] = size;
  std::vector<Givens> rotations;
  while (report.iterations < most_iterations && report.relative_residual > tolerance) {
    const int k = report.iterations;
    VectorX correction, next;
    if (!near(basis.back(), correction) || !(share.norm(correction) > 0)) break;
    multiply_tangent(objective, is_fixed, share, x, correction, next);
    if (!share.all(next.allFinite())) break;
    corrections.push_back(std::move(correction));
    for (int i = 0; i <= k; ++i) {
      R(i, k) = share.dot(basis[static_cast<std::size_t>(i)], next);
      next -= R(i, k) * basis[static_cast<std::size_t>(i)];
    }
    const double left = share.norm(next);
    R(k + 1, k) = left;
    for (int i = 0; i < k; ++i) rotations[static_cast<std::size_t>(i)].turn(R(i, k), R(i + 1, k));
    rotations.push_back(Givens::of(R(k, k), R(k + 1, k)));
    rotations.back().turn(R(k, k), R(k + 1, k));
    rotations.back().turn(rest[k], rest[k + 1]);
    ++report.iterations;
    report.relative_residual = std::abs(rest[k + 1]) / size;
    if (!(left > 0)) break;
    basis.push_back(next / left);
  }
  const int n = report.iterations;
  if (n == 0) return report;
  const Eigen::VectorXd y = R.topLeftCorner(n, n).triangularView<Eigen::Upper>().solve(rest.head(n));
  for (int i = 0; i < n; ++i) p += y[i] * corrections[static_cast<std::size_t>(i)];
  if (!share.all(p.allFinite())) report.relative_residual = 1;
  return report;
}

}  // namespace resilin
