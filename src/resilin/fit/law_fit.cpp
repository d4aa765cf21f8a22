#include "resilin/fit/law_fit.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/law_problem.hpp"
#include "resilin/fit/uncertainty.hpp"

namespace resilin {
namespace {

/// Akaike's criterion with the correction for few points (Hurvich & Tsai 1989); infinite where it has none.
double aicc_of(const LawFit& fit, ResidualKind residual, double floor) {
  const double n = fit.num_points, sum = std::max(fit.sum_of_squares, floor);
  // The variance of the residuals is one more number that is fitted, unless sigmas are known.
  const double k = fit.num_fitted + (residual == ResidualKind::sigma ? 0 : 1);
  const double left = n - k - 1;
  if (left <= 0) return std::numeric_limits<double>::infinity();
  const double misfit = residual == ResidualKind::sigma ? sum : n * std::log(sum / n);
  return misfit + 2 * k + 2 * k * (k + 1) / left;
}

void require_enough_points(const LawChoice& choice, const FitData& data, const FitDescription& description) {
  const std::size_t needed = choice.fitted().size(), there = data.states.size();
  if (needed == 0)
    throw InputError(description.place, "a constant of " + choice.name + " to fit", "values for all of them",
                     "leave one without a value");
  if (there < needed)
    throw InputError(description.place,
                     "at least " + std::to_string(needed) + " points at nonzero strain for the " +
                         std::to_string(needed) + " constants of " + choice.name,
                     std::to_string(there), "add tests, give constants a value, or take a law with fewer");
}

ConstantOrigin origin_of(const LawChoice& choice, int place) {
  const auto holds = [place](const std::vector<int>& places) {
    return std::ranges::find(places, place) != places.end();
  };
  if (holds(choice.fitted())) return ConstantOrigin::fitted;
  if (holds(choice.absent)) return ConstantOrigin::absent;
  return !choice.is_compressible && place == choice.volume_constant ? ConstantOrigin::assumed
                                                                    : ConstantOrigin::given;
}

std::vector<ConstantEstimate> estimates_of(const LawChoice& choice, const std::vector<double>& constants) {
  std::vector<ConstantEstimate> estimates;
  for (std::size_t p = 0; p < constants.size(); ++p) {
    const ConstantText& text = choice.law->constants[p];
    ConstantEstimate estimate{std::string(text.name), std::string(text.unit), constants[p]};
    estimate.origin = origin_of(choice, static_cast<int>(p));
    if (!estimate.is_fitted()) estimate.standard_error = estimate.half_width_95 = 0;
    estimates.push_back(estimate);
  }
  return estimates;
}

/// Standard errors: of residuals whose size the fit itself shows, or of known sigmas, wider where the
/// residuals are larger than these allow.
void estimate_errors(const LawProblem& problem, const SearchResult& found, double sum, bool has_sigmas,
                     LawFit& fit) {
  const LawChoice& choice = problem.choice();
  VectorX c, v;
  problem.unknowns(found.constants, c, v);
  DenseMatrix slopes;
  if (!problem.slopes_by_constants(c, v, slopes)) return;
  const int num_free = uncertainty_of(slopes, 1, found.reached).num_free;
  const int degrees = fit.num_points - num_free;
  double variance = degrees > 0 ? sum / degrees : std::numeric_limits<double>::infinity();
  double factor = degrees > 0 ? student_t_95(degrees) : 0;
  if (has_sigmas) {
    const bool is_too_large = degrees > 0 && sum > chi_square_99(degrees);
    if (is_too_large)
      fit.warnings.push_back("residuals are " + format_short(std::sqrt(variance)) +
                             " times as large as the sigmas say: the law does not fit the data within them; "
                             "intervals are widened");
    if (!is_too_large) {
      variance = 1;
      factor = normal_95;
    }
  }
  if (!std::isfinite(variance))
    fit.warnings.emplace_back("as many constants as points: the fit says nothing about its errors");
  std::vector<double> units;
  for (const int place : choice.fitted()) units.push_back(problem.unit_of(place));
  const Uncertainty uncertainty =
      uncertainty_of(slopes, std::isfinite(variance) ? variance : 0, found.reached);
  tell_uncertainty(uncertainty, units, factor, fit);
  if (!std::isfinite(variance))
    for (ConstantEstimate& constant : fit.constants)
      if (constant.is_fitted())
        constant.standard_error = constant.half_width_95 = std::numeric_limits<double>::infinity();
}

void judge_tests(const LawChoice& choice, const std::vector<double>& constants, const FitData& data,
                 const FitDescription& description, LawFit& fit) {
  const VectorX predicted =
      HomogeneousModel(*choice.law, choice.is_compressible, data.states).stresses(constants);
  Eigen::Index first = 0;
  for (const MaterialTest& test : description.tests) {
    const auto count = static_cast<Eigen::Index>(test.num_points());
    const VectorX measured = data.measured.segment(first, count);
    const VectorX difference = predicted.segment(first, count) - measured;
    const double spread = (measured.array() - measured.mean()).matrix().squaredNorm();
    fit.tests.push_back({test.name, 1 - difference.squaredNorm() / spread,
                         std::sqrt(difference.squaredNorm() / static_cast<double>(count)),
                         difference.cwiseAbs().maxCoeff()});
    first += count;
  }
}

}  // namespace

LawFit fit_law(const LawChoice& choice, const FitData& data, const FitDescription& description) {
  require_enough_points(choice, data, description);
  SearchResult found = search_constants(choice, data, description);
  if (found.reached.rows() == 0) sort_terms(choice, found.constants);
  const HomogeneousModel model(*choice.law, choice.is_compressible, data.states);
  const LawProblem problem(choice, model, data.measured, data.weights, data.stress_scale,
                           description.constants);
  const bool is_absolute = description.residual == ResidualKind::absolute;
  const double unit_of_sum = is_absolute ? data.stress_scale * data.stress_scale : 1;
  LawFit fit;
  fit.name = choice.name;
  fit.constants = estimates_of(choice, found.constants);
  fit.num_points = static_cast<int>(data.states.size());
  fit.num_fitted = static_cast<int>(choice.fitted().size());
  fit.sum_of_squares = found.sum * unit_of_sum;
  const double floor =
      1e-28 * data.weights.cwiseProduct(data.measured / data.stress_scale).squaredNorm() * unit_of_sum;
  fit.aicc = aicc_of(fit, description.residual, floor);
  estimate_errors(problem, found, found.sum, description.residual == ResidualKind::sigma, fit);
  judge_tests(choice, found.constants, data, description, fit);
  tell_rivals(choice, found, fit);
  tell_limits(choice, found, data, description, fit);
  tell_ambiguities(choice, found.constants, data, description, fit);
  tell_material(choice, found.constants, description, fit);
  return fit;
}

}  // namespace resilin
