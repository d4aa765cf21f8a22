#include "resilin/picture/hidden_sky.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr int num_directions = 12, num_steps = 8;
constexpr double least_rise = 0.08;  ///< sine of an angle: what rises less is the bend of the surface itself

class Sky {
 public:
  Sky(const std::vector<float>& depths, int width, int height, double radius)
      : depths_(depths), width_(width), height_(height), radius_(radius) {
    for (std::size_t k = 0; k < paths_.size(); ++k) {
      const double angle = 2 * std::numbers::pi * (static_cast<double>(k) + 0.5) / num_directions;
      for (std::size_t step = 0; step < num_steps; ++step) {
        const double reach = radius * std::pow((static_cast<double>(step) + 1) / num_steps, 1.5);
        paths_[k][step] = {static_cast<int>(std::lround(reach * std::cos(angle))),
                           static_cast<int>(std::lround(reach * std::sin(angle)))};
      }
    }
  }

  double hidden(int x, int y) const {
    const double depth = at(x, y);
    if (!std::isfinite(depth)) return 0;
    const std::array<double, 2> slope = {slope_along(x, y, 1, 0), slope_along(x, y, 0, 1)};
    double sum = 0;
    for (const Path& path : paths_) sum += steepest(x, y, depth, slope, path);
    return sum / num_directions;
  }

  /// The mean over neighbours of about the same depth: directions and steps leave no pattern.
  double smoothed(const std::vector<float>& values, int x, int y) const {
    const double depth = at(x, y);
    if (!std::isfinite(depth)) return 0;
    double sum = 0, weights = 0;
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx) {
        const double other = at(x + dx, y + dy);
        if (!std::isfinite(other) || std::abs(other - depth) > 0.25 * radius_) continue;
        sum += static_cast<double>(values[offset(x + dx, y + dy)]);
        weights += 1;
      }
    return sum / weights;
  }

 private:
  std::size_t offset(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  double at(int x, int y) const {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return -std::numeric_limits<double>::infinity();
    return static_cast<double>(depths_[offset(x, y)]);
  }

  /// The lesser of the slopes to both sides: that of the surface where the other leads over its border.
  double slope_along(int x, int y, int dx, int dy) const {
    const double ahead = at(x + dx, y + dy) - at(x, y), behind = at(x, y) - at(x - dx, y - dy);
    const double slope = std::abs(ahead) < std::abs(behind) ? ahead : behind;
    return std::isfinite(slope) ? slope : 0;
  }

  using Path = std::array<std::array<int, 2>, num_steps>;

  double steepest(int x, int y, double depth, const std::array<double, 2>& slope, const Path& path) const {
    double most = 0;
    for (const auto& [dx, dy] : path) {
      if (dx == 0 && dy == 0) continue;
      const double rise = at(x + dx, y + dy) - depth - slope[0] * dx - slope[1] * dy;
      if (!(rise > 0)) continue;
      const double distance = std::sqrt(static_cast<double>(dx * dx + dy * dy) + rise * rise);
      const double fading = std::max(0.0, 1 - distance * distance / (4 * radius_ * radius_));
      most = std::max(most, fading * (rise / distance - least_rise));
    }
    return most;
  }

  const std::vector<float>& depths_;
  int width_, height_;
  double radius_;
  std::array<Path, num_directions> paths_{};  ///< pixels along each direction
};

}  // namespace

std::vector<float> hidden_sky(const std::vector<float>& depths, int width, int height, double radius) {
  const Sky sky(depths, width, height, radius);
  const auto over_pixels = [&](const auto& value) {
    std::vector<float> values(depths.size());
    parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y)
        for (int x = 0; x < width; ++x)
          values[y * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
              static_cast<float>(value(x, static_cast<int>(y)));
    });
    return values;
  };
  const std::vector<float> rough = over_pixels([&](int x, int y) { return sky.hidden(x, y); });
  return over_pixels([&](int x, int y) { return sky.smoothed(rough, x, y); });
}

}  // namespace resilin
