#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/material/hooke.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// A law of the catalogue at run time.
struct LawInfo {
  int index;  ///< place in the catalogue
  LawKind kind;
  std::string_view name;
  std::string_view title;  ///< the name as it is printed
  std::string_view formula;
  std::string_view source;
  std::string_view inversion;      ///< behaviour at J <= 0, in words
  std::string_view end_of_domain;  ///< where the energy is infinite besides; empty for laws without a limit
  bool needs_positive_J;           ///< Psi = +infinity at J <= 0
  bool uses_second_invariant;
  bool is_quadratic;           ///< in the displacement gradient
  bool has_volume_energy;      ///< its volume energy stands apart: elements with a mean volume take it
  int max_fibres;              ///< families of fibres that it can have; 0 for an isotropic law
  double only_poissons_ratio;  ///< the one that the law can have; not a number when it can have any
  std::span<const ConstantText> constants;

  /// Constants that give this small-strain solid (for a law with fibres: its ground substance). `free`: the
  /// free constants (ConstantText::is_free), in their order.
  /// Null for a sum.
  std::vector<double> (*convert)(const Hooke& hooke, std::span<const double> free);

  /// The summands of a sum of laws (material/law_sum.hpp); empty for a law of the catalogue.
  std::span<const LawInfo* const> parts{};

  /// The same with the fallback of each free constant; for one that has none, hooke.mu or 1. The parts of a
  /// sum have equal shares of the solid.
  std::vector<double> constants_from(const Hooke& hooke) const;

  /// Whether any Young's modulus and Poisson's ratio make a material of it, without fibres and without
  /// another constant.
  bool needs_only_hooke() const;
};

/// All laws, in the order of the catalogue.
std::vector<const LawInfo*> laws();

/// The law of this name, or nullptr. "yeoh + exponential_fibre" is a sum of laws.
const LawInfo* find_law(std::string_view name);

/// The law of this name; throws InputError(place, ...) that lists the laws when there is none.
const LawInfo& require_law(std::string_view name, const std::string& place);

/// Constants of the law's formula, in its order, from what a user gave: "youngs_modulus" [Pa] and
/// "poissons_ratio", which always mean the small-strain solid, with free constants beside them, or the
/// constants of the formula by name, taken literally; those with a fallback may be left out. Throws
/// InputError at `place`.CONSTANT for anything else, and at `place` when the solid would not be stable at
/// rest.
std::vector<double> resolve_constants(const LawInfo& law, const std::map<std::string, double>& given,
                                      const std::string& place);

/// Numbers for all states: the same for each (stride 0), or one after the other (stride 1).
struct Column {
  const double* data;
  std::size_t stride;
};

/// The same for `count` cells or states at once, for one after another; `place_of(i)` begins the message
/// about state i.
std::vector<double> resolve_constants(const LawInfo& law, const std::map<std::string, Column>& given,
                                      std::size_t count, const std::string& place,
                                      const std::function<std::string(std::size_t)>& name_of);

/// "number above 0 Pa": what a constant may be.
std::string range_text(const ConstantText& constant);

}  // namespace resilin
