#include "resilin/fit/scene_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/separable_fit.hpp"
#include "resilin/fit/uncertainty.hpp"

namespace resilin {
namespace {

constexpr double longest_log_step = 2.302585092994046;  ///< a factor of 10
constexpr double first_damping = 1e-6;                  ///< of a problem that is nearly linear: Gauss-Newton
constexpr double damping_after_failure = 1e-3;
constexpr double most_damping = 1e10;
/// A step that lowers the sum by this part of a residual's variance moves the parameters by a
/// ten-thousandth of their standard errors.
constexpr double negligible_gain = 1e-8;
/// Of what the measurements are: a parameter by whose own size they change less is not felt.
constexpr double least_influence = 1e-10;

/// The unknowns as they are sought: logarithms of what is positive.
class Search {
 public:
  Search(const SceneModel& model, const SceneFitDescription& description, const SceneFitOptions& options)
      : model_(model), description_(description), options_(options), z_(num_unknowns()) {
    const VectorX& sigma = model.data().sigma;
    weights_ = sigma.size() > 0 ? VectorX(sigma.cwiseInverse()) : VectorX::Ones(model.data().measured.size());
    for (Eigen::Index i = 0; i < z_.size(); ++i) z_[i] = sought(i, unknown(i).start);
  }

  void run() {
    solve_first();
    while (true) {
      slopes_ = weights_.asDiagonal() * model_.slopes(solved_);
      for (Eigen::Index i = 0; i < z_.size(); ++i)
        if (unknown(i).is_positive) slopes_.col(i) *= std::exp(z_[i]);
      if (solves_ == 1) refuse_what_is_not_felt();
      if (!step()) return;
    }
  }

  VectorX values() const { return values_at(z_); }
  const SceneModel::Solved& solved() const { return solved_; }
  const VectorX& residuals() const { return r_; }
  const DenseMatrix& slopes() const { return slopes_; }  ///< of weighted residuals by what is sought
  /// Of an unknown by what is sought.
  double unit(Eigen::Index i) const { return unknown(i).is_positive ? std::exp(z_[i]) : 1; }
  int solves() const { return solves_; }
  bool is_converged() const { return is_converged_; }
  const std::string& why_not() const { return why_not_; }
  /// Held by a bound against which the sum falls.
  bool is_held(Eigen::Index i) const {
    const double g = slopes_.col(i).dot(r_);
    return (z_[i] <= lower(i) && g > 0) || (z_[i] >= upper(i) && g < 0);
  }

 private:
  const SceneUnknown& unknown(Eigen::Index i) const { return model_.unknowns()[static_cast<std::size_t>(i)]; }
  Eigen::Index num_unknowns() const { return static_cast<Eigen::Index>(model_.unknowns().size()); }
  double sought(Eigen::Index i, double value) const {
    return unknown(i).is_positive ? std::log(value) : value;
  }
  double lower(Eigen::Index i) const { return sought(i, unknown(i).lower); }
  double upper(Eigen::Index i) const { return sought(i, unknown(i).upper); }
  VectorX values_at(const VectorX& z) const {
    VectorX values = z;
    for (Eigen::Index i = 0; i < z.size(); ++i)
      if (unknown(i).is_positive)
        values[i] = std::clamp(std::exp(z[i]), unknown(i).lower, unknown(i).upper);  // bounds to the last bit
    return values;
  }
  VectorX weighted_residuals(const SceneModel::Solved& solved) const {
    return weights_.cwiseProduct(solved.values - model_.data().measured);
  }

