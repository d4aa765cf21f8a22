#pragma once

#include <span>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// Positions of a cell's nodes, dim numbers each, in the cell's node order.
inline void cell_positions(int dim, std::span<const Index> nodes, const VectorX& x,
                           std::vector<double>& positions) {
  positions.clear();
  for (const Index node : nodes)
    for (int i = 0; i < dim; ++i) positions.push_back(x[Eigen::Index{node} * dim + i]);
}

}  // namespace resilin
