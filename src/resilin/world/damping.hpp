#pragma once

#include "resilin/energy/damping.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Adds the damping that a description asks for to the terms of a world whose bodies and masses are complete.
void add_damping(const Description& description, World& world);

/// Lame's constants [Pa] of the isotropic solid nearest to the rest stiffness (its Voigt average), which is
/// the rest stiffness itself for a law without fibres: damping in proportion to stiffness has their multiples
/// for viscosities.
Viscosity rest_stiffness(const Material& material);

}  // namespace resilin
