#pragma once

#include <string>
#include <vector>

#include "resilin/energy/viscoelastic.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

/// A Prony series by its instantaneous moduli.
struct PronySeries {
  std::vector<PronyBranch> branches;
  /// Instantaneous shear moduli over those that the material gives: 1, unless these are the long-term ones.
  double stiffening = 1;
};

/// Throws InputError for lists that differ in length, shares that leave no long-term modulus, relaxation
/// times that are not positive, and a law without an isochoric-volumetric split.
PronySeries prony_series(const ViscoelasticDescription& description, const LawInfo& law);

/// Whether a body has a viscoelastic material, its regions included.
bool is_viscoelastic(const BodyDescription& body);
/// The place of the first viscoelastic material of a scene; empty where there is none.
std::string place_of_viscoelasticity(const Description& description);

/// Throws InputError for analyses that do not follow internal variables.
void check_viscoelasticity(const Description& description);

}  // namespace resilin
