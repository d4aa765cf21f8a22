#pragma once

#include "resilin/energy/damping.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The damping that a description asks for, of a world whose bodies and masses are complete; may be empty.
Terms damping_terms(const Description& description, const World& world);

/// Lame's constants [Pa] of the isotropic solid nearest to the rest stiffness (its Voigt average), which is
/// the rest stiffness itself for a law without fibres: damping in proportion to stiffness has their multiples
/// for viscosities.
Viscosity rest_stiffness(const Material& material);

}  // namespace resilin
