#include "resilin/fit/inequalities.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "resilin/core/dense.hpp"

namespace resilin {
namespace {

/// The least-squares solution over the columns in `passive`, zero elsewhere.
VectorX solve_over(const DenseMatrix& E, const VectorX& f, const std::vector<Eigen::Index>& passive) {
  DenseMatrix columns(E.rows(), static_cast<Eigen::Index>(passive.size()));
  for (std::size_t i = 0; i < passive.size(); ++i)
    columns.col(static_cast<Eigen::Index>(i)) = E.col(passive[i]);
  const VectorX some = dense::least_squares(columns, f);
  VectorX all = VectorX::Zero(E.cols());
  for (std::size_t i = 0; i < passive.size(); ++i) all[passive[i]] = some[static_cast<Eigen::Index>(i)];
  return all;
}

}  // namespace

VectorX nonnegative_least_squares(const DenseMatrix& E, const VectorX& f) {
  constexpr double round_off = 64 * std::numeric_limits<double>::epsilon();
  const Eigen::Index n = E.cols();
  VectorX u = VectorX::Zero(n);
  std::vector<Eigen::Index> passive;
  const VectorX norms = E.colwise().norm();
  for (Eigen::Index pass = 0; pass < 3 * n + 10; ++pass) {
    const VectorX left = f - E * u, pull = E.transpose() * left;
    Eigen::Index best = -1;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (std::ranges::find(passive, i) != passive.end() || norms[i] == 0) continue;
      if (pull[i] / norms[i] > round_off * f.norm() &&
          (best < 0 || pull[i] / norms[i] > pull[best] / norms[best]))
        best = i;
    }
    if (best < 0 || static_cast<Eigen::Index>(passive.size()) >= E.rows()) break;
    passive.push_back(best);
    VectorX next = solve_over(E, f, passive);
    if (!(next[best] > 0)) break;  // its pull is round-off
    while (!passive.empty()) {
      double part = 1;
      for (const Eigen::Index i : passive)
        if (next[i] <= 0) part = std::min(part, u[i] / (u[i] - next[i]));
      if (std::ranges::none_of(passive, [&](Eigen::Index i) { return next[i] <= 0; })) break;
      u += part * (next - u);
      std::erase_if(passive, [&](Eigen::Index i) {
        const bool is_out = next[i] <= 0 && u[i] <= round_off * u.maxCoeff();
        if (is_out) u[i] = 0;
        return is_out;
      });
      next = solve_over(E, f, passive);
    }
    u = next;
  }
  return u;
}

bool least_squares_with_inequalities(const DenseMatrix& A, const VectorX& b, const DenseMatrix& G,
                                     const VectorX& h, BoundedStep& step) {
  const Eigen::Index n = A.cols(), m = G.rows();
  const dense::Reflections factors = dense::reflections(A);
  const DenseMatrix R = dense::upper_triangle(factors);
  const VectorX free = dense::transposed_times(factors, b).topRows(n);
  step.multipliers = VectorX::Zero(m);
  VectorX shift = VectorX::Zero(n);  // shift of R x
  if (m > 0) {
    // With y = R x - Q^T b: min |y|, G R^-1 y >= h - G R^-1 Q^T b.
    const DenseMatrix GR = dense::solve_upper_transposed(R, G.transpose()).transpose();
    const VectorX bound = h - GR * free;
    DenseMatrix E(n + 1, m);
    E.topRows(n) = GR.transpose();
    E.row(n) = bound.transpose();
    // Rows of very unequal size stand for the same condition.
    VectorX size(m);
    for (Eigen::Index i = 0; i < m; ++i) {
      size[i] = std::max(GR.row(i).norm(), 1e-300);
      E.col(i) /= size[i];
    }
    VectorX f = VectorX::Zero(n + 1);
    f[n] = 1;
    const VectorX u = nonnegative_least_squares(E, f);
    const VectorX left = E * u - f;
    if (!(-left[n] > 1e-12)) return false;
    shift = -left.head(n) / left[n];
    step.multipliers = (-u / left[n]).cwiseQuotient(size);
  }
  step.x = dense::solve_upper(R, free + shift);
  return step.x.allFinite();
}

}  // namespace resilin
