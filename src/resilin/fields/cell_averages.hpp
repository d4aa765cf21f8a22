#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// At each node the mean of what the cells around it have, by rest volume: what `averaged_...` fields are,
/// and what a live scene can afford in every frame. Neither as smooth nor as exact as `NodalFit`, a hundred
/// times as fast, and within the range of the cells.
class CellAverages {
 public:
  explicit CellAverages(const World& world);

  /// @param cell_values  `components` numbers for each cell of all bodies, one after another
  /// @return             `components` numbers for each node; zero at a node that no cell uses
  std::vector<double> at_nodes(std::span<const double> cell_values, std::size_t components) const;

 private:
  std::vector<std::uint32_t> first_;     ///< by node, into the next two
  std::vector<std::uint32_t> cells_at_;  ///< cells at the nodes of all bodies, one after another
  std::vector<double> shares_;           ///< shares of each cell in the node's value
};

}  // namespace resilin
