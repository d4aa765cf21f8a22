#include "resilin/energy/softening.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace resilin {
namespace {

/// Integral of erf from 0 to z.
double integral_of_erf(double z) { return z * std::erf(z) + std::expm1(-z * z) * std::numbers::inv_sqrtpi; }

/// Integral of erf from z - d to z for a small d, by Gauss's rule of eight points.
double integral_of_erf_before(double z, double d) {
  constexpr std::array<double, 4> places = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                            0.9602898564975363};
  constexpr std::array<double, 4> weights = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                             0.1012285362903763};
  double sum = 0;
  for (std::size_t i = 0; i < places.size(); ++i)
    for (const double sign : {-1.0, 1.0}) sum += weights[i] * std::erf(z - 0.5 * d * (1 + sign * places[i]));
  return 0.5 * d * sum;
}

}  // namespace

double Softening::factor(double W, double most) const {
  return W < most ? 1 - std::erf((most - W) / width(most)) / r : 1;
}

double Softening::factor_slope(double W, double most) const {
  if (!(W < most)) return 0;
  const double s = width(most), z = (most - W) / s;
  return 2 * std::numbers::inv_sqrtpi * std::exp(-z * z) / (r * s);
}

double Softening::energy(double W, double most) const {
  if (!(most > 0)) return W;
  if (W > most) return energy(most, most) + (W - most);
  const double s = width(most), z = most / s, d = W / s;
  // Close to 0 the difference of two integrals would lose digits.
  const double lost = d < 0.5 ? integral_of_erf_before(z, d) : integral_of_erf(z) - integral_of_erf(z - d);
  return W - s * lost / r;
}

}  // namespace resilin
