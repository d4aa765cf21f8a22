#include "resilin/fit/scene_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/separable_fit.hpp"

namespace resilin {
namespace {

constexpr double longest_log_step = 2.302585092994046;  ///< a factor of 10
constexpr double first_damping = 1e-6;  ///< suits a problem that is nearly linear: Gauss-Newton
constexpr double damping_after_failure = 1e-3;
constexpr double most_damping = 1e10;
/// A step that lowers the sum by this part of a residual's variance moves the parameters by a
/// ten-thousandth of their standard errors.
constexpr double negligible_gain = 1e-8;
/// Share of the measurements: a parameter by whose own size they change less is not felt.
constexpr double least_influence = 1e-10;

}  // namespace

SceneSearch::SceneSearch(const SceneModel& model, const SceneFitDescription& description,
                         const SceneFitOptions& options)
    : model_(model), description_(description), options_(options) {
  const VectorX& sigma = model.data().sigma;
  weights_ = sigma.size() > 0 ? VectorX(sigma.cwiseInverse()) : VectorX::Ones(model.data().measured.size());
}

void SceneSearch::run(const VectorX& start) {
  start_ = z_ = start;
  for (Eigen::Index i = 0; i < z_.size(); ++i) z_[i] = sought(i, start[i]);
  damping_ = first_damping;
  is_converged_ = false;
  solve_first();
  while (true) {
    slopes_ = weights_.asDiagonal() * model_.slopes(solved_);
    for (Eigen::Index i = 0; i < z_.size(); ++i) slopes_.col(i) *= unit(i);
    if (solves_ == 1) refuse_what_is_not_felt();
    if (!step()) return;
  }
}

double SceneSearch::unit(Eigen::Index i) const { return unknown(i).is_positive ? std::exp(z_[i]) : 1; }

bool SceneSearch::is_held(Eigen::Index i) const {
  const double g = slopes_.col(i).dot(r_);
  return (z_[i] <= lower(i) && g > 0) || (z_[i] >= upper(i) && g < 0);
}

double SceneSearch::sought(Eigen::Index i, double value) const {
  return unknown(i).is_positive ? std::log(value) : value;
}

VectorX SceneSearch::values_at(const VectorX& z) const {
  VectorX values = z;
  for (Eigen::Index i = 0; i < z.size(); ++i)
    if (unknown(i).is_positive)
      values[i] = std::clamp(std::exp(z[i]), unknown(i).lower, unknown(i).upper);  // bounds to the last bit
  return values;
}

VectorX SceneSearch::weighted_residuals(const SceneModel::Solved& solved) const {
  return weights_.cwiseProduct(solved.values - model_.data().measured);
}

void SceneSearch::tell(double sum, const VectorX& z, bool is_better, const std::string& problem) const {
  if (!options_.on_solve) return;
  SceneFitStep told{.solve = solves_,
                    .names = {},
                    .values = values_at(z),
                    .sum_of_squares = sum,
                    .is_better = is_better,
                    .problem = problem};
  for (const SceneUnknown& one : model_.unknowns()) told.names.push_back(one.name);
  options_.on_solve(told);
}

void SceneSearch::solve_first() {
  solved_ = model_.solve(values(), options_.goes_on);
  solves_ = 1;
  r_ = weighted_residuals(solved_);
  tell(r_.squaredNorm(), z_, true, "");
}

void SceneSearch::refuse_what_is_not_felt() const {
  const double size =
      weights_.cwiseProduct(solved_.values).norm() + weights_.cwiseProduct(model_.data().measured).norm();
  for (Eigen::Index i = 0; i < z_.size(); ++i) {
    const double own_size = unknown(i).is_positive || z_[i] == 0 ? 1 : std::abs(z_[i]);
    if (slopes_.col(i).norm() * own_size > least_influence * size) continue;
    const SceneParameter& parameter = description_.parameters[unknown(i).parameter];
    throw InputError(parameter.place, "a parameter that affects the measurements",
                     "no effect of " + unknown(i).name + " on any of the " + std::to_string(r_.size()) +
                         " measured numbers",
                     "leave it out, or measure where it acts; if all motion is prescribed, displacements do "
                     "not determine moduli, but a reaction does");
  }
}

/// The damped step over those that no bound holds; those that it would take over a bound go as far as that.
VectorX SceneSearch::damped_step(double damping) const {
  const Eigen::Index n = z_.size(), m = r_.size();
  VectorX change = VectorX::Zero(n);
  std::vector<bool> is_free(static_cast<std::size_t>(n), true);
  for (Eigen::Index i = 0; i < n; ++i) is_free[static_cast<std::size_t>(i)] = !is_held(i);
  for (Eigen::Index round = 0; round <= n; ++round) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < n; ++i)
      if (is_free[static_cast<std::size_t>(i)]) free.push_back(i);
    if (free.empty()) break;
    const auto f = static_cast<Eigen::Index>(free.size());
    DenseMatrix A = DenseMatrix::Zero(m + f, f);
    VectorX b = VectorX::Zero(m + f);
    b.head(m) = -r_;
    for (Eigen::Index k = 0; k < n; ++k)
      if (!is_free[static_cast<std::size_t>(k)]) b.head(m) -= slopes_.col(k) * change[k];
    for (Eigen::Index k = 0; k < f; ++k) {
      A.col(k).head(m) = slopes_.col(free[static_cast<std::size_t>(k)]);
      A(m + k, k) = std::sqrt(damping) * A.col(k).head(m).norm();
    }
    const VectorX found = solve_linear(A, b).c;
    bool is_within = true;
    for (Eigen::Index k = 0; k < f; ++k) {
      const Eigen::Index i = free[static_cast<std::size_t>(k)];
      change[i] = found[k];
      const double room = std::clamp(found[k], lower(i) - z_[i], upper(i) - z_[i]);
      if (room == found[k]) continue;
      change[i] = room;
      is_free[static_cast<std::size_t>(i)] = is_within = false;
    }
    if (is_within) break;
  }
  double longest = 0;
  for (Eigen::Index i = 0; i < n; ++i)
    if (unknown(i).is_positive) longest = std::max(longest, std::abs(change[i]));
  return longest > longest_log_step ? VectorX(change * (longest_log_step / longest)) : change;
}

