#include "resilin/fit/search_starts.hpp"

#include <cmath>

namespace resilin {
namespace {

/// At a share in (0, 1) of the way between the bounds.
double start_at(const SceneUnknown& unknown, double share) {
  double low = unknown.lower, high = unknown.upper;
  if (unknown.is_positive) {
    if (!(low > 0)) low = unknown.start / 10;
    if (!std::isfinite(high)) high = unknown.start * 10;
    return low * std::pow(high / low, share);
  }
  const double size = unknown.start == 0 ? 1 : std::abs(unknown.start);
  if (!std::isfinite(low)) low = unknown.start - size;
  if (!std::isfinite(high)) high = unknown.start + size;
  return low + share * (high - low);
}

}  // namespace

// Multiples of powers of the root of g^(n + 1) = g + 1, modulo 1 (Roberts 2018).
std::vector<VectorX> search_starts(std::span<const SceneUnknown> unknowns, int count) {
  const auto n = static_cast<Eigen::Index>(unknowns.size());
  double root = 2;
  for (int i = 0; i < 60; ++i) root = std::pow(1 + root, 1.0 / (static_cast<double>(n) + 1));
  std::vector<VectorX> starts(static_cast<std::size_t>(count), VectorX(n));
  for (std::size_t s = 0; s < starts.size(); ++s)
    for (Eigen::Index i = 0; i < n; ++i) {
      const SceneUnknown& unknown = unknowns[static_cast<std::size_t>(i)];
      const double multiple = 0.5 + static_cast<double>(s) * std::pow(root, -static_cast<double>(i) - 1);
      starts[s][i] = s == 0 ? unknown.start : start_at(unknown, multiple - std::floor(multiple));
    }
  return starts;
}

}  // namespace resilin
