#pragma once

#include <optional>
#include <string>
#include <vector>

#include "resilin/core/members.hpp"

namespace resilin {

class Simulation;

/// Tangent stiffness of a support at an equilibrium: the reaction that a small rigid motion of it adds, all
/// other supports held.
struct SupportStiffness {
  std::string name;
  /// Row by row: the force along each axis by a displacement along each [N/m].
  std::vector<double> by_displacement;
  /// The moment about its axis by the angle, where the support has a rotation [N m/rad].
  std::optional<double> by_rotation{};
};
RESILIN_MEMBERS(SupportStiffness, name, by_displacement, by_rotation)

/// Those of the supports that ask for it. Normal forces of friction are those of the equilibrium. Empty in
/// motion, beside ties, constraints and joints, on several processes, and where no tangent can be solved
/// with. May change the matrix that the simulation's Newton method keeps, but no step.
std::vector<SupportStiffness> support_stiffness(Simulation& simulation);

}  // namespace resilin
