#include "resilin/linear/gmres.hpp"

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
  Eigen::VectorXd y;
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
    const Eigen::MatrixXd square = H.topLeftCorner(k + 2, k + 1);
    const Eigen::VectorXd first = size * Eigen::VectorXd::Unit(k + 2, 0);
    y = dense::least_squares(square, first);
    report.left = (first - square * y).norm() / size;
    if (!(H(k + 1, k) > 1e-14 * square.norm())) break;
    basis.push_back(next / H(k + 1, k));
  }
  const std::vector<VectorX>& directions = precondition ? corrections : basis;
  for (Eigen::Index i = 0; i < y.size(); ++i) report.x += y[i] * directions[static_cast<std::size_t>(i)];
  return report;
}

}  // namespace resilin
