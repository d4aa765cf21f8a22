#include "resilin/fit/separable_fit.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/dense.hpp"

namespace resilin {
namespace {

constexpr double rank_tolerance = 1e-9;
constexpr int most_iterations = 400;
constexpr std::size_t most_searches = 12;

/// A point of the search in z, with c eliminated.
struct ProjectedPoint {
  VectorX z;
  LinearSolution linear;
  double sum = 0;
};

bool project(const LawProblem& problem, const VectorX& z, ProjectedPoint& point) {
  DenseMatrix A;
  VectorX y;
  if (!problem.linear_part(z, A, y) || !A.allFinite() || !y.allFinite()) return false;
  point.z = z;
  point.linear = solve_linear(A, y);
  point.sum = point.linear.left.squaredNorm();
  return std::isfinite(point.sum);
}

/// Moves in z by Levenberg and Marquardt's steps; Nielsen's rule for the damping.
class ProjectedSearch {
 public:
  ProjectedSearch(const LawProblem& problem, ProjectedPoint start)
      : problem_(problem), now_(std::move(start)), scale_(VectorX::Zero(problem.num_nonlinear())) {}

  FitPoint run() {
    FitPoint end;
    while (end.iterations < most_iterations && !end.is_converged) {
      ++end.iterations;
      end.is_converged = !linearise() || !step();
    }
    end.c = now_.linear.c;
    end.z = now_.z;
    end.sum = now_.sum;
    return end;
  }

 private:
  /// The slopes that no c makes up for; false when the gradient is lost in round-off.
  bool linearise() {
    DenseMatrix B;
    if (!problem_.nonlinear_slopes(now_.linear.c, now_.z, B)) return false;
    slopes_ = B - now_.linear.basis * (now_.linear.basis.transpose() * B);
    gradient_ = slopes_.transpose() * now_.linear.left;
    // At a limit a number does not move outwards.
    for (Eigen::Index i = 0; i < gradient_.size(); ++i) {
      const bool is_at_lower = now_.z[i] <= problem_.lower()[i] && gradient_[i] < 0;
      const bool is_at_upper = now_.z[i] >= problem_.upper()[i] && gradient_[i] > 0;
      if (!is_at_lower && !is_at_upper) continue;
      slopes_.col(i).setZero();
      gradient_[i] = 0;
    }
    const VectorX norms = slopes_.colwise().norm();
    scale_ = scale_.cwiseMax(norms);
    const double size = std::sqrt(now_.sum);
    for (Eigen::Index i = 0; i < gradient_.size(); ++i)
      if (std::abs(gradient_[i]) > 1e-13 * norms[i] * size) return true;
    return false;
  }

  /// False when no step lowers the sum.
  bool step() {
    const Eigen::Index n = slopes_.cols(), rows = slopes_.rows();
    DenseMatrix damped(rows + n, n);
    damped.topRows(rows) = slopes_;
    VectorX right = VectorX::Zero(rows + n);
    right.head(rows) = now_.linear.left;
    for (; damping_ < 1e14; damping_ *= growth_, growth_ *= 2) {
      damped.bottomRows(n) = (std::sqrt(damping_) * scale_.cwiseMax(1e-300)).asDiagonal().toDenseMatrix();
      const VectorX change = dense::least_squares(damped, right);
      const VectorX z = (now_.z + change).cwiseMax(problem_.lower()).cwiseMin(problem_.upper());
      ProjectedPoint next;
      if (!change.allFinite() || !project(problem_, z, next) || !(next.sum < now_.sum)) continue;
      const double promised = now_.sum - (slopes_ * change - now_.linear.left).squaredNorm();
      const double ratio = (now_.sum - next.sum) / promised;
      damping_ *= std::max(1.0 / 3, 1 - std::pow(2 * ratio - 1, 3));
      growth_ = 2;
      const bool is_over = now_.sum - next.sum <= 1e-15 * now_.sum;
      now_ = std::move(next);
      return !is_over;
    }
    return false;
  }

  const LawProblem& problem_;
  ProjectedPoint now_;
  DenseMatrix slopes_;
  VectorX gradient_, scale_;
  double damping_ = 1e-3, growth_ = 2;
};

/// Starts that lead to different places: the best one of each neighbourhood.
std::vector<ProjectedPoint> best_starts(const LawProblem& problem) {
  std::vector<ProjectedPoint> points;
  for (const VectorX& z : problem.starts()) {
    ProjectedPoint point;
    if (project(problem, z, point)) points.push_back(std::move(point));
  }
  if (problem.num_nonlinear() == 1) {  // along a line: the local minima
    std::vector<ProjectedPoint> minima;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool is_below_left = i == 0 || points[i].sum <= points[i - 1].sum;
      const bool is_below_right = i + 1 == points.size() || points[i].sum <= points[i + 1].sum;
      if (is_below_left && is_below_right) minima.push_back(points[i]);
    }
    points = std::move(minima);
  }
  std::ranges::stable_sort(points, {}, &ProjectedPoint::sum);
  if (points.size() > most_searches) points.resize(most_searches);
  return points;
}

}  // namespace

LinearSolution solve_linear(const DenseMatrix& A, const VectorX& y) {
  const Eigen::Index n = A.cols();
  LinearSolution solution{VectorX::Zero(n), y, DenseMatrix(A.rows(), 0)};
  if (n == 0) return solution;
  // Columns of length 1, later ones a little shorter: of two that are the same the first is kept.
  VectorX scale = A.colwise().norm();
  for (Eigen::Index i = 0; i < n; ++i)
    scale[i] = scale[i] > 0 ? scale[i] * (1 + 1e-6 * static_cast<double>(i)) : 1;
  const dense::Reflections factors = dense::pivoted_reflections(A * scale.cwiseInverse().asDiagonal());
  const DenseMatrix& R = factors.packed;
  Eigen::Index rank = 0;
  while (rank < std::min(n, A.rows()) && std::abs(R(rank, rank)) > rank_tolerance * std::abs(R(0, 0))) ++rank;
  solution.basis = dense::times(factors, DenseMatrix::Identity(A.rows(), rank));
  const VectorX pivoted = dense::solve_upper(R.topLeftCorner(rank, rank), solution.basis.transpose() * y);
  for (Eigen::Index i = 0; i < rank; ++i) {
    const int column = factors.order[static_cast<std::size_t>(i)];
    solution.c[column] = pivoted[i] / scale[column];
  }
  solution.left = y - A * solution.c;
  return solution;
}

bool fit_separably(const LawProblem& problem, const VectorX& start, FitPoint& point) {
  ProjectedPoint first;
  if (!project(problem, start, first)) return false;
  if (problem.num_nonlinear() == 0) {
    point = {first.linear.c, first.z, first.sum, 1, true};
    return true;
  }
  point = ProjectedSearch(problem, std::move(first)).run();
  return true;
}

std::vector<FitPoint> fit_from_many_starts(const LawProblem& problem) {
  std::vector<FitPoint> ends;
  if (problem.num_nonlinear() == 0) {
    FitPoint end;
    if (fit_separably(problem, VectorX(0), end)) ends.push_back(end);
    return ends;
  }
  for (ProjectedPoint& start : best_starts(problem))
    ends.push_back(ProjectedSearch(problem, std::move(start)).run());
  std::ranges::stable_sort(ends, {}, &FitPoint::sum);
  return ends;
}

}  // namespace resilin
