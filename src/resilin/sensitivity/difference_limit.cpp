#include "resilin/sensitivity/difference_limit.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace resilin {
namespace {

/// Share of the distance of two quotients, that the limit may be off at least.
constexpr double least_part = 0.1;
/// Two sides are apart by so many times what both may be off, and by this part of the larger.
constexpr double times_apart = 5, part_apart = 1e-5;

DifferenceLimit extrapolated(const std::vector<SampledDifference>& samples, int order,
                             const std::function<double(const SampledDifference&)>& quotient) {
  DifferenceLimit best;
  double last = 0;
  for (std::size_t k = 0; k + 1 < samples.size(); ++k) {
    const double longer = quotient(samples[k]), shorter = quotient(samples[k + 1]);
    const double ratio = std::pow(samples[k].step / samples[k + 1].step, order);
    const double value = shorter + (shorter - longer) / (ratio - 1);
    const double error = std::max(std::abs(value - last), least_part * std::abs(shorter - longer));
    if (k > 0 && error < best.error) best = {value, error};
    last = value;
  }
  return best;
}

}  // namespace

bool DifferenceLimits::are_kinked() const {
  const double apart = std::abs(after.value - before.value);
  return apart > times_apart * (before.error + after.error) &&
         apart > part_apart * std::max(std::abs(after.value), std::abs(before.value));
}

DifferenceLimits limits_of(std::vector<SampledDifference> samples) {
  std::erase_if(samples, [](const SampledDifference& of) {
    return !std::isfinite(of.before) || !std::isfinite(of.after);
  });
  std::ranges::sort(samples, std::greater(), &SampledDifference::step);
  return {.central = extrapolated(samples, 2, [](const auto& of) { return 0.5 * (of.before + of.after); }),
          .before = extrapolated(samples, 1, [](const auto& of) { return of.before; }),
          .after = extrapolated(samples, 1, [](const auto& of) { return of.after; })};
}

}  // namespace resilin
