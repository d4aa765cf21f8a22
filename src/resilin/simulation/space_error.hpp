#pragma once

#include <optional>
#include <vector>

#include "resilin/simulation/simulation.hpp"

namespace resilin {

/// How much energy an equilibrium would lose in a richer finite element space.
struct SpaceError {
  /// Twice the energy that further functions take from a body [J].
  struct Change {
    double by_displacements = 0;  ///< |u+ - u|^2 in the norm of the tangent stiffness
    double by_pressures = 0;      ///< change of mixed elements: negative, they make the body stiffer

    /// The sum. Where the two nearly cancel it depends on what the richer space misses, too, and a part of
    /// their sizes stands in for it.
    double total() const;
  };
  /// Per body; empty where the tangents take more memory than the estimate may.
  std::vector<std::optional<Change>> changes;
  /// Prescribed displacements do more work than loads: the error is one of the forces.
  bool is_driven_by_displacements = false;
};

/// One Newton step from the equilibrium of a static simulation into the space that hierarchical functions of
/// one degree more span (RicherSpace). The step is found by conjugate gradients on the new unknowns alone,
/// with those of the element eliminated by their own stiffness matrix. Mixed elements get linear pressures as
/// well, and the minimum residual method. Contact and point loads count on
/// the nodes of the element; facets in contact keep their shape.
/// @return nothing in motion, for modes, for viscoelastic materials and for a part of a scene
/// Source: Deuflhard, Leinweber & Yserentant 1989; Ainsworth & Oden 2000, ch. 5.
std::optional<SpaceError> space_error(Simulation& simulation);

}  // namespace resilin
