#pragma once

#include <array>

namespace resilin {

/// Volume ratio of a simplex along a straight step: J(t) = c[0] + c[1] t + c[2] t^2 + c[3] t^3.
using VolumeCubic = std::array<double, 4>;

/// The largest t in (0, limit] with J(t') >= J(0)/10 for all t' <= t, from below to round-off; `limit` when
/// J(0) <= 0.
double inversion_free_step(const VolumeCubic& volume, double limit);

}  // namespace resilin
