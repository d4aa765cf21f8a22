#pragma once

#include "resilin/energy/material_point.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Nodes that a hand takes when it touches a place: those around it, weighed by how near they are at rest, so
/// that a pull draws no thorn out of the body. With d the distance at rest and r the reach,
///
///   w = (1 - d^2/r^2)^2, in sum 1.
///
/// The reach is one and a quarter edges, or a twentieth of the body where its cells are finer, and takes in
/// the nodes of the place itself, or the nearest one where those are far away. Nodes hang together through
/// cells within reach: a hand on one finger does not take the next one.
/// @param touched  nodes of one body
MaterialPoint hand_patch(const World& world, const MaterialPoint& touched);

}  // namespace resilin
