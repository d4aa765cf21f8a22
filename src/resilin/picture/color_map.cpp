#include "resilin/picture/color_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace resilin {
namespace {

// Every eighth entry of viridis by van der Walt, Smith and Firing (CC0).
constexpr std::array<Color, 33> viridis = {
    {{68, 1, 84},    {71, 13, 96},   {72, 24, 106},  {72, 35, 116},  {71, 45, 123},  {69, 55, 129},
     {66, 64, 134},  {62, 73, 137},  {59, 82, 139},  {55, 91, 141},  {51, 99, 141},  {47, 107, 142},
     {44, 114, 142}, {41, 122, 142}, {38, 130, 142}, {35, 137, 142}, {33, 145, 140}, {31, 152, 139},
     {31, 160, 136}, {34, 167, 133}, {40, 174, 128}, {50, 182, 122}, {63, 188, 115}, {78, 195, 107},
     {94, 201, 98},  {112, 207, 87}, {132, 212, 75}, {152, 216, 62}, {173, 220, 48}, {194, 223, 35},
     {216, 226, 25}, {236, 229, 27}, {253, 231, 37}}};

Color viridis_color(double t) {
  const double place = t * (viridis.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), viridis.size() - 2);
  return mix(viridis[i], viridis[i + 1], place - static_cast<double>(i));
}

std::uint8_t srgb(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

/// From lightness, chroma and hue [rad] of Oklab. Source: Ottosson 2020, "A perceptual color space for image
/// processing" (public domain).
Color oklab_color(double lightness, double chroma, double hue) {
  const double a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  return {srgb(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          srgb(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          srgb(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

/// Blue through light grey to red, as dark on both sides.
Color diverging_color(double t) {
  constexpr double degree = std::numbers::pi / 180, blue = 262 * degree, red = 25 * degree;
  const double s = std::abs(2 * t - 1);
  return oklab_color(0.94 - 0.49 * s, 0.165 * std::pow(s, 0.75) * (1 - 0.12 * s), t < 0.5 ? blue : red);
}

}  // namespace

std::vector<std::string> color_map_names() { return {"viridis", "diverging"}; }

Color map_color(std::string_view name, double t) {
  const double inside = std::clamp(t, 0.0, 1.0);
  return name == "diverging" ? diverging_color(inside) : viridis_color(inside);
}

}  // namespace resilin
