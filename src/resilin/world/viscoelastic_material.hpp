#pragma once

#include <optional>
#include <string>
#include <vector>

#include "resilin/energy/softening.hpp"
#include "resilin/energy/viscoelastic.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

/// A Prony series by its instantaneous moduli.
struct PronySeries {
  std::vector<PronyBranch> branches;
  /// Instantaneous moduli over those that the material gives: 1, unless these are the long-term ones.
  RemainingShares stiffening;
};

/// Throws InputError for lists that differ in length, shares that leave no long-term modulus, relaxation
/// times that are not positive, and a law without an isochoric-volumetric split.
PronySeries prony_series(const ViscoelasticDescription& description, const LawInfo& law);

/// The softening of a material. Throws InputError for constants out of range, a law without an
/// isochoric-volumetric split, and viscoelasticity beside it.
Softening softening(const MullinsDescription& mullins, bool is_viscoelastic, const LawInfo& law);

/// Whether a body has a material with internal variables, its regions included.
bool has_history(const BodyDescription& body);

/// A material with internal variables, in the words of messages.
struct HistoryPlace {
  std::string place;  ///< place of its table in the scene
  std::string kind;   ///< "a viscoelastic one"
  std::string cure;   ///< "leave viscoelastic out"
};
/// The first such material of a scene.
std::optional<HistoryPlace> find_history(const Description& description);

/// Throws InputError for analyses that do not follow internal variables.
void check_history(const Description& description);

}  // namespace resilin
