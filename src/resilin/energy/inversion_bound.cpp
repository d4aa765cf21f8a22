#include "resilin/energy/inversion_bound.hpp"

#include <algorithm>
#include <cmath>

namespace resilin {
namespace {

constexpr double kept_volume = 0.1;

double value(const VolumeCubic& g, double t) { return g[0] + t * (g[1] + t * (g[2] + t * g[3])); }
double slope(const VolumeCubic& g, double t) { return g[1] + t * (2 * g[2] + t * 3 * g[3]); }

/// The root of g between a and b, where g falls from positive to not positive, from the positive side.
double bracketed_root(const VolumeCubic& g, double a, double b) {
  double t = 0.5 * (a + b);
  for (int step = 0; step < 100 && b - a > 4e-16 * b; ++step) {
    const double here = value(g, t);
    (here > 0 ? a : b) = t;
    const double newton = t - here / slope(g, t);
    t = newton > a && newton < b ? newton : 0.5 * (a + b);
    // Newton comes from one side; a probe just past its point closes the bracket from the other.
    if (here > 0 && step % 2 == 1) t = std::min(t + 1e-15 * b, 0.5 * (t + b));
  }
  return a;
}

}  // namespace

double inversion_free_step(const VolumeCubic& volume, double limit) {
  if (!(volume[0] > 0)) return limit;
  const VolumeCubic g = {(1 - kept_volume) * volume[0], volume[1], volume[2], volume[3]};
  // Most cells are safe by the sum of their falling terms alone.
  const double falling = std::min(g[1], 0.0) + limit * (std::min(g[2], 0.0) + limit * std::min(g[3], 0.0));
  if (g[0] + limit * falling > 0) return limit;

  // g is monotone between the roots of its slope: the first interval at whose end g <= 0 holds the first
  // root.
  std::array<double, 3> ends = {limit, limit, limit};
  const double a = 3 * g[3], b = g[2], c = g[1], discriminant = b * b - a * c;
  if (discriminant > 0) {
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    const double r0 = a != 0 ? q / a : limit, r1 = q != 0 ? c / q : limit;
    if (r0 > 0 && r0 < limit) ends[0] = r0;
    if (r1 > 0 && r1 < limit) ends[1] = r1;
    std::sort(ends.begin(), ends.end());
  }
  double begin = 0;
  for (const double end : ends) {
    if (!(value(g, end) > 0)) return bracketed_root(g, begin, end);
    begin = end;
  }
  return limit;
}

}  // namespace resilin
