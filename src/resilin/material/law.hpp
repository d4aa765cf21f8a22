#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/material/hooke.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Energy density and its derivatives with respect to the variables of the law's kind: (d1, d2, j) of
/// Invariants, or (eps:eps, nothing, tr eps) of SmallStrain. Outside the law's domain: +infinity, and nan for
/// the rest.
struct LawValues {
  double energy;                    ///< Psi [J/m^3]
  std::array<double, 3> slope;      ///< [Pa]
  std::array<double, 6> curvature;  ///< 00 01 02 11 12 22 [Pa]
};

/// A law of the catalogue at run time.
struct LawInfo {
  int index;  ///< place in the catalogue
  LawKind kind;
  std::string_view name;
  std::string_view formula;
  std::string_view source;
  std::string_view inversion;  ///< what happens at J <= 0, in words
  bool needs_positive_J;       ///< Psi = +infinity at J <= 0
  bool uses_second_invariant;
  std::span<const ConstantText> constants;

  /// Constants that give this small-strain solid.
  std::vector<double> (*constants_from)(const Hooke& hooke);
  LawValues (*evaluate)(const double* constants, const std::array<double, 3>& variables);
};

/// All laws, in the order of the catalogue.
std::vector<const LawInfo*> laws();

/// The law of this name, or nullptr.
const LawInfo* find_law(std::string_view name);

/// The law of this name; throws InputError(place, ...) that lists the laws when there is none.
const LawInfo& require_law(std::string_view name, const std::string& place);

/// Constants of the law's formula, in its order, from what a user gave: "youngs_modulus" [Pa] and
/// "poissons_ratio", which always mean the small-strain solid, or all constants of the formula by name, taken
/// literally. Throws InputError at `place`.CONSTANT for anything else.
std::vector<double> resolve_constants(const LawInfo& law, const std::map<std::string, double>& given,
                                      const std::string& place);

}  // namespace resilin
