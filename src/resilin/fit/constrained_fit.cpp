#include "resilin/fit/constrained_fit.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/dense.hpp"
#include "resilin/fit/inequalities.hpp"

namespace resilin {
namespace {

/// The least stiffness that counts as stable, in units of the problem: of a modulus that the data show.
constexpr double least_stiffness = 1e-7;
constexpr double difference_step = 1e-5;  ///< difference step of z; stiffness is linear in c
constexpr int most_bounded_iterations = 300;
constexpr double limit_tolerance = 1e-9;  ///< tolerance of a limit

/// Conditions values >= 0, linearised: values + slopes * change >= 0, by (c, z).
struct LinearisedLimits {
  VectorX values;
  DenseMatrix slopes;
  Eigen::Index num_stability = 0;  ///< rows that come first
};

/// The unknowns of a problem in one vector.
class Unknowns {
 public:
  explicit Unknowns(const LawProblem& problem) : num_linear_(problem.num_linear()) {}
  VectorX joined(const VectorX& c, const VectorX& z) const {
    VectorX all(c.size() + z.size());
    all << c, z;
    return all;
  }
  VectorX c(const VectorX& all) const { return all.head(num_linear_); }
  VectorX z(const VectorX& all) const { return all.tail(all.size() - num_linear_); }

 private:
  Eigen::Index num_linear_;
};

class BoundedSearch {
 public:
  BoundedSearch(const LawProblem& problem, const FitLimits& limits, const FitPoint& start)
      : problem_(problem),
        limits_(limits),
        unknowns_(problem),
        x_(clamped(unknowns_.joined(start.c, start.z))) {}

  bool run(BoundedPoint& point) {
    VectorX r;
    if (!problem_.residuals(unknowns_.c(x_), unknowns_.z(x_), r, nullptr)) return false;
    sum_ = r.squaredNorm();
    if (!std::isfinite(sum_)) return false;
    for (point.iterations = 1; point.iterations <= most_bounded_iterations; ++point.iterations)
      if (!step()) break;
    point.c = unknowns_.c(x_);
    point.z = unknowns_.z(x_);
    point.sum = sum_;
    point.is_converged = point.iterations <= most_bounded_iterations;
    return has_limits() && tell_reached(point);
  }

 private:
  VectorX lower() const { return unknowns_.joined(problem_.linear_lower(), problem_.lower()); }
  VectorX upper() const { return unknowns_.joined(problem_.linear_upper(), problem_.upper()); }
  VectorX clamped(const VectorX& x) const { return x.cwiseMax(lower()).cwiseMin(upper()); }

  std::vector<DenseMatrix> hessians(const VectorX& x) const {
    const std::vector<double> constants = problem_.scaled_constants(unknowns_.c(x), unknowns_.z(x));
    return stability_hessians(*problem_.choice().law, problem_.choice().is_compressible, constants,
                              limits_.stable_states);
  }

  double violation(const VectorX& x) const {
    double sum = 0;
    if (!limits_.stable_states.empty())
      for (const DenseMatrix& hessian : hessians(x))
        sum += std::max(0.0, least_stiffness - smallest_stiffness(hessian));
    return sum;
  }

  /// The conditions at x_; false where the law has no state.
  bool has_limits() {
    const Eigen::Index n = x_.size();
    std::vector<VectorX> rows;
    std::vector<double> values;
    if (!limits_.stable_states.empty() && !add_stability(rows, values)) return false;
    const auto num_stability = static_cast<Eigen::Index>(rows.size());
    for (Eigen::Index i = 0; i < n; ++i)
      for (const double sign : {1.0, -1.0}) {
        const double bound = sign > 0 ? lower()[i] : upper()[i];
        if (!std::isfinite(bound)) continue;
        rows.push_back(sign * VectorX::Unit(n, i));
        values.push_back(sign * (x_[i] - bound));
      }
    limits_here_.values = Eigen::Map<const VectorX>(values.data(), static_cast<Eigen::Index>(values.size()));
    limits_here_.slopes.resize(limits_here_.values.size(), n);
    for (std::size_t k = 0; k < rows.size(); ++k)
      limits_here_.slopes.row(static_cast<Eigen::Index>(k)) = rows[k].transpose();
    limits_here_.num_stability = num_stability;
    return true;
  }

