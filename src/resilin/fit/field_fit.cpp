#include "resilin/fit/field_fit.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/scene_search.hpp"
#include "resilin/fit/uncertainty.hpp"
#include "resilin/world/body_mesh.hpp"

namespace resilin {
namespace {

constexpr double same_strength = 0.2;  ///< a change by less is none
constexpr double largest_change = 10;  ///< largest change of the weight, from one place to the next
constexpr int most_choices = 12;       ///< most choices of the weight
constexpr double loose_factor = 2;
/// Weights by two principles that are further apart are worth a word.
constexpr double far_apart = 100;

const CellBlock& cells_of(const World& world, const std::string& body) {
  const auto& bodies = world.made_from->bodies;
  return solid_cells(*std::ranges::find(bodies, body, &BodyDescription::name), world.dimension);
}

/// Whether an interval tells little: a factor of 2 to both sides, or half of what the number may be.
bool is_loose(const SceneUnknown& unknown, double lower, double upper) {
  if (unknown.is_positive) return !(upper / lower <= loose_factor * loose_factor);
  return !(upper - lower <= (unknown.upper - unknown.lower) / 2);
}

}  // namespace

FieldTerm::FieldTerm(const SceneModel& model, const SceneFitDescription& description, VectorX origin)
    : regularise_(description.regularise),
      has_sigma_(model.data().sigma.size() > 0),
      prior_(origin.size()),
      origin_(std::move(origin)) {
  for (std::size_t p = 0; p < model.ranges().size(); ++p) {
    const UnknownRange& range = model.ranges()[p];
    if (!range.is_field) continue;
    const World& world = model.world(range.experiment);
    const std::string body = body_of_key(description.parameters[p].key);
    const auto& bodies = world.made_from->bodies;
    cells_.push_back(field_cells(cells_of(world, body),
                                 std::ranges::find(bodies, body, &BodyDescription::name)->mesh.vertices,
                                 world.dimension));
    prior_.add(cells_.back(), range.first, regularise_.kind);
  }
  prior_.finish();
  if (regularise_.strength) {
    strength_ = *regularise_.strength;
    is_chosen_ = true;
  } else if (regularise_.rule == StrengthRule::discrepancy && !has_sigma_) {
    throw InputError(
        regularise_.place + ".strength", "sigmas for the discrepancy principle", "none",
        "add sigma = ..., the standard deviation of the numbers, or take strength = \"l_curve\"");
  }
}

/// By the rule; where the L has no corner, or no weight leaves so small a misfit, by cross validation.
void FieldTerm::choose_strength() {
  double chosen = regularise_.rule == StrengthRule::discrepancy ? discrepancy_strength(*problem_)
                                                                : l_curve(*problem_).corner;
  if (!(chosen > 0)) chosen = cross_validated_strength(*problem_);
  if (strength_ > 0) chosen = std::clamp(chosen, strength_ / largest_change, strength_ * largest_change);
  is_chosen_ = std::abs(std::log(chosen / strength_)) < same_strength || ++rounds_ >= most_choices;
  strength_ = chosen;
}

SearchStep FieldTerm::best_step(const VectorX& z, const VectorX& r, const DenseMatrix& J) {
  const VectorX u = z - origin_;
  problem_ = std::make_unique<RegularisedProblem>(J, J * u - r, prior_);
  if (!is_chosen_) choose_strength();
  const RegularisedProblem::Point least = problem_->at(strength_);
  return {problem_->solution(strength_) - u,
          r.squaredNorm() + value(z) - (least.misfit + strength_ * least.roughness)};
}

double FieldTerm::variance(double sum) const {
  const double left = static_cast<double>(problem_->num_values()) - problem_->at(strength_).freedom;
  const double shown = left > 0 ? sum / left : 0;
  return !has_sigma_ || sum > chi_square_99(left) ? shown : 1;
}

namespace {

FittedField field_at(const SceneModel& model, const SceneSearch& search, const SceneParameter& parameter,
                     const UnknownRange& range, const FieldCells& cells, const VectorX& half_widths,
                     const VectorX& resolution) {
  FittedField field{.name = parameter.names.empty() ? parameter.key : parameter.names.front(),
                    .key = parameter.key,
                    .unit = model.unknowns()[static_cast<std::size_t>(range.first)].unit,
                    .body = body_of_key(parameter.key),
                    .constant = parameter.key.substr(parameter.key.rfind('.') + 1),
                    .scene = range.experiment};
  const auto numbers = [&](const VectorX& z) {
    const VectorX own = search.search().values_at(z).segment(range.first, range.count);
    return std::vector<double>(own.begin(), own.end());
  };
  const VectorX& z = search.search().z();
  field.values = numbers(z);
  field.lower_95 = numbers(z - half_widths);
  field.upper_95 = numbers(z + half_widths);
  for (std::size_t c = 0; c < field.values.size(); ++c) {
    const Eigen::Index i = range.first + static_cast<Eigen::Index>(c);
    field.resolution.push_back(resolution[i] > 0
                                   ? std::pow(cells.shares[c] * cells.volume / resolution[i], 1.0 / cells.dim)
                                   : std::numeric_limits<double>::infinity());
    const SceneUnknown& unknown = model.unknowns()[static_cast<std::size_t>(i)];
    field.num_loose += is_loose(unknown, field.lower_95[c], field.upper_95[c]) ? 1 : 0;
  }
  return field;
}

void tell_strength(const FieldTerm& term, SceneFitReport& report) {
  const RegularisedProblem& problem = term.problem();
  RegularisationReport told{.asked = report.description.regularise,
                            .curve = l_curve(problem),
                            .strength = term.strength(),
                            .cross_validated = cross_validated_strength(problem),
                            .point = problem.at(term.strength())};
  if (report.has_sigma) told.discrepancy = discrepancy_strength(problem);
  std::vector<std::string>& warnings = report.estimates.warnings;
  const double other = told.discrepancy > 0 ? told.discrepancy : told.cross_validated;
  if (!(std::abs(std::log(told.strength / other)) <= std::log(far_apart)))
    warnings.push_back("the weight of the prior, " + format_short(told.strength) + ", is far from that of " +
                       (told.discrepancy > 0 ? "the discrepancy principle, " : "cross validation, ") +
                       format_short(other) + ": look at the L-curve, or give regularise.strength");
  if (told.curve.corner == 0 && !told.asked.strength && told.asked.rule == StrengthRule::l_curve)
    warnings.emplace_back("the L-curve has no corner: the weight is that of cross validation");
  report.regularised = std::move(told);
}

}  // namespace

void tell_fields(const SceneModel& model, const SceneSearch& search, SceneFitReport& report) {
  const FieldTerm& term = *search.fields();
  const RegularisedProblem::Uncertainty uncertainty = term.problem().uncertainty(term.strength());
  report.degrees_of_freedom = static_cast<int>(
      std::lround(static_cast<double>(report.num_values) - term.problem().at(term.strength()).freedom));
  const double size = term.variance(report.sum_of_squares);
  if (!report.has_sigma) report.noise = std::sqrt(size);
  std::vector<std::string>& warnings = report.estimates.warnings;
  if (report.has_sigma && size > 1)
    warnings.push_back(
        "model error: residuals are " + format_short(std::sqrt(size)) +
        " times as large as the sigmas say. Mesh, element, law, boundary conditions or loads are not those "
        "of the experiment, or the prior is too strong; intervals are widened by it");
  const VectorX deviations = (size * uncertainty.variance.cwiseMax(0.0)).cwiseSqrt(),
                half_widths = normal_95 * deviations;
  const VectorX& z = search.search().z();
  const VectorX lower = search.search().values_at(z - half_widths),
                upper = search.search().values_at(z + half_widths);
  std::size_t scalar = 0;
  for (std::size_t p = 0; p < model.ranges().size(); ++p) {
    const UnknownRange& range = model.ranges()[p];
    if (range.is_field) {
      report.fields.push_back(field_at(model, search, report.description.parameters[p], range,
                                       term.cells()[report.fields.size()], half_widths,
                                       uncertainty.resolution));
      continue;
    }
    for (Eigen::Index i = range.first; i < range.first + range.count; ++i) {
      FittedParameter& parameter = report.parameters[scalar++];
      parameter.lower_95 = lower[i];
      parameter.upper_95 = upper[i];
      parameter.standard_error =
          deviations[i] * std::abs(search.search().transforms()[static_cast<std::size_t>(i)].slope(z[i]));
    }
  }
  for (const FittedField& field : report.fields)
    if (field.num_loose > 0)
      warnings.push_back(field.name + ": " + std::to_string(field.num_loose) + " of " +
                         std::to_string(field.values.size()) +
                         " cells are known to no better than a factor of 2 (signed values: half of their "
                         "range); their values come from the neighbours and the prior");
  tell_strength(term, report);
}

}  // namespace resilin
