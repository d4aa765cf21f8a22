#pragma once

#include <string>

#include "resilin/world/description.hpp"

namespace resilin {

/// Rigid regions (docs/rigid.md): a rigid body with the mass of the region, whose name is "BODY.REGION". The
/// nodes of the region's cells stay with the deformable body and follow the rigid one, so that loads, contact
/// and results are those of one body.

/// The name of the rigid body of a region.
std::string name_of_rigid_region(const BodyDescription& body, const RegionDescription& region);

/// Adds the rigid body of each rigid region, behind all bodies. Descriptions that have been read have them.
/// @throws InputError  for a body without a deformable cell, or with an initial state for each vertex
void add_rigid_regions(Description& description);

/// The place of the first rigid region; empty: there is none.
std::string place_of_rigid_region(const Description& description);

/// Gives the rigid regions of a body a material for what little they stretch with their rigid bodies.
/// @param modulus  Young's modulus where the scene gives no stiffness [Pa]
void fill_rigid_regions(BodyDescription& body, double modulus);

}  // namespace resilin
