#include "resilin/fit/scene_search.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

/// A step that lowers the sum by this part of a residual's variance moves the parameters by a ten-thousandth
/// of their standard errors, a field by a hundredth.
constexpr double negligible_gain = 1e-8, negligible_gain_of_fields = 1e-4;
/// Share of the measurements: a parameter by whose own size they change less is not felt.
constexpr double least_influence = 1e-10;

/// @throws InputError  for a start of a field on a bound
ParameterTransform transform_of(const SceneUnknown& unknown, bool has_fields, const std::string& place) {
  if (!has_fields) return ParameterTransform::in_box(unknown.is_positive, unknown.lower, unknown.upper);
  const ParameterTransform transform =
      ParameterTransform::within(unknown.is_positive, unknown.lower, unknown.upper);
  if (!std::isfinite(transform.to(unknown.start)))
    throw InputError(place + ".start", "a start between the bounds of a field", format_number(unknown.start),
                     "fields are sought between their bounds and never reach them");
  return transform;
}

std::vector<ParameterTransform> transforms_of(const SceneModel& model,
                                              const SceneFitDescription& description) {
  std::vector<ParameterTransform> all;
  for (const SceneUnknown& unknown : model.unknowns())
    all.push_back(transform_of(unknown, model.has_fields(), description.parameters[unknown.parameter].place));
  return all;
}

VectorX starts_of(const SceneModel& model, const std::vector<ParameterTransform>& transforms) {
  VectorX z(static_cast<Eigen::Index>(transforms.size()));
  for (std::size_t i = 0; i < transforms.size(); ++i)
    z[static_cast<Eigen::Index>(i)] = transforms[i].to(model.unknowns()[i].start);
  return z;
}

}  // namespace

SceneResiduals::SceneResiduals(const SceneModel& model, const SceneFitDescription& description,
                               const SceneFitOptions& options)
    : model_(model), description_(description), options_(options) {
  const SceneData& data = model.data();
  weights_ = data.sigma.size() > 0 ? VectorX(data.sigma.cwiseInverse()) : VectorX::Ones(data.measured.size());
}

bool SceneResiduals::evaluate(const VectorX& values, VectorX& r) {
  there_ = model_.solve(values, options_.goes_on);
  values_there_ = values;
  r = weights_.cwiseProduct(there_.values - model_.data().measured);
  return true;
}

void SceneResiduals::accept() {
  here_ = std::move(there_);
  values_here_ = values_there_;
}

bool SceneResiduals::linearise(DenseMatrix& slopes) {
  slopes = weights_.asDiagonal() * model_.slopes(here_);
  if (is_first_ && !model_.has_fields()) refuse_what_is_not_felt(slopes);
  is_first_ = false;
  return true;
}

void SceneResiduals::refuse_what_is_not_felt(const DenseMatrix& slopes) const {
  const double size =
      weights_.cwiseProduct(here_.values).norm() + weights_.cwiseProduct(model_.data().measured).norm();
  for (Eigen::Index i = 0; i < slopes.cols(); ++i) {
    const double own_size = values_here_[i] == 0 ? 1 : std::abs(values_here_[i]);
    if (slopes.col(i).norm() * own_size > least_influence * size) continue;
    const SceneUnknown& unknown = model_.unknowns()[static_cast<std::size_t>(i)];
    throw InputError(description_.parameters[unknown.parameter].place,
                     "a parameter that affects the measurements",
                     "no effect of " + unknown.name + " on any of the " + std::to_string(slopes.rows()) +
                         " measured numbers",
                     "leave it out, or measure where it acts; if all motion is prescribed, displacements do "
                     "not determine moduli, but a reaction does");
  }
}

SceneSearch::SceneSearch(const SceneModel& model, const SceneFitDescription& description,
                         const SceneFitOptions& options)
    : model_(model),
      description_(description),
      transforms_(transforms_of(model, description)),
      start_(starts_of(model, transforms_)),
      residuals_(model, description, options),
      fields_(model.has_fields() ? std::make_unique<FieldTerm>(model, description, start_) : nullptr),
      search_(residuals_, transforms_, settings(options), nullptr, fields_.get()) {}

