#pragma once

#include "resilin/core/dual.hpp"
#include "resilin/material/invariants.hpp"

namespace resilin {

/// Hooke's law in three material axes: moduli of tension and of shear, and the contraction n_ij along axis j
/// of a pull along axis i.
template <class Real>
struct OrthotropicConstants {
  Real E1, E2, E3, G12, G23, G31, n12, n23, n31;
};

/// E:C:E, twice the energy of that law [J/m^3].
template <class Real, class T>
RESILIN_DUAL_INLINE T twice_orthotropic_energy(const OrthotropicConstants<Real>& m, const AxesStrain<T>& c) {
  // The compliances of tension; their inverse are the stiffnesses.
  const Real s11 = 1.0 / m.E1, s22 = 1.0 / m.E2, s33 = 1.0 / m.E3;
  const Real s12 = -1.0 * (m.n12 / m.E1), s23 = -1.0 * (m.n23 / m.E2), s31 = -1.0 * (m.n31 / m.E3);
  const Real c11 = s22 * s33 - s23 * s23, c12 = s23 * s31 - s12 * s33, c31 = s12 * s23 - s22 * s31;
  const Real factor = 1.0 / (s11 * c11 + s12 * c12 + s31 * c31);
  const Real c22 = s33 * s11 - s31 * s31, c33 = s11 * s22 - s12 * s12, c23 = s31 * s12 - s23 * s11;
  return (factor * c11) * square(c.e11) + (factor * c22) * square(c.e22) + (factor * c33) * square(c.e33) +
         (2.0 * factor * c12) * (c.e11 * c.e22) + (2.0 * factor * c23) * (c.e22 * c.e33) +
         (2.0 * factor * c31) * (c.e33 * c.e11) + (4.0 * m.G12) * square(c.e12) +
         (4.0 * m.G23) * square(c.e23) + (4.0 * m.G31) * square(c.e31);
}

}  // namespace resilin
