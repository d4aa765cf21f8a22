#pragma once

#include <string>
#include <vector>

#include "resilin/energy/energy.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

struct Body;
class World;

/// A vertex whose motion is written down.
struct Probe {
  std::string name;
  Index node = 0;                        ///< -1: one of another process
  std::vector<WeightedNode> carriers{};  ///< on a rigid body the control nodes that carry it; else empty

  /// Its value among those of the nodes, dim each.
  Vector3 value(int dim, const VectorX& of_nodes) const;
};

/// The vertex of `body` nearest to the place of `probe`; `world` gets a warning when it is far from there.
Probe find_probe(const ProbeDescription& probe, const Body& body, World& world);

}  // namespace resilin
