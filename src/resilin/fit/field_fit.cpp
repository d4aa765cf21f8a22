#include "resilin/fit/field_fit.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/uncertainty.hpp"
#include "resilin/world/body_mesh.hpp"

namespace resilin {
namespace {

constexpr double longest_step = 2.302585092994046;  ///< longest step of what is sought: a factor of 10
constexpr double same_strength = 0.2;               ///< a change by less is none
constexpr double largest_change = 10;  ///< largest change of the weight, from one place to the next
constexpr int most_choices = 12;       ///< most choices of the weight
constexpr double least_share = 1e-3;   ///< least share of a step
/// A step that lowers the objective by this part of a residual's variance moves the field by a hundredth of
/// its standard errors.
constexpr double negligible_gain = 1e-4;
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

SoughtScale::SoughtScale(const SceneUnknown& unknown, const std::string& place)
    : is_logarithm_(unknown.is_positive) {
  const auto scaled = [&](double value) { return is_logarithm_ ? std::log(value) : value; };
  low_ = scaled(unknown.lower);
  high_ = scaled(unknown.upper);
  is_bounded_ = std::isfinite(low_) && std::isfinite(high_);
  if (is_bounded_ && !(unknown.start > unknown.lower && unknown.start < unknown.upper))
    throw InputError(place + ".start", "a start between the bounds of a field", format_number(unknown.start),
                     "fields are sought between their bounds and never reach them");
}

double SoughtScale::to(double value) const {
  const double w = is_logarithm_ ? std::log(value) : value;
  return is_bounded_ ? std::log((w - low_) / (high_ - w)) : w;
}

double SoughtScale::from(double z) const {
  const double w = is_bounded_ ? low_ + (high_ - low_) / (1 + std::exp(-z)) : z;
  return is_logarithm_ ? std::exp(w) : w;
}

double SoughtScale::slope(double z) const {
  const double share = 1 / (1 + std::exp(-z));
  return (is_bounded_ ? (high_ - low_) * share * (1 - share) : 1) * (is_logarithm_ ? from(z) : 1);
}

FieldSearch::FieldSearch(const SceneModel& model, const SceneFitDescription& description,
                         const SceneFitOptions& options)
    : model_(model),
      description_(description),
      options_(options),
      prior_(static_cast<Eigen::Index>(model.unknowns().size())) {
  const auto n = static_cast<Eigen::Index>(model.unknowns().size());
  start_ = VectorX(n);
  u_ = VectorX::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const SceneUnknown& unknown = model.unknowns()[static_cast<std::size_t>(i)];
    scales_.emplace_back(unknown, description.parameters[unknown.parameter].place);
    start_[i] = scales_.back().to(unknown.start);
  }
  for (std::size_t p = 0; p < model.ranges().size(); ++p) {
    const UnknownRange& range = model.ranges()[p];
    if (!range.is_field) continue;
    const World& world = model.world(range.experiment);
    const std::string body = body_of_key(description.parameters[p].key);
    const auto& bodies = world.made_from->bodies;
    cells_.push_back(field_cells(cells_of(world, body),
                                 std::ranges::find(bodies, body, &BodyDescription::name)->mesh.vertices,
                                 world.dimension));
    prior_.add(cells_.back(), range.first, description.regularise.kind);
  }
  prior_.finish();
  const VectorX& sigma = model.data().sigma;
  weights_ = sigma.size() > 0 ? VectorX(sigma.cwiseInverse()) : VectorX::Ones(model.data().measured.size());
}

FieldSearch::~FieldSearch() = default;

VectorX FieldSearch::values_at(const VectorX& u) const {
  VectorX values(u.size());
  for (Eigen::Index i = 0; i < u.size(); ++i)
    values[i] = scales_[static_cast<std::size_t>(i)].from(start_[i] + u[i]);
  return values;
}

/// use(the unknowns): of a field all, of others each.
template <class Use>
void FieldSearch::for_each_sought(const Use& use) const {
  for (const UnknownRange& range : model_.ranges()) {
    UnknownRange part = range;
    if (!range.is_field) part.count = 1;
    for (; part.first < range.first + range.count; part.first += part.count) use(part);
  }
}

std::vector<SceneUnknown> FieldSearch::sought() const {
  std::vector<SceneUnknown> all;
  for_each_sought([&](const UnknownRange& part) {
    const auto first = static_cast<std::size_t>(part.first);
    all.push_back(model_.unknowns()[first]);
    const auto own = start_.segment(part.first, part.count);
    if (own.minCoeff() < own.maxCoeff()) all.back().start = scales_[first].from(own.mean());
  });
  return all;
}

VectorX FieldSearch::sought_values() const {
  std::vector<double> all;
  for_each_sought([&](const UnknownRange& part) {
    const double middle = (start_ + u_).segment(part.first, part.count).mean();
    all.push_back(scales_[static_cast<std::size_t>(part.first)].from(middle));
  });
  return Eigen::Map<const VectorX>(all.data(), static_cast<Eigen::Index>(all.size()));
}

VectorX FieldSearch::weighted_residuals(const SceneModel::Solved& solved) const {
  return weights_.cwiseProduct(solved.values - model_.data().measured);
}

void FieldSearch::tell(double sum, const VectorX& u, bool is_better, const std::string& problem) const {
  if (!options_.on_solve) return;
  SceneFitStep told{.solve = solves_, .sum_of_squares = sum, .is_better = is_better, .problem = problem};
  const VectorX values = values_at(u);
  std::vector<double> shown;
  for (std::size_t p = 0; p < model_.ranges().size(); ++p) {
    const UnknownRange& range = model_.ranges()[p];
    const auto own = values.segment(range.first, range.count);
    for (Eigen::Index i = 0; i < (range.is_field ? 1 : range.count); ++i) {
      const std::string& name = model_.unknowns()[static_cast<std::size_t>(range.first + i)].name;
      told.names.push_back(range.is_field ? name + " least" : name);
      shown.push_back(range.is_field ? own.minCoeff() : own[i]);
      if (!range.is_field) continue;
      told.names.push_back(name + " most");
      shown.push_back(own.maxCoeff());
    }
  }
  told.names.emplace_back("strength");
  shown.push_back(strength_);
  told.values = Eigen::Map<const VectorX>(shown.data(), static_cast<Eigen::Index>(shown.size()));
  options_.on_solve(told);
}

/// By the rule; where the L has no corner, or no weight leaves so small a misfit, by cross validation.
double FieldSearch::chosen_strength() const {
  const double chosen =
      description_.regularise.rule == StrengthRule::discrepancy && model_.data().sigma.size() > 0
          ? discrepancy_strength(*problem_)
          : l_curve(*problem_).corner;
  return chosen > 0 ? chosen : cross_validated_strength(*problem_);
}

/// Variance of a weighted residual: 1 by the sigmas, unless residuals are larger than these allow.
double FieldSearch::variance() const {
  const double left = static_cast<double>(r_.size()) - problem_->at(strength_).freedom;
  const double shown = left > 0 ? r_.squaredNorm() / left : 0;
  return model_.data().sigma.size() == 0 ? shown : r_.squaredNorm() > chi_square_99(left) ? shown : 1;
}

void FieldSearch::run(const VectorX& start) {
  const std::vector<SceneUnknown> first = sought();
  Eigen::Index number = 0;
  for_each_sought([&](const UnknownRange& part) {
    const double value = start[number], before = first[static_cast<std::size_t>(number)].start;
    const SoughtScale& scale = scales_[static_cast<std::size_t>(part.first)];
    // A start where the file has it begins with its bits.
    if (value != before) u_.segment(part.first, part.count).setConstant(scale.to(value) - scale.to(before));
    ++number;
  });
  if (description_.regularise.rule == StrengthRule::discrepancy && !description_.regularise.strength &&
      model_.data().sigma.size() == 0)
    throw InputError(
        description_.regularise.place + ".strength", "sigmas for the discrepancy principle", "none",
        "add sigma = ..., the standard deviation of the numbers, or take strength = \"l_curve\"");
  if (description_.regularise.strength) {
    strength_ = *description_.regularise.strength;
    is_chosen_ = true;
  }
  solved_ = model_.solve(values(), options_.goes_on);
  solves_ = 1;
  r_ = weighted_residuals(solved_);
  tell(r_.squaredNorm(), u_, true, "");
  while (true) {
    DenseMatrix J = weights_.asDiagonal() * model_.slopes(solved_);
    for (Eigen::Index i = 0; i < u_.size(); ++i)
      J.col(i) *= scales_[static_cast<std::size_t>(i)].slope(start_[i] + u_[i]);
    problem_ = std::make_unique<RegularisedProblem>(J, J * u_ - r_, prior_);
    if (!is_chosen_) {
      double chosen = chosen_strength();
      if (strength_ > 0) chosen = std::clamp(chosen, strength_ / largest_change, strength_ * largest_change);
      is_chosen_ = std::abs(std::log(chosen / strength_)) < same_strength || ++rounds_ >= most_choices;
      strength_ = chosen;
    }
    if (!step()) return;
  }
}

/// Goes on to a better place; false at the end of the search.
bool FieldSearch::step() {
  const double now = r_.squaredNorm() + strength_ * roughness(u_);
  const RegularisedProblem::Point foreseen = problem_->at(strength_);
  const VectorX change = problem_->solution(strength_) - u_;
  const double gain = now - (foreseen.misfit + strength_ * foreseen.roughness);
  if (gain <= negligible_gain * variance()) {
    is_converged_ = true;
    return false;
  }
  std::string problem;
  double share = std::min(1.0, longest_step / change.cwiseAbs().maxCoeff());
  for (; share > least_share; share /= 3) {
    if (solves_ >= description_.max_solves) {
      why_not_ =
          std::to_string(solves_) + " solves were not enough: raise max_solves in [fit], or start nearer";
      return false;
    }
    ++solves_;
    const VectorX next = u_ + share * change;
    try {
      SceneModel::Solved there = model_.solve(values_at(next), options_.goes_on);
      const VectorX r = weighted_residuals(there);
      const bool is_better = r.squaredNorm() + strength_ * roughness(next) < now;
      tell(r.squaredNorm(), next, is_better, "");
      if (!is_better) continue;
      solved_ = std::move(there);
      r_ = r;
      u_ = next;
      return true;
    } catch (const InputError& error) {  // no equilibrium there: a shorter step may have one
      problem = error.what();
      tell(std::numeric_limits<double>::infinity(), next, false, problem);
    }
  }
  why_not_ = "no step lowers the sum of squares and the prior" + (problem.empty() ? "" : ": " + problem);
  return false;
}

void FieldSearch::tell_interval(Eigen::Index i, double half, double& lower, double& upper) const {
  const SoughtScale& scale = scales_[static_cast<std::size_t>(i)];
  lower = scale.from(start_[i] + u_[i] - half);
  upper = scale.from(start_[i] + u_[i] + half);
}

void FieldSearch::tell_field(const UnknownRange& range, std::size_t p, const VectorX& deviations,
                             const VectorX& resolution, SceneFitReport& report) const {
  const SceneParameter& parameter = description_.parameters[p];
  FittedField field{.name = parameter.names.empty() ? parameter.key : parameter.names.front(),
                    .key = parameter.key,
                    .unit = model_.unknowns()[static_cast<std::size_t>(range.first)].unit,
                    .body = body_of_key(parameter.key),
                    .constant = parameter.key.substr(parameter.key.rfind('.') + 1),
                    .scene = range.experiment};
  const FieldCells& cells = cells_[report.fields.size()];
  const VectorX values = values_at(u_);
  for (Eigen::Index c = 0; c < range.count; ++c) {
    const Eigen::Index i = range.first + c;
    double lower = 0, upper = 0;
    tell_interval(i, normal_95 * deviations[i], lower, upper);
    field.values.push_back(values[i]);
    field.lower_95.push_back(lower);
    field.upper_95.push_back(upper);
    const double volume = cells.shares[static_cast<std::size_t>(c)] * cells.volume;
    field.resolution.push_back(resolution[i] > 0 ? std::pow(volume / resolution[i], 1.0 / cells.dim)
                                                 : std::numeric_limits<double>::infinity());
    field.num_loose += is_loose(model_.unknowns()[static_cast<std::size_t>(i)], lower, upper) ? 1 : 0;
  }
  report.fields.push_back(std::move(field));
}

void FieldSearch::tell_strength(SceneFitReport& report) const {
  RegularisationReport told{.asked = description_.regularise,
                            .curve = l_curve(*problem_),
                            .strength = strength_,
                            .cross_validated = cross_validated_strength(*problem_),
                            .point = problem_->at(strength_)};
  if (report.has_sigma) told.discrepancy = discrepancy_strength(*problem_);
  std::vector<std::string>& warnings = report.estimates.warnings;
  const double other = told.discrepancy > 0 ? told.discrepancy : told.cross_validated;
  if (!(std::abs(std::log(strength_ / other)) <= std::log(far_apart)))
    warnings.push_back("the weight of the prior, " + format_short(strength_) + ", is far from that of " +
                       (told.discrepancy > 0 ? "the discrepancy principle, " : "cross validation, ") +
                       format_short(other) + ": look at the L-curve, or give regularise.strength");
  if (told.curve.corner == 0 && !description_.regularise.strength &&
      description_.regularise.rule == StrengthRule::l_curve)
    warnings.emplace_back("the L-curve has no corner: the weight is that of cross validation");
  report.regularised = std::move(told);
}

void FieldSearch::tell_fields(SceneFitReport& report) const {
  const RegularisedProblem::Uncertainty uncertainty = problem_->uncertainty(strength_);
  const double freedom = problem_->at(strength_).freedom;
  report.degrees_of_freedom = static_cast<int>(std::lround(static_cast<double>(r_.size()) - freedom));
  const double size = variance();
  if (!report.has_sigma) report.noise = std::sqrt(size);
  std::vector<std::string>& warnings = report.estimates.warnings;
  if (report.has_sigma && size > 1)
    warnings.push_back(
        "model error: residuals are " + format_short(std::sqrt(size)) +
        " times as large as the sigmas say. Mesh, element, law, boundary conditions or loads are not those "
        "of the experiment, or the prior is too strong; intervals are widened by it");
  const VectorX deviations = (size * uncertainty.variance.cwiseMax(0.0)).cwiseSqrt();
  std::size_t scalar = 0;
  for (std::size_t p = 0; p < model_.ranges().size(); ++p) {
    const UnknownRange& range = model_.ranges()[p];
    if (range.is_field) {
      tell_field(range, p, deviations, uncertainty.resolution, report);
      continue;
    }
    for (Eigen::Index i = range.first; i < range.first + range.count; ++i, ++scalar) {
      FittedParameter& parameter = report.parameters[scalar];
      tell_interval(i, normal_95 * deviations[i], parameter.lower_95, parameter.upper_95);
      parameter.standard_error =
          deviations[i] * std::abs(scales_[static_cast<std::size_t>(i)].slope(start_[i] + u_[i]));
    }
  }
  for (const FittedField& field : report.fields)
    if (field.num_loose > 0)
      warnings.push_back(field.name + ": " + std::to_string(field.num_loose) + " of " +
                         std::to_string(field.values.size()) +
                         " cells are known to no better than a factor of 2 (signed values: half of their "
                         "range); their values come from the neighbours and the prior");
  tell_strength(report);
}

}  // namespace resilin
