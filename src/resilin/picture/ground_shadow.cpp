#include "resilin/picture/ground_shadow.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace resilin {
namespace {

constexpr int longer_side = 256;                 // longer side of the map, in places
constexpr int num_looks = 24;                    // around a place, for a soft edge
constexpr double softness = 0.06 * longer_side;  // how far around, in places of the map
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Evenly over a disc: a sunflower's spiral (Vogel 1979, "A better way to construct the sunflower head").
std::array<std::array<double, 2>, num_looks> make_looks() {
  std::array<std::array<double, 2>, num_looks> looks{};
  for (std::size_t k = 0; k < looks.size(); ++k) {
    const double radius = softness * std::sqrt((static_cast<double>(k) + 0.5) / num_looks);
    const double angle = static_cast<double>(k) * std::numbers::pi * (3 - std::sqrt(5.0));
    looks[k] = {radius * std::cos(angle), radius * std::sin(angle)};
  }
  return looks;
}

}  // namespace

GroundShadow::GroundShadow(const std::vector<std::array<Vector3, 3>>& triangles, const Vector3& up)
    : up_(up), right_(up.unitOrthogonal()), front_(up.cross(right_)) {
  Vector3 low = Vector3::Constant(infinity), high = -low;
  for (const auto& corners : triangles)
    for (const Vector3& corner : corners) {
      const Vector3 seen(right_.dot(corner), front_.dot(corner), up_.dot(corner));
      low = low.cwiseMin(seen);
      high = high.cwiseMax(seen);
    }
  if (!(high - low).allFinite()) return;  // nothing is there
  const double widest = std::max(high.x() - low.x(), high.y() - low.y());
  if (!(widest > 0)) return;
  step_ = widest / longer_side;
  fading_ = 0.15 * (high - low).norm();
  low_right_ = low.x();
  low_front_ = low.y();
  columns_ = static_cast<int>((high.x() - low.x()) / step_) + 1;
  rows_ = static_cast<int>((high.y() - low.y()) / step_) + 1;
  lowest_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_),
                 std::numeric_limits<float>::infinity());
  for (const auto& corners : triangles) cover(corners);
}

std::array<double, 2> GroundShadow::cell_of(const Vector3& place) const {
  return {(right_.dot(place) - low_right_) / step_, (front_.dot(place) - low_front_) / step_};
}

/// Small triangles cover the places of the map that their corners and middles fall on.
void GroundShadow::cover(const std::array<Vector3, 3>& corners) {
  double longest = 0;
  for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, (corners[(i + 1) % 3] - corners[i]).norm());
  if (!std::isfinite(longest)) return;
  const int n = static_cast<int>(std::clamp(std::ceil(1.5 * longest / step_), 1.0, 512.0));
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const double a = static_cast<double>(i) / n, b = static_cast<double>(j) / n;
      const Vector3 place = (1 - a - b) * corners[0] + a * corners[1] + b * corners[2];
      const auto [x, y] = cell_of(place);
      const auto column = static_cast<std::size_t>(std::clamp(x, 0.0, columns_ - 1.0));
      const auto row = static_cast<std::size_t>(std::clamp(y, 0.0, rows_ - 1.0));
      float& lowest = lowest_[row * static_cast<std::size_t>(columns_) + column];
      lowest = std::min(lowest, static_cast<float>(up_.dot(place)));
    }
}

double GroundShadow::at(const Vector3& place) const {
  if (lowest_.empty()) return 0;
  static const auto looks = make_looks();
  const auto [x, y] = cell_of(place);
  const double height = up_.dot(place);
  if (!(x > -softness && y > -softness && x < columns_ + softness && y < rows_ + softness)) return 0;
  double sum = 0;
  for (const auto& look : looks) {
    const double column = std::floor(x + look[0]), row = std::floor(y + look[1]);
    if (!(column >= 0 && row >= 0 && column < columns_ && row < rows_)) continue;
    const auto at =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    const double above = static_cast<double>(lowest_[at]) - height;
    // Parts that have sunk in a little, as contact lets them, throw their shadows too.
    if (above > -0.1 * fading_ && std::isfinite(above)) sum += std::exp2(-std::max(above, 0.0) / fading_);
  }
  return sum / num_looks;
}

}  // namespace resilin
