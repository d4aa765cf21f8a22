#pragma once

#include <cmath>

#include "resilin/energy/mass.hpp"

namespace resilin {

/// Slows `velocities` so that a step of backward Euler that was cut short does not raise the total energy:
///
///   1/2 |v|^2_M <= 1/2 |v_n|^2_M - (E(x) - E(x_n))
///
/// A step that lowers the incremental potential has 1/2 |v - v_n|^2_M + E(x) <= 1/2 |v_n|^2_M + E(x_n), so
/// that the right side is not negative; v may still have up to four times the kinetic energy, which over many
/// steps is how truncated solves blow up. Theory: docs/theory/real_time.md, eq. (R.3).
///
/// @param gain  E(x) - E(x_n) [J]
/// @return      the factor that was applied, at most 1
inline double limit_kinetic_energy(const MassMatrix& mass, const VectorX& velocities_before, double gain,
                                   VectorX& velocities) {
  VectorX momentum;
  mass.multiply(velocities_before, momentum);
  const double allowed = 0.5 * momentum.dot(velocities_before) - gain;
  mass.multiply(velocities, momentum);
  const double kinetic = 0.5 * momentum.dot(velocities);
  if (kinetic <= allowed || kinetic == 0) return 1;
  const double factor = allowed > 0 ? std::sqrt(allowed / kinetic) : 0;
  velocities *= factor;
  return factor;
}

}  // namespace resilin
