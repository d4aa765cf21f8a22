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

/// all += factor times the numbers of a cell's nodes, dim each, at the places of these nodes.
inline void add_cell_values(int dim, std::span<const Index> nodes, double factor,
                            std::span<const double> values, VectorX& all) {
  for (std::size_t a = 0, k = 0; a < nodes.size(); ++a)
    for (int i = 0; i < dim; ++i, ++k) all[Eigen::Index{nodes[a]} * dim + i] += factor * values[k];
}

}  // namespace resilin
