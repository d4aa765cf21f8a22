#include "resilin/linear/gmres.hpp"

#include <Eigen/Jacobi>
#include <cmath>
#include <vector>

#include "resilin/core/dense.hpp"

namespace resilin {

GmresReport gmres(const std::function<VectorX(const VectorX&)>& product, const VectorX& b, double tolerance,
                  int most, const std::function<VectorX(const VectorX&)>& precondition) {
  GmresReport report{.x = VectorX::Zero(b.size())};
  const double size = b.norm();
  if (!(size > 0)) {
    report.left = size;  // not a number stays one
    return report;
  }
  std::vector<VectorX> basis = {b / size}, corrections;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(most + 1, most);
  // Rotations make H triangular, column by column; what they make of |b| e_1 ends in the residual.
  std::vector<Eigen::JacobiRotation<double>> rotations;
  double square_size = 0;
  report.left = 1;
  for (int k = 0; k < most && !(report.left <= tolerance); ++k) {
    if (precondition) corrections.push_back(precondition(basis.back()));
    VectorX next = product(precondition ? corrections.back() : basis.back());
    ++report.products;
    for (int twice = 0; twice < 2; ++twice)
      for (int i = 0; i <= k; ++i) {
        const double part = basis[static_cast<std::size_t>(i)].dot(next);
        H(i, k) += part;
        next -= part * basis[static_cast<std::size_t>(i)];
      }
    H(k + 1, k) = next.norm();
    Eigen::VectorXd column = H.col(k).head(k + 2);
    square_size += column.squaredNorm();
    for (int i = 0; i < k; ++i)
      column.applyOnTheLeft(i, i + 1, rotations[static_cast<std::size_t>(i)].adjoint());
    rotations.emplace_back().makeGivens(column[k], column[k + 1]);
    report.left *= std::abs(rotations.back().s());
    if (!(H(k + 1, k) > 1e-14 * std::sqrt(square_size))) break;
    basis.push_back(next / H(k + 1, k));
  }
  const int n = report.products;
  const Eigen::VectorXd y =
      dense::least_squares(H.topLeftCorner(n + 1, n), size * Eigen::VectorXd::Unit(n + 1, 0));
  const std::vector<VectorX>& directions = precondition ? corrections : basis;
  for (Eigen::Index i = 0; i < y.size(); ++i) report.x += y[i] * directions[static_cast<std::size_t>(i)];
  return report;
}

}  // namespace resilin
