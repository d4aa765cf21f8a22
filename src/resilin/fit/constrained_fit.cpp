#include "resilin/fit/constrained_fit.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/dense.hpp"

namespace resilin {
namespace {

/// The least stiffness that counts as stable, in units of the problem: of a modulus that the data show.
constexpr double least_stiffness = 1e-7;
constexpr double difference_step =
    1e-5;  ///< difference step of v, relative for logarithms; stiffness is linear in c
constexpr double limit_tolerance = 1e-9, reached_tolerance = 1e-7;

/// c and v of a problem in one vector.
VectorX joined(const VectorX& c, const VectorX& v) {
  VectorX all(c.size() + v.size());
  all << c, v;
  return all;
}

/// Residuals by c and v together.
class JointResiduals : public Residuals {
 public:
  explicit JointResiduals(const LawProblem& problem) : problem_(problem) {}

  bool evaluate(const VectorX& values, VectorX& r) override {
    there_ = values;
    return problem_.residuals(c(values), v(values), &r, nullptr);
  }
  void accept() override { here_ = there_; }
  bool linearise(DenseMatrix& slopes) override {
    return problem_.residuals(c(here_), v(here_), nullptr, &slopes);
  }
  VectorX c(const VectorX& values) const { return values.head(problem_.num_linear()); }
  VectorX v(const VectorX& values) const { return values.tail(problem_.num_nonlinear()); }

 private:
  const LawProblem& problem_;
  VectorX here_, there_;
};

/// Drucker's condition at some states, as the eigenvalues of Hessians.
class StabilityConditions : public InequalityConstraints {
 public:
  StabilityConditions(const LawProblem& problem, const std::vector<LoadedState>& states)
      : problem_(problem), states_(states) {}

  double violation(const VectorX& values) const override {
    double sum = 0;
    for (const DenseMatrix& hessian : hessians(values))
      sum += std::max(0.0, least_stiffness - smallest_stiffness(hessian));
    return sum;
  }

  /// v^T H v for the eigenvectors v of each Hessian: their slopes are those of the eigenvalues.
  bool linearise(const VectorX& values, VectorX& g, DenseMatrix& slopes) const override {
    const std::vector<DenseMatrix> here = hessians(values), by_values = hessian_slopes(values);
    const Eigen::Index n = values.size(), size = here.empty() ? 0 : here.front().rows();
    g.resize(static_cast<Eigen::Index>(here.size()) * size);
    slopes.resize(g.size(), n);
    for (std::size_t k = 0; k < here.size(); ++k) {
      if (!here[k].allFinite()) return false;
      const dense::Eigenpairs pairs = dense::symmetric_eigenpairs(here[k]);
      for (Eigen::Index a = 0; a < size; ++a) {
        const Eigen::Index row = static_cast<Eigen::Index>(k) * size + a;
        const VectorX v = pairs.vectors.col(a);
        g[row] = pairs.values[a] - least_stiffness;
        for (Eigen::Index i = 0; i < n; ++i)
          slopes(row, i) = v.dot(by_values[static_cast<std::size_t>(i) * here.size() + k] * v);
      }
    }
    return slopes.allFinite();
  }

 private:
  std::vector<DenseMatrix> hessians(const VectorX& values) const {
    if (states_.empty()) return {};
    const std::vector<double> constants =
        problem_.scaled_constants(values.head(problem_.num_linear()), values.tail(problem_.num_nonlinear()));
    return stability_hessians(*problem_.choice().law, problem_.choice().is_compressible, constants, states_);
  }

  /// Those by the first value, then by the second ...
  std::vector<DenseMatrix> hessian_slopes(const VectorX& values) const {
    std::vector<DenseMatrix> all;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      const Eigen::Index of_v = i - problem_.num_linear();
      const bool is_relative =
          of_v >= 0 && problem_.transforms()[static_cast<std::size_t>(of_v)].is_logarithm();
      const double h =
          of_v < 0 ? std::max(1.0, std::abs(values[i])) : difference_step * (is_relative ? values[i] : 1);
      const VectorX step = h * VectorX::Unit(values.size(), i);
      const std::vector<DenseMatrix> more = hessians(values + step), less = hessians(values - step);
      for (std::size_t k = 0; k < more.size(); ++k) all.emplace_back((more[k] - less[k]) / (2 * h));
    }
    return all;
  }

  const LawProblem& problem_;
  const std::vector<LoadedState>& states_;
};

/// Whether the conditions are kept, and slopes of those and of the bounds that are reached.
bool tell_reached(const LeastSquaresSearch& search, const StabilityConditions& conditions,
                  BoundedPoint& point) {
  const VectorX values = search.values();
  const Eigen::Index n = values.size();
  VectorX g;
  DenseMatrix slopes;
  if (!conditions.linearise(values, g, slopes) || (g.array() < -limit_tolerance).any()) return false;
  std::vector<VectorX> rows;
  for (Eigen::Index k = 0; k < g.size(); ++k)
    if (g[k] <= reached_tolerance) rows.push_back(slopes.row(k));
  point.is_held_by_stability = !rows.empty();
  for (Eigen::Index i = 0; i < n; ++i) {
    const ParameterTransform& transform = search.transforms()[static_cast<std::size_t>(i)];
    const double z = search.z()[i];
    if (z - transform.lower() > reached_tolerance && transform.upper() - z > reached_tolerance) continue;
    rows.emplace_back(VectorX::Unit(n, i));
    point.is_held_by_range = true;
  }
  point.reached.resize(static_cast<Eigen::Index>(rows.size()), n);
  for (std::size_t k = 0; k < rows.size(); ++k)
    point.reached.row(static_cast<Eigen::Index>(k)) = rows[k].transpose();
  return true;
}

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
  const std::vector<double> constants = problem.scaled_constants(point.c, point.v);
  const std::vector<DenseMatrix> hessians =
      stability_hessians(law, problem.choice().is_compressible, constants, limits.stable_states);
  return std::ranges::all_of(hessians,
                             [](const DenseMatrix& hessian) { return smallest_stiffness(hessian) > 0; });
}

bool fit_within_limits(const LawProblem& problem, const FitLimits& limits, const FitPoint& start,
                       BoundedPoint& point) {
  JointResiduals residuals(problem);
  const StabilityConditions conditions(problem, limits.stable_states);
  LeastSquaresSearch search(residuals, problem.all_transforms(), law_search_settings(), &conditions);
  VectorX values = joined(start.c, start.v);
  values.head(start.c.size()) = start.c.cwiseMax(problem.linear_lower()).cwiseMin(problem.linear_upper());
  if (!search.run(search.z_of(values))) return false;
  point.c = residuals.c(search.values());
  point.v = residuals.v(search.values());
  point.sum = search.sum_of_squares();
  return tell_reached(search, conditions, point);
}

}  // namespace resilin
