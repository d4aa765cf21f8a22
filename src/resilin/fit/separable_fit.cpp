#include "resilin/fit/separable_fit.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/dense.hpp"

namespace resilin {
namespace {

constexpr double rank_tolerance = 1e-9;
constexpr std::size_t most_searches = 12;

/// Residuals by v, with c eliminated.
class ProjectedResiduals : public Residuals {
 public:
  explicit ProjectedResiduals(const LawProblem& problem) : problem_(problem) {}

  bool evaluate(const VectorX& v, VectorX& r) override {
    DenseMatrix A;
    VectorX y;
    if (!problem_.linear_part(v, A, y) || !A.allFinite() || !y.allFinite()) return false;
    there_ = {v, solve_linear(A, y)};
    r = -there_.linear.left;
    return true;
  }
  void accept() override { here_ = there_; }
  bool linearise(DenseMatrix& slopes) override {
    DenseMatrix B;
    if (!problem_.nonlinear_slopes(c(), here_.v, B)) return false;
    slopes = B - here_.linear.basis * (here_.linear.basis.transpose() * B);
    return true;
  }
  const VectorX& c() const { return here_.linear.c; }

 private:
  struct Point {
    VectorX v;
    LinearSolution linear;
  };
  const LawProblem& problem_;
  Point here_, there_;
};

/// Starts that lead to different places: the best one of each neighbourhood.
std::vector<VectorX> best_starts(const LawProblem& problem) {
  ProjectedResiduals residuals(problem);
  std::vector<std::pair<double, VectorX>> points;
  for (const VectorX& v : problem.starts())
    if (VectorX r; residuals.evaluate(v, r) && r.allFinite()) points.emplace_back(r.squaredNorm(), v);
  if (problem.num_nonlinear() == 1) {  // along a line: the local minima
    std::vector<std::pair<double, VectorX>> minima;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool is_below_left = i == 0 || points[i].first <= points[i - 1].first;
      const bool is_below_right = i + 1 == points.size() || points[i].first <= points[i + 1].first;
      if (is_below_left && is_below_right) minima.push_back(points[i]);
    }
    points = std::move(minima);
  }
  std::ranges::stable_sort(points, {}, [](const auto& point) { return point.first; });
  if (points.size() > most_searches) points.resize(most_searches);
  std::vector<VectorX> starts;
  for (auto& [sum, v] : points) starts.push_back(std::move(v));
  return starts;
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
  ProjectedResiduals residuals(problem);
  LeastSquaresSearch search(residuals, problem.transforms(), law_search_settings());
  if (!search.run(search.z_of(start))) return false;
  point = {residuals.c(), search.values(), search.sum_of_squares()};
  return true;
}

std::vector<FitPoint> fit_from_many_starts(const LawProblem& problem) {
  std::vector<FitPoint> ends;
  for (const VectorX& start : best_starts(problem))
    if (FitPoint end; fit_separably(problem, start, end)) ends.push_back(std::move(end));
  std::ranges::stable_sort(ends, {}, &FitPoint::sum);
  return ends;
}

}  // namespace resilin
