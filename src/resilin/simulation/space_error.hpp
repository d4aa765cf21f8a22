#pragma once

#include <optional>
#include <vector>

#include "resilin/simulation/simulation.hpp"

namespace resilin {

/// How much energy an equilibrium would lose in a richer finite element space.
struct SpaceError {
  /// Per body, |u+ - u|^2 in the norm of the tangent stiffness [J]: twice the energy. Empty for a body whose
  /// element keeps a pressure, or whose element matrices take more memory than the estimate may.
  std::vector<std::optional<double>> squared_norms;
  /// Prescribed displacements do more work than loads: the error is one of the forces.
  bool is_driven_by_displacements = false;
};

/// One Newton step from the equilibrium of a static simulation into the space that hierarchical functions of
/// one degree more span (RicherSpace). The step is found by conjugate gradients on the new unknowns alone,
/// with those of the element eliminated by their own stiffness matrix. Contact and point loads count on
/// the nodes of the element; facets in contact keep their shape.
/// @return nothing in motion, for modes, for viscoelastic materials and for a part of a scene
/// Source: Deuflhard, Leinweber & Yserentant 1989; Ainsworth & Oden 2000, ch. 5.
std::optional<SpaceError> space_error(Simulation& simulation);

}  // namespace resilin
