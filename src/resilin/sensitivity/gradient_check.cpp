#include "resilin/sensitivity/gradient_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/error.hpp"

namespace resilin {
namespace {

constexpr double newton_tolerance = 1e-11;
constexpr std::array<double, 3> relative_steps = {1e-2, 1e-3, 1e-4};
/// Where these do not suffice: between them and beyond.
constexpr std::array<double, 8> further_steps = {3e-3, 3e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7};

/// Numbers between -1 and 1 that look like none other.
VectorX weights(Eigen::Index size, double seed) {
  VectorX values(size);
  for (Eigen::Index i = 0; i < size; ++i) values[i] = std::sin(seed + 12.9898 * static_cast<double>(i));
  return values;
}

/// By about its own size; places by a part of the scene's.
VectorX change_of(const Parameter& parameter, const World& world) {
  VectorX change = weights(parameter.value.size(), 2);
  if (change.size() == 1) change[0] = 1;
  const bool is_collider = parameter.name.starts_with("collider.") && parameter.value.size() > 1;
  if (is_collider && parameter.name.ends_with(".velocity"))
    return 0.05 * world.largest_extent() / world.end_time * change;
  if (is_collider || parameter.name.ends_with("positions")) return 0.05 * world.largest_extent() * change;
  const double size = parameter.value.cwiseAbs().maxCoeff();
  return (size > 0 ? size : 1) * change;
}

/// The weighted sum of the places where a run ends, less that of other places. Not a number where it does not
/// take the steps of the run that is differentiated: beside one that ends where its energy is all but too
/// high, others may be slowed down.
double result_of(Description description, const VectorX& by, const VectorX& base, int num_steps,
                 const std::function<bool()>& goes_on) {
  Simulation simulation(std::move(description));
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step([&](const NewtonReport&) { return !goes_on || goes_on(); });
    if (report.status == StepReport::Status::interrupted) throw Interrupted();
    if (report.status == StepReport::Status::not_converged) return std::nan("");
  }
  const State& end = simulation.state();
  if (end.step != num_steps || end.guarded_steps > 0 || end.divided_steps > 0) return std::nan("");
  return by.dot(simulation.state().positions - base);
}

/// Differences of runs carry some eight digits at best; a wrong derivative has none or one.
constexpr double digits_to_agree = 4;
/// Differences that are nearer than this part of the larger one have a digit in common.
constexpr double one_digit = 0.1;
/// Multiple of the distance of the two nearest differences, that the derivative may be from them.
constexpr double reach_of_differences = 3;
/// Share of nodes' ways that runs solved to `newton_tolerance` leave open; of the scene's extent,
/// what is rounded of their places.
constexpr double noise_of_ways = 1e-8, rounding_of_places = 1e-15;

/// Three differences without a digit in common bound the derivative by the two that are nearest to each
/// other: it may be theirs, if noise is what parts them. Comparisons with NaN are false.
bool are_noise_about(const GradientCheck& check) {
  double nearest = std::numeric_limits<double>::infinity(), distance = nearest, reach = 0;
  for (std::size_t i = 0; i < check.differences.size(); ++i)
    for (std::size_t k = i + 1; k < check.differences.size(); ++k) {
      const double a = check.differences[i], b = check.differences[k], apart = std::abs(a - b);
      const double larger = std::max(std::abs(a), std::abs(b));
      const bool share_a_digit = apart <= one_digit * larger && larger > 0;
      if (!std::isfinite(apart) || share_a_digit) return false;
      if (!(apart < nearest)) continue;
      nearest = apart;
      distance = std::min(std::abs(check.slope - a), std::abs(check.slope - b));
      reach = std::max(reach_of_differences * apart, check.rounding / check.steps[i]);
    }
  return std::abs(check.differences.back()) * check.steps.back() <= check.noise && distance <= reach;
}

}  // namespace

