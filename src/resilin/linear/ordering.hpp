#pragma once

#include <span>
#include <vector>

#include "resilin/linear/merged_pattern.hpp"

namespace resilin {

/// Nodes such that neighbours stand close together, and the layers that they come in (George & Liu 1981,
/// ch. 4: a level structure): a node has neighbours in its own layer and in the two beside it alone.
struct LayeredOrder {
  std::vector<Index> node_at;      ///< by position
  std::vector<Index> layer_begin;  ///< the first position of every layer, then num_nodes
};
LayeredOrder reverse_cuthill_mckee(const NodeGraph& graph);

/// Appends to `order` what is reached from its nodes over nodes that carry no `mark`, breadth first, those of
/// few neighbours before others: the step of Cuthill and McKee.
/// @param begin  the position in `order` where the nodes to start from begin
/// @param ends   receives the end of each layer, the one that is started from included
void append_layers(const NodeGraph& graph, std::size_t begin, std::vector<int>& marks, int mark,
                   std::vector<Index>& order, std::vector<Index>& ends);

/// Position by node.
std::vector<Index> inverse_of(std::span<const Index> node_at);

/// Node by position, such that a factorisation stays sparse: nested dissection by METIS, approximate minimum
/// degree where the build has no METIS. Signals go where the program wants them meanwhile.
std::vector<Index> fill_reducing_order(const NodeGraph& graph);

}  // namespace resilin
