#pragma once

#include <limits>
#include <string_view>

namespace resilin {

/// Arguments of a law's energy.
enum class LawKind {
  invariants,    ///< Invariants: isotropic, any strain
  small_strain,  ///< SmallStrain, quadratic: isotropic, rotations strain it
  stretches,     ///< Stretches: isotropic, any strain
  fibres,        ///< FibreInvariants: stiffer along one or two families of fibres
  axes,          ///< AxesStrain: other moduli along each of three material axes
  sum,           ///< no law of the catalogue, but a sum of such (material/law_sum.hpp)
};

/// Properties of a law for loops over states.
struct LawForm {
  LawKind kind;
  bool uses_second_invariant;
};

/// A constant of a law's formula.
struct ConstantText {
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  std::string_view name;
  std::string_view unit;  ///< empty for a pure number
  std::string_view meaning;
  double above = -infinity;     ///< the value must be greater than this,
  double at_least = -infinity;  ///< not less than this
  double at_most = infinity;    ///< and not greater than this
  bool is_nonzero = false;
  /// Not determined by the small-strain solid: it may be given beside youngs_modulus and poissons_ratio ...
  bool is_free = false;
  /// ... and has this value otherwise; one that is no number must be given.
  double fallback = std::numeric_limits<double>::quiet_NaN();
};

/// Constants that several models share: name, unit and symbol.
constexpr ConstantText shear_modulus_text = {"shear_modulus", "Pa", "mu", 0};
constexpr ConstantText lame_lambda_text = {"lame_lambda", "Pa", "lambda"};
constexpr ConstantText bulk_modulus_text = {"bulk_modulus", "Pa", "kappa", 0};

}  // namespace resilin
