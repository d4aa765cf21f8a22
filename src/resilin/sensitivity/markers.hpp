#pragma once

#include <string>
#include <vector>

#include "resilin/world/world.hpp"

/// Points at which results are measured.
namespace resilin {

/// A point of a body at rest, carried by the nodes of its cell: x = sum_k weights_k x_(nodes_k).
struct Marker {
  std::vector<Index> nodes;  ///< nodes of the world
  std::vector<double> weights;
};

/// The body of this name; "" where there is but one. Throws InputError at `place`.
const Body& body_named(const World& world, const std::string& name, const std::string& place);

/// The markers that stand at these points in the scene [m] in the rest shape of a body. A point may be
/// `tolerance` [m] outside, and is then carried by the nearest cell.
/// @throws InputError  at the one of `places` whose point is farthest outside the body: by how much
std::vector<Marker> markers_at(const World& world, const Body& body, const std::vector<Vector3>& points,
                               const std::vector<std::string>& places, double tolerance = 0);

/// The probe of this name. Throws InputError at `place`.
const Probe& probe_named(const World& world, const std::string& name, const std::string& place);

/// The volume of a body at positions x [m^3], in 2D [m^2] on unit thickness, whatever its rest shape; adds
/// its slopes by x.
double volume_of(const Body& body, int dim, const VectorX& x, VectorX& slopes);

}  // namespace resilin
