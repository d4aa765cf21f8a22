#pragma once

#include <map>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// A force that acts on a flat facet in sum [N].
struct FacetForce {
  std::vector<Index> corners;
  Vector3 force;
};

/// Loads of a static scene that do work on functions which vanish at the nodes.
struct DistributedLoads {
  std::vector<FacetForce> facets;
  std::map<std::vector<Index>, Vector3> cells;  ///< by the nodes of a cell [N/m^3]
  std::vector<Vector3> bodies;                  ///< on all cells of a body [N/m^3]
  Vector3 acceleration = Vector3::Zero();       ///< gravity [m/s^2]
};

/// Those of a world at positions x.
DistributedLoads distributed_loads(const World& world, const VectorX& x, const Conditions& c);

}  // namespace resilin
