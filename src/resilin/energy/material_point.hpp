#pragma once

#include <vector>

#include "resilin/mesh/facet.hpp"

namespace resilin {

/// A place inside a cell, drawn or touched: sum_a weights[a] x_a over nodes of that one cell, or of those
/// around a place that a hand holds; the weights sum to one.
struct MaterialPoint {
  std::vector<Index> nodes;  ///< nodes of the world
  std::vector<double> weights;

  Vector3 position(int dim, const VectorX& x) const {
    Vector3 y = Vector3::Zero();
    for (std::size_t a = 0; a < nodes.size(); ++a) y += weights[a] * node_position(dim, nodes[a], x);
    return y;
  }
};

}  // namespace resilin