SearchSettings SceneSearch::settings(const SceneFitOptions& options) {
  SearchSettings settings{.tolerance = description_.tolerance, .most_evaluations = description_.max_solves};
  if (options.on_solve) settings.on_trial = [&](const SearchTrial& trial) { tell(trial, options); };
  if (fields_) {
    // The step to the least sum of squares and prior, then a third of it.
    settings.first_damping = settings.tolerance = 0;
    settings.damping_after_failure = 2;
    settings.negligible_gain = [this](double sum) {
      return negligible_gain_of_fields * fields_->variance(sum);
    };
    return settings;
  }
  const SceneData& data = model_.data();
  const auto left = std::max<Eigen::Index>(1, data.measured.size() - start_.size());
  const bool has_sigma = data.sigma.size() > 0;
  settings.negligible_gain = [=](double sum) {
    return negligible_gain * (has_sigma ? 1 : sum / static_cast<double>(left));
  };
  return settings;
}

/// use(the unknowns): of a field all, of others each.
template <class Use>
void SceneSearch::for_each_sought(const Use& use) const {
  for (const UnknownRange& range : model_.ranges()) {
    UnknownRange part = range;
    if (!range.is_field) part.count = 1;
    for (; part.first < range.first + range.count; part.first += part.count) use(part);
  }
}

std::vector<SceneUnknown> SceneSearch::sought() const {
  std::vector<SceneUnknown> all;
  for_each_sought([&](const UnknownRange& part) {
    const auto first = static_cast<std::size_t>(part.first);
    all.push_back(model_.unknowns()[first]);
    const auto own = start_.segment(part.first, part.count);
    if (own.minCoeff() < own.maxCoeff()) all.back().start = transforms_[first].from(own.mean());
  });
  return all;
}

VectorX SceneSearch::sought_values() const {
  std::vector<double> all;
  for_each_sought([&](const UnknownRange& part) {
    const double middle = search_.z().segment(part.first, part.count).mean();
    all.push_back(transforms_[static_cast<std::size_t>(part.first)].from(middle));
  });
  return Eigen::Map<const VectorX>(all.data(), static_cast<Eigen::Index>(all.size()));
}

void SceneSearch::run(const VectorX& start) {
  const std::vector<SceneUnknown> first = sought();
  VectorX z = start_;
  Eigen::Index number = 0;
  for_each_sought([&](const UnknownRange& part) {
    const ParameterTransform& transform = transforms_[static_cast<std::size_t>(part.first)];
    const double value = start[number], before = first[static_cast<std::size_t>(number)].start;
    // A start where the file has it begins with its bits.
    if (value != before)
      z.segment(part.first, part.count).array() += transform.to(value) - transform.to(before);
    ++number;
  });
  search_.run(z);
}

std::string SceneSearch::why_not() const {
  switch (search_.ending()) {
    case SearchEnding::converged:
      break;
    case SearchEnding::too_many_evaluations:
      return std::to_string(search_.evaluations()) +
             " solves were not enough: raise max_solves in [fit], or start nearer";
    case SearchEnding::no_better_step:
      return std::string("no step lowers the sum of squares") + (fields_ ? " and the prior" : "") +
             (search_.problem().empty() ? "" : ": " + search_.problem());
  }
  return "";
}

/// Each number, and the least and the most of a field.
void SceneSearch::tell(const SearchTrial& trial, const SceneFitOptions& options) const {
  SceneFitStep told{.solve = trial.number,
                    .sum_of_squares = trial.sum_of_squares,
                    .is_better = trial.is_better,
                    .problem = trial.problem};
  const VectorX values = search_.values_at(trial.z);
  std::vector<double> shown;
  for_each_sought([&](const UnknownRange& part) {
    const std::string& name = model_.unknowns()[static_cast<std::size_t>(part.first)].name;
    const auto own = values.segment(part.first, part.count);
    told.names.push_back(part.is_field ? name + " least" : name);
    shown.push_back(own.minCoeff());
    if (!part.is_field) return;
    told.names.push_back(name + " most");
    shown.push_back(own.maxCoeff());
  });
  if (fields_) {
    told.names.emplace_back("strength");
    shown.push_back(fields_->strength());
  }
  told.values = Eigen::Map<const VectorX>(shown.data(), static_cast<Eigen::Index>(shown.size()));
  options.on_solve(told);
}

}  // namespace resilin