GradientCheck::Verdict GradientCheck::verdict() const {
  if (!std::isfinite(slope)) return Verdict::differs;
  if (digits >= digits_to_agree) return Verdict::agrees;
  if (are_noise_about(*this)) return Verdict::no_digits;
  if (limits.are_kinked()) {
    const auto [low, high] = std::minmax(limits.before.value, limits.after.value);
    // Several kinks may take back of each other what both sides are apart by.
    const double reach =
        high - low + reach_of_differences * std::max(limits.before.error, limits.after.error);
    return slope >= low - reach && slope <= high + reach ? Verdict::kink : Verdict::differs;
  }
  const auto& [value, error] = limits.central;
  if (!(error <= one_digit * std::max(std::abs(value), std::abs(slope)))) return Verdict::open;
  return std::abs(slope - value) <= reach_of_differences * error ? Verdict::is_within : Verdict::differs;
}

std::vector<GradientCheck> check_gradients(Description description, std::vector<std::string> parameters,
                                           const std::function<bool()>& goes_on,
                                           const std::function<void(const std::string&)>& warn) {
  description.newton.tolerance = std::min(description.newton.tolerance, newton_tolerance);
  const World world{Description(description)};
  keep_elements(description, world);
  if (parameters.empty()) parameters = parameter_names(world);
  const auto run = Derivatives::run(description, parameters, {.checkpoints = 0, .goes_on = goes_on});
  const VectorX base = run->positions(run->num_frames() - 1);
  std::vector<FrameChange> slopes(static_cast<std::size_t>(run->num_frames()));
  slopes.back().positions = weights(base.size(), 1);
  const std::vector<VectorX> gradient = run->transposed(slopes);
  for (const std::string& line : run->warnings())
    if (warn) warn(line);
  const VectorX sizes = slopes.back().positions.cwiseAbs();
  const double rounding = rounding_of_places * sizes.sum() * run->world().largest_extent();
  const double noise = rounding + noise_of_ways * sizes.dot((base - run->world().rest_positions).cwiseAbs());
  std::vector<GradientCheck> checks;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& parameter = run->parameters()[i];
    const VectorX change = change_of(parameter, run->world());
    const double unit = change.size() == 1 ? change[0] : 1;
    GradientCheck check{.parameter = parameter.name,
                        .size = change.size(),
                        .slope = gradient[i].dot(change) / unit,
                        .steps = relative_steps,
                        .noise = noise / std::abs(unit),
                        .rounding = rounding / std::abs(unit)};
    // A weighted sum of numbers of about this size has rounding of its own.
    const double largest = gradient[i].cwiseAbs().dot(change.cwiseAbs()) / std::abs(unit);
    const auto compare_with = [&](double difference) {
      const double error =
          std::abs(difference - check.slope) / std::max({std::abs(check.slope), 1e-6 * largest, 1e-300});
      if (std::isfinite(error)) check.digits = std::max(check.digits, -std::log10(std::max(error, 1e-16)));
    };
    std::vector<SampledDifference> samples;
    const auto sample = [&](double h) {
      const auto result = [&](double t) {
        Description changed = description;
        parameter.set(parameter.value + t * change, changed);
        return result_of(std::move(changed), slopes.back().positions, base, run->num_frames() - 1, goes_on);
      };
      const double after = result(h) / (h * unit), before = -result(-h) / (h * unit);
      samples.push_back({.step = h, .before = before, .after = after});
      return 0.5 * (before + after);
    };
    for (std::size_t k = 0; k < check.steps.size(); ++k) {
      check.differences[k] = sample(check.steps[k]);
      compare_with(check.differences[k]);
    }
    // Errors of central differences fall with the square of the step: both shorter steps tell what is left.
    const double ratio = std::pow(check.steps[1] / check.steps[2], 2);
    compare_with(check.differences[2] + (check.differences[2] - check.differences[1]) / (ratio - 1));
    // Nothing depends on it, and both say so.
    if (check.slope == 0 && std::ranges::all_of(check.differences, [](double d) { return std::abs(d) == 0; }))
      check.digits = 16;
    if (check.verdict() == GradientCheck::Verdict::open) {
      for (const double h : further_steps) compare_with(sample(h));
      check.limits = limits_of(std::move(samples));
      compare_with(check.limits.central.value);
    }
    checks.push_back(check);
  }
  return checks;
}

}  // namespace resilin