  void tell(double sum, const VectorX& z, bool is_better, const std::string& problem) const {
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

  void solve_first() {
    solved_ = model_.solve(values(), options_.goes_on);
    solves_ = 1;
    r_ = weighted_residuals(solved_);
    tell(r_.squaredNorm(), z_, true, "");
  }

  void refuse_what_is_not_felt() const {
    const double size =
        weights_.cwiseProduct(solved_.values).norm() + weights_.cwiseProduct(model_.data().measured).norm();
    for (Eigen::Index i = 0; i < z_.size(); ++i) {
      const double own_size = unknown(i).is_positive || z_[i] == 0 ? 1 : std::abs(z_[i]);
      if (slopes_.col(i).norm() * own_size > least_influence * size) continue;
      const SceneParameter& parameter = description_.parameters[unknown(i).parameter];
      throw InputError(parameter.place, "a parameter that the measurements feel",
                       "no effect of " + unknown(i).name + " on any of the " + std::to_string(r_.size()) +
                           " measured numbers",
                       "leave it out, or measure where it acts; where all motion is prescribed, "
                       "displacements tell nothing about moduli, and a reaction does");
    }
  }

  /// The damped step over those that no bound holds; those that it would take over a bound go as far as that.
  VectorX damped_step(double damping) const {
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

  /// By which a step is small beside the parameters.
  double relative_size(const VectorX& change) const {
    double size = 0;
    for (Eigen::Index i = 0; i < z_.size(); ++i) {
      const double of = unknown(i).is_positive ? 1 : std::max(std::abs(z_[i]), std::abs(unknown(i).start));
      if (change[i] != 0) size = std::max(size, of > 0 ? std::abs(change[i]) / of : 1);
    }
    return size;
  }

  /// Goes on to a better place; false at the end of the search.
  bool step() {
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

  const SceneModel& model_;
  const SceneFitDescription& description_;
  const SceneFitOptions& options_;
  VectorX z_, r_, weights_;
  DenseMatrix slopes_;
  SceneModel::Solved solved_;
  double damping_ = first_damping;
  int solves_ = 0;
  bool is_converged_ = false;
  std::string why_not_;
};

/// In what is sought, so that what the text says of a combination holds: that of logarithms is a product.
std::string sought_name(const SceneUnknown& unknown) {
  return unknown.is_positive ? "log " + unknown.name : unknown.name;
}

/// Standard errors, intervals and correlations at the end of the search.
void estimate_errors(const SceneModel& model, const Search& search, SceneFitReport& report) {
  const auto n = static_cast<Eigen::Index>(report.parameters.size());
  Eigen::Index num_held = 0;
  for (Eigen::Index i = 0; i < n; ++i) num_held += search.is_held(i) ? 1 : 0;
  DenseMatrix held = DenseMatrix::Zero(num_held, n);
  for (Eigen::Index i = 0, row = 0; i < n; ++i)
    if (search.is_held(i)) held(row++, i) = 1;
  report.degrees_of_freedom = report.num_values - static_cast<int>(n - num_held);
  const int degrees = report.degrees_of_freedom;
  std::vector<std::string>& warnings = report.estimates.warnings;
  double variance = degrees > 0 ? report.sum_of_squares / degrees : 0;
  double factor = degrees > 0 ? student_t_95(degrees) : 0;
  if (!report.has_sigma) report.noise = std::sqrt(variance);
  if (report.has_sigma) {
    const bool is_too_large = degrees > 0 && report.sum_of_squares > chi_square_99(degrees);
    if (is_too_large) {
      warnings.push_back(
          "model error: residuals are " + format_short(std::sqrt(variance)) +
          " times as large as the sigmas say. Mesh, element, law, supports or loads are not those of the "
          "experiment; intervals are widened by it, and yet the truth may lie outside them");
    } else {
      variance = 1;
      factor = normal_95;
    }
  } else if (degrees <= 0) {
    warnings.emplace_back("as many parameters as measured numbers: the fit says nothing about its errors");
  }
  for (const SceneUnknown& unknown : model.unknowns()) {
    ConstantEstimate estimate{sought_name(unknown), unknown.is_positive ? "" : unknown.unit};
    report.estimates.constants.push_back(estimate);
  }
  const Uncertainty uncertainty = uncertainty_of(search.slopes(), variance, held);
  tell_uncertainty(uncertainty, std::vector<double>(static_cast<std::size_t>(n), 1.0), factor,
                   report.estimates);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    FittedParameter& parameter = report.parameters[k];
    ConstantEstimate& estimate = report.estimates.constants[k];
    parameter.is_held = search.is_held(i);
    if (parameter.is_held) estimate.standard_error = estimate.half_width_95 = 0;
    if (degrees <= 0 && !report.has_sigma && !parameter.is_held)
      estimate.standard_error = estimate.half_width_95 = std::numeric_limits<double>::infinity();
    const bool is_log = model.unknowns()[k].is_positive;
    const double half = estimate.half_width_95, value = parameter.value;
    parameter.standard_error = estimate.standard_error * search.unit(i);
    parameter.lower_95 = is_log ? value * std::exp(-half) : value - half;
    parameter.upper_95 = is_log ? value * std::exp(half) : value + half;
    if (parameter.is_held)
      warnings.push_back(parameter.name + " is held by its bound, " + format_number(value) +
                         ": the data would have it go on");
  }
}

void judge_tables(const SceneModel& model, const VectorX& predicted, SceneFitReport& report) {
  const SceneData& data = model.data();
  for (const SceneData::Table& table : data.tables) {
    const VectorX off = (predicted - data.measured).segment(table.first, table.count);
    Eigen::Index worst = 0;
    const double largest = off.cwiseAbs().maxCoeff(&worst);
    report.tables.push_back({table.name, table.kind, static_cast<int>(table.count),
                             std::sqrt(off.squaredNorm() / static_cast<double>(table.count)), largest,
                             data.places[static_cast<std::size_t>(table.first + worst)]});
  }
}

}  // namespace

SceneFitReport fit_scenes(SceneFitDescription description, const SceneFitOptions& options) {
  SceneFitReport report;
  report.description = std::move(description);
  const SceneModel model(report.description);
  Search search(model, report.description, options);
  search.run();
  const SceneData& data = model.data();
  report.has_sigma = data.sigma.size() > 0;
  report.num_values = static_cast<int>(data.measured.size());
  report.sum_of_squares = search.residuals().squaredNorm();
  report.solves = search.solves();
  report.is_converged = search.is_converged();
  report.why_not = search.why_not();
  const VectorX values = search.values();
  for (std::size_t u = 0; u < model.unknowns().size(); ++u) {
    const SceneUnknown& unknown = model.unknowns()[u];
    report.parameters.push_back({.name = unknown.name,
                                 .key = report.description.parameters[unknown.parameter].key,
                                 .unit = unknown.unit,
                                 .start = unknown.start,
                                 .value = values[static_cast<Eigen::Index>(u)]});
  }
  if (!report.is_converged)
    report.estimates.warnings.push_back("the search has not converged: " + report.why_not);
  for (std::string& other : model.other_elements(values))
    report.estimates.warnings.push_back(std::move(other));
  estimate_errors(model, search, report);
  judge_tables(model, search.solved().values, report);
  report.measured.assign(data.measured.begin(), data.measured.end());
  report.predicted.assign(search.solved().values.begin(), search.solved().values.end());
  for (std::size_t e = 0; e < report.description.experiments.size(); ++e)
    report.scenes.push_back(model.description_with(e, values));
  return report;
}

}  // namespace resilin
