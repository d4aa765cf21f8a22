#pragma once

#include <limits>
#include <string_view>

namespace resilin {

/// What a law's energy is a function of.
enum class LawKind {
  invariants,    ///< Invariants: isotropic, any strain
  small_strain,  ///< SmallStrain, quadratic: isotropic, rotations strain it
};

/// A constant of a law's formula.
struct ConstantText {
  std::string_view name;
  std::string_view unit;
  std::string_view meaning;
  double above = -std::numeric_limits<double>::infinity();  ///< the value must be greater than this
};

constexpr ConstantText shear_modulus_text = {"shear_modulus", "Pa", "mu", 0};
constexpr ConstantText lame_lambda_text = {"lame_lambda", "Pa", "lambda"};
constexpr ConstantText bulk_modulus_text = {"bulk_modulus", "Pa", "kappa", 0};

}  // namespace resilin
