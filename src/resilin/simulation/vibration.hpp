#pragma once

#include <functional>

#include "resilin/simulation/step.hpp"
#include "resilin/world/state.hpp"

namespace resilin {

/// One free vibration about an equilibrium.
struct VibrationMode {
  double eigenvalue = 0;   ///< (2 pi frequency)^2 [1/s^2]; negative when the equilibrium is unstable
  bool is_rigid = false;   ///< it deforms nothing: its frequency is zero to round-off
  VectorX shape;           ///< with shape^T M shape = 1 [1/sqrt(kg)]
  Vector3 effective_mass;  ///< part of the mass that moves with a wall shaken along each axis [kg]

  bool is_unstable() const { return !is_rigid && eigenvalue < 0; }
  double frequency() const;  ///< [Hz]; zero for a rigid or unstable mode
};

/// The modes with the smallest eigenvalues of K x = w^2 M x, K the unprojected stiffness of all energies at
/// the state's positions and load (docs/theory/vibration.md). `report` says what became of the search. On
/// success there are as many as the world asks for.
std::vector<VibrationMode> find_modes(const World& world, const VectorX& equilibrium, double load,
                                      StepReport& report, const std::function<bool()>& is_stopped);

/// The equilibrium moved along a mode, for a picture: the farthest vertex by a tenth of the scene's largest
/// extent, or by less if an element would invert.
VectorX drawn_mode(const World& world, const VectorX& equilibrium, const VibrationMode& mode);

}  // namespace resilin
