#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "resilin/world/body_mesh.hpp"
#include "resilin/world/linear_constraints.hpp"

namespace resilin {

/// The ties and linear constraints of a description, in a world whose bodies and supports are complete.
/// @param meshes  of the bodies, for their groups
/// @return null without any
std::shared_ptr<const LinearConstraints> make_constraints(const Description& description, const World& world,
                                                          std::span<const BodyMesh> meshes);

/// The nodes, rising, of the body of whose cells a rigid body is a region: those of the region.
std::vector<Index> followers_of(const World& world, const Body& rigid);

/// The contact that the scene asks for, but for bodies that are tied or joined to each other. A rigid region
/// has the surface of its body.
ContactDescription contact_beside_ties(const Description& description);

/// Throws InputError, naming the first tie, constraint, rigid region, joint, spring or cable, where a scene
/// has any: `what` is not possible then.
void refuse_constraints(const Description& description, const std::string& what);

}  // namespace resilin
