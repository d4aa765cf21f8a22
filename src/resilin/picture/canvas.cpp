#include "resilin/picture/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/picture/hidden_sky.hpp"

namespace resilin {
namespace {

/// Samples lo .. hi - 1 whose middles lie between two coordinates.
std::array<int, 2> sample_range(double low, double high, int count) {
  const double limit = count;
  return {static_cast<int>(std::clamp(std::ceil(low - 0.5), 0.0, limit)),
          static_cast<int>(std::clamp(std::floor(high - 0.5) + 1, 0.0, limit))};
}

double cross(const Vector3& a, const Vector3& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

Canvas::Canvas(int width, int height, Color background, std::optional<Color> other)
    : columns_(samples * width), rows_(samples * height) {
  const auto count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  colors_.assign(count, background);
  if (other) others_.assign(count, *other);
  depths_.assign(count, -std::numeric_limits<float>::infinity());
  last_line_.assign(count, 0);
}

template <class Visit>
void Canvas::for_each_sample(const std::array<CanvasVertex, 3>& corners, const Visit& visit) const {
  std::array<Vector3, 3> p;
  for (std::size_t i = 0; i < 3; ++i) p[i] = samples * corners[i].place;
  const double area = cross(p[1] - p[0], p[2] - p[0]);
  if (!(std::abs(area) > 1e-12) || !std::isfinite(area)) return;  // seen from its edge
  const auto [x_low, x_high] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
  const auto [y_low, y_high] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
  const auto [first_row, end_row] = sample_range(y_low, y_high, rows_);
  const auto [first_column, end_column] = sample_range(x_low, x_high, columns_);
  constexpr double slack = -1e-9;  // so that no gap opens between neighbours
  for (int row = first_row; row < end_row; ++row)
    for (int column = first_column; column < end_column; ++column) {
      const Vector3 at(column + 0.5, row + 0.5, 0);
      const double a = cross(p[1] - at, p[2] - at) / area, b = cross(p[2] - at, p[0] - at) / area;
      const double c = 1 - a - b;
      if (a < slack || b < slack || c < slack) continue;
      const auto depth = static_cast<float>(a * p[0].z() + b * p[1].z() + c * p[2].z());
      if (!(depth > depths_[offset(column, row)])) continue;
      visit(offset(column, row), depth, a * corners[0].value + b * corners[1].value + c * corners[2].value,
            a * corners[0].light + b * corners[1].light + c * corners[2].light);
    }
}

void Canvas::triangle(const std::array<CanvasVertex, 3>& corners, const Shader& shader) {
  for_each_sample(corners, [&](std::size_t sample, float depth, double value, double light) {
    depths_[sample] = depth;
    const Color color = shader(value, light);
    colors_[sample] = color;
    if (!others_.empty()) others_[sample] = color;
  });
}

// Inline, since it is called for every sample: 8 % of a picture.
inline void Canvas::mix_in(std::size_t sample, Color color, double opacity) {
  colors_[sample] = mix(colors_[sample], color, opacity);
  if (!others_.empty()) others_[sample] = mix(others_[sample], color, opacity);
}

void Canvas::darken_hollows(double radius, double strength) {
  const int width = columns_ / samples, height = rows_ / samples;
  std::vector<float> depths(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float nearest = -std::numeric_limits<float>::infinity();
      for (int row = samples * y; row < samples * (y + 1); ++row)
        for (int column = samples * x; column < samples * (x + 1); ++column)
          nearest = std::max(nearest, depths_[offset(column, row)]);
      depths[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
          nearest / samples;
    }
  const std::vector<float> hidden = hidden_sky(depths, width, height, radius);
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const std::size_t sample = offset(column, row);
      if (!std::isfinite(depths_[sample])) continue;
      const auto pixel = static_cast<std::size_t>(row / samples) * static_cast<std::size_t>(width) +
                         static_cast<std::size_t>(column / samples);
      mix_in(sample, {0, 0, 0}, std::min(strength * static_cast<double>(hidden[pixel]), 1.0));
    }
}

void Canvas::veil(const std::array<CanvasVertex, 3>& corners, const VeilShader& shader) {
  for_each_sample(corners, [&](std::size_t sample, float depth, double, double light) {
    const std::size_t row = sample / static_cast<std::size_t>(columns_);
    const std::size_t column = sample % static_cast<std::size_t>(columns_);
    const Vector3 place = Vector3(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5,
                                  static_cast<double>(depth)) /
                          samples;
    const VeilShade shade = shader(place, light);
    mix_in(sample, shade.color, shade.opacity);
  });
}

void Canvas::line(const Vector3& from, const Vector3& to, double width, double lift, const Ink& ink) {
  ++num_lines_;
  const Vector3 begin = samples * from, end = samples * to;
  const double length = (end - begin).head<2>().norm();
  if (!std::isfinite(length)) return;
  const int steps = std::max(1, static_cast<int>(std::ceil(2 * length)));
  for (int i = 0; i <= steps; ++i) {
    const Vector3 middle = begin + static_cast<double>(i) / steps * (end - begin);
    stamp(middle, samples * width / 2, middle.z() + samples * lift, ink);
  }
}

/// A disc of ink on the samples that nothing nearer covers.
void Canvas::stamp(const Vector3& middle, double radius, double depth, const Ink& ink) {
  const auto [first_row, end_row] = sample_range(middle.y() - radius, middle.y() + radius, rows_);
  const auto [first_column, end_column] = sample_range(middle.x() - radius, middle.x() + radius, columns_);
  for (int row = first_row; row < end_row; ++row)
    for (int column = first_column; column < end_column; ++column) {
      const double x = column + 0.5 - middle.x(), y = row + 0.5 - middle.y();
      const std::size_t sample = offset(column, row);
      if (x * x + y * y > radius * radius || last_line_[sample] == num_lines_ ||
          static_cast<float>(depth) < depths_[sample])
        continue;
      last_line_[sample] = num_lines_;
      mix_in(sample, ink.color, ink.opacity);
    }
}

Image Canvas::image_of(const std::vector<Color>& colors) const {
  Image image{.width = columns_ / samples, .height = rows_ / samples, .pixels = {}};
  image.pixels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  constexpr int count = samples * samples;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      int red = count / 2, green = count / 2, blue = count / 2;
      for (int row = samples * y; row < samples * (y + 1); ++row)
        for (int column = samples * x; column < samples * (x + 1); ++column) {
          const Color& color = colors[offset(column, row)];
          red += color.red;
          green += color.green;
          blue += color.blue;
        }
      image.at(x, y) = {static_cast<std::uint8_t>(red / count), static_cast<std::uint8_t>(green / count),
                        static_cast<std::uint8_t>(blue / count)};
    }
  return image;
}

}  // namespace resilin
