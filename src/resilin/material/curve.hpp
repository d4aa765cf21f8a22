#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/material/derive.hpp"

namespace resilin {

/// Deformation mode of a block of material; its edges keep their directions, except in shear. The stretch of
/// every free direction is such that the nominal stress on its faces is zero.
enum class LoadCase {
  uniaxial,     ///< F = diag(l, x, y): P22 = P33 = 0; without fibres x = y
  equibiaxial,  ///< F = diag(l, l, x): P33 = 0; P11 and P22 differ where fibres make them
  planar,       ///< F = diag(l, x, 1): P22 = 0 (also called pure shear, or uniaxial in plane strain)
  shear,        ///< F = I + l e1 (x) e2: simple shear, l is the amount of shear
  volumetric,   ///< F = l I
};

/// "uniaxial", "equibiaxial" ...; the reverse throws InputError(place, ...) for any other word.
std::string_view name(LoadCase load_case);
/// Load case of a name. @throws InputError at `place`  for an unknown name, with the known ones
LoadCase require_load_case(std::string_view name, const std::string& place);

/// The loads that a curve shows when none are asked for: stretches 0.5 to 2, amounts of shear 0 to 1.5.
struct LoadRange {
  double from, to;
};
/// Default range of stretches, or of the amount of shear, of a curve.
LoadRange usual_range(LoadCase load_case);

/// First kind of instability at a state of the curve.
///
/// `stress_drops`: more stretch needs less nominal stress (less Cauchy stress in the volumetric case, where
/// the load is a pressure). `directions_part`: the energy is no minimum under the forces that act, held fixed
/// (dead loads), so that equal stretches become unequal. `not_elliptic`: a plane wave that runs along an edge
/// of the block has no real speed (an eigenvalue of the acoustic tensor is not positive). Waves along other
/// directions are not asked about: what is called stable here may still fail in an oblique band.
enum class Stability { stable, stress_drops, directions_part, not_elliptic, no_state };

/// "stable", "stress_drops" ...
std::string_view name(Stability stability);

/// Point at which the curve becomes unstable, or ends, between rest and an end of the range asked for.
struct StabilityLimit {
  Stability loss;
  bool above;           ///< it is lost beyond `stretch`; otherwise below
  double stretch;       ///< the last stable one, to 1e-6 of itself; the rest state when that is unstable
  double volume_ratio;  ///< there
};

/// A stress-stretch curve: vectors with one entry for each stretch asked for, in that order.
///
/// Where there is no state, the stretches but the one asked for, stresses, energy density and volume ratio
/// are nan.
struct StretchCurve {
  LoadCase load_case;
  std::vector<double> stretch;         ///< the amount of shear in shear
  std::vector<Vector3> stretches;      ///< diagonal of F, with the free directions solved
  std::vector<double> nominal_stress;  ///< P11; P12 in shear; tr P / 3 in the volumetric case [Pa]
  std::vector<double> cauchy_stress;   ///< the same entries of sigma [Pa]; tension is positive
  std::vector<double> energy_density;  ///< [J/m^3]
  std::vector<double> volume_ratio;
  std::vector<Stability> stability;
  std::vector<StabilityLimit> limits;  ///< below rest, then above: the first loss, then the end
};

/// The states of `load_case` at these stretches: positive numbers; any in shear.
///
/// The free directions minimise the energy density: Newton with a line search, to round-off. States are
/// followed from rest, upwards and downwards, in steps of 2 %, and the branch ends where no such minimum with
/// positive stretches exists: what lies beyond is `no_state`. Small-strain laws have their Cauchy stress
/// equal to the nominal one.
///
/// @throws InputError  at `stretches[i]`, for a stretch that is not finite or not positive
StretchCurve stretch_curve(const Material& material, LoadCase load_case, std::span<const double> stretches);

/// One line about the limits of the curve, such as "saint_venant_kirchhoff, uniaxial: the nominal stress
/// drops below stretch 0.57735 (volume ratio 0.89)"; empty when there are none.
std::string stability_text(const Material& material, const StretchCurve& curve);

/// The curve as CSV: a header with names and units, a line for each point, all digits; "nan" for what is not
/// defined.
std::string curve_csv(const StretchCurve& curve);

}  // namespace resilin