  /// v^T H v for the eigenvectors v of each Hessian at x_: their slopes are those of the eigenvalues.
  bool add_stability(std::vector<VectorX>& rows, std::vector<double>& values) const {
    const std::vector<DenseMatrix> here = hessians(x_);
    std::vector<std::vector<DenseMatrix>> slopes;
    for (Eigen::Index i = 0; i < x_.size(); ++i) {
      const double h = i < problem_.num_linear() ? std::max(1.0, std::abs(x_[i])) : difference_step;
      const VectorX step = h * VectorX::Unit(x_.size(), i);
      std::vector<DenseMatrix> more = hessians(x_ + step), less = hessians(x_ - step);
      for (std::size_t k = 0; k < here.size(); ++k) more[k] = (more[k] - less[k]) / (2 * h);
      slopes.push_back(std::move(more));
    }
    for (std::size_t k = 0; k < here.size(); ++k) {
      if (!here[k].allFinite()) return false;
      const dense::Eigenpairs pairs = dense::symmetric_eigenpairs(here[k]);
      for (Eigen::Index a = 0; a < pairs.values.size(); ++a) {
        const VectorX v = pairs.vectors.col(a);
        VectorX row(x_.size());
        for (Eigen::Index i = 0; i < x_.size(); ++i)
          row[i] = v.dot(slopes[static_cast<std::size_t>(i)][k] * v);
        if (!row.allFinite()) return false;
        rows.push_back(row);
        values.push_back(pairs.values[a] - least_stiffness);
      }
    }
    return true;
  }

  /// One accepted step; false when there is none that helps.
  bool step() {
    VectorX r;
    DenseMatrix J;
    if (!problem_.residuals(unknowns_.c(x_), unknowns_.z(x_), r, &J) || !has_limits()) return false;
    const Eigen::Index n = x_.size(), rows = J.rows();
    scale_ = scale_.size() == 0 ? VectorX(J.colwise().norm()) : scale_.cwiseMax(VectorX(J.colwise().norm()));
    DenseMatrix damped(rows + n, n);
    damped.topRows(rows) = J;
    VectorX right = VectorX::Zero(rows + n);
    right.head(rows) = -r;
    const double violated = violation(x_);
    for (; damping_ < 1e12; damping_ *= 4) {
      damped.bottomRows(n) = (std::sqrt(damping_) * scale_.cwiseMax(1e-12)).asDiagonal().toDenseMatrix();
      BoundedStep move;
      if (!least_squares_with_inequalities(damped, right, limits_here_.slopes, -limits_here_.values, move))
        return false;
      if (move.multipliers.size() > 0) price_ = std::max(price_, 2 * move.multipliers.maxCoeff());
      const VectorX x = clamped(x_ + move.x);
      VectorX next;
      if (!problem_.residuals(unknowns_.c(x), unknowns_.z(x), next, nullptr)) continue;
      const double sum = next.squaredNorm(), missed = violation(x);
      const double merit = 0.5 * sum_ + price_ * violated, merit_there = 0.5 * sum + price_ * missed;
      if (!(merit_there < merit)) continue;
      const bool is_over = merit - merit_there <= 1e-14 * merit;
      x_ = x;
      sum_ = sum;
      damping_ = std::max(1e-12, damping_ / 8);
      return !is_over;
    }
    return false;
  }

  /// Whether the limits are kept, and which are reached.
  bool tell_reached(BoundedPoint& point) const {
    std::vector<Eigen::Index> reached;
    const Eigen::Index num_stability = limits_here_.num_stability;
    for (Eigen::Index k = 0; k < limits_here_.values.size(); ++k) {
      if (limits_here_.values[k] < -limit_tolerance) return false;
      if (limits_here_.values[k] > 1e-7) continue;
      reached.push_back(k);
      (k < num_stability ? point.is_held_by_stability : point.is_held_by_range) = true;
    }
    point.reached.resize(static_cast<Eigen::Index>(reached.size()), x_.size());
    for (std::size_t k = 0; k < reached.size(); ++k)
      point.reached.row(static_cast<Eigen::Index>(k)) = limits_here_.slopes.row(reached[k]);
    return true;
  }

  const LawProblem& problem_;
  const FitLimits& limits_;
  Unknowns unknowns_;
  VectorX x_, scale_;
  LinearisedLimits limits_here_;
  double sum_ = 0, damping_ = 1e-4, price_ = 0;
};

}  // namespace

bool keeps_limits(const LawProblem& problem, const FitLimits& limits, const FitPoint& point) {
  if ((point.c.array() < problem.linear_lower().array()).any() ||
      (point.c.array() > problem.linear_upper().array()).any())
    return false;
  // A number that must be above a limit may not be equal to it.
  const LawInfo& law = *problem.choice().law;
  for (Eigen::Index i = 0; i < point.c.size(); ++i)
    if (!(point.c[i] >
          law.constants[static_cast<std::size_t>(problem.choice().linear[static_cast<std::size_t>(i)])]
              .above))
      return false;
  if (limits.stable_states.empty()) return true;
  const std::vector<double> constants = problem.scaled_constants(point.c, point.z);
  const std::vector<DenseMatrix> hessians =
      stability_hessians(law, problem.choice().is_compressible, constants, limits.stable_states);
  return std::ranges::all_of(hessians,
                             [](const DenseMatrix& hessian) { return smallest_stiffness(hessian) > 0; });
}

bool fit_within_limits(const LawProblem& problem, const FitLimits& limits, const FitPoint& start,
                       BoundedPoint& point) {
  return BoundedSearch(problem, limits, start).run(point);
}

}  // namespace resilin