/// Size of a step relative to the parameters.
double SceneSearch::relative_size(const VectorX& change) const {
  double size = 0;
  for (Eigen::Index i = 0; i < z_.size(); ++i) {
    const double of = unknown(i).is_positive ? 1 : std::max(std::abs(z_[i]), std::abs(start_[i]));
    if (change[i] != 0) size = std::max(size, of > 0 ? std::abs(change[i]) / of : 1);
  }
  return size;
}

/// Goes on to a better place; false at the end of the search.
bool SceneSearch::step() {
  const double sum = r_.squaredNorm();
  const auto left = std::max<Eigen::Index>(1, r_.size() - z_.size());
  const double variance = model_.data().sigma.size() > 0 ? 1.0 : sum / static_cast<double>(left);
  std::string problem;
  VectorX tried;
  for (; damping_ < most_damping; damping_ = std::max(damping_after_failure, 10 * damping_)) {
    const VectorX change = damped_step(damping_);
    const double gain = sum - (r_ + slopes_ * change).squaredNorm();
    const bool is_small = relative_size(change) <= description_.tolerance;
    if (is_small || gain <= negligible_gain * variance) {
      // A step that much damping has made small says nothing about how near the end is.
      is_converged_ = damping_ <= damping_after_failure || gain <= negligible_gain * variance;
      if (!is_converged_)
        why_not_ = "no step lowers the sum of squares" + (problem.empty() ? "" : ": " + problem);
      return false;
    }
    if (tried.size() > 0 && tried == change) continue;  // bounds cut it to the same step
    tried = change;
    if (solves_ >= description_.max_solves) {
      why_not_ =
          std::to_string(solves_) + " solves were not enough: raise max_solves in [fit], or start nearer";
      return false;
    }
    ++solves_;
    const VectorX next = z_ + change;
    try {
      SceneModel::Solved there = model_.solve(values_at(next), options_.goes_on);
      const VectorX r = weighted_residuals(there);
      const bool is_better = r.squaredNorm() < sum;
      tell(r.squaredNorm(), next, is_better, "");
      if (!is_better) continue;
      solved_ = std::move(there);
      r_ = r;
      z_ = next;
      damping_ = std::max(1e-12, damping_ / 10);
      return true;
    } catch (const InputError& error) {  // no equilibrium there: a shorter step may have one
      problem = error.what();
      tell(std::numeric_limits<double>::infinity(), next, false, problem);
    }
  }
  why_not_ = "no step lowers the sum of squares" + (problem.empty() ? "" : ": " + problem);
  return false;
}

}  // namespace resilin
