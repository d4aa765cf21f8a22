#pragma once

#include <vector>

#include "resilin/linear/colored_chunks.hpp"
#include "resilin/linear/merged_pattern.hpp"

namespace resilin {

/// An order of the nodes in which sweeps run on several threads. No two chunks of a colour have a neighbour
/// in common, so that they may add to their neighbours at the same time.
struct SweepOrder {
  std::vector<Index> node_at;       ///< by position; the chunks of the first colour come first
  ColoredChunks chunks;             ///< chunks of positions
  std::vector<Index> along_layers;  ///< positions as the nodes lie beside each other
};

/// Chunks of consecutive layers (ordering.hpp), two at least, in two colours that alternate, with
/// `least_couplings` entries of the matrix or more in each: for smoothers. A graph too small to gain by it
/// stays in one chunk.
SweepOrder two_color_order(const NodeGraph& graph, Offset least_couplings);

/// For incomplete factorisations, which lose iterations by every chunk that begins amid a body: long regions
/// of layers, mostly two, with two layers between them that come last, to which all others lead. Source: van
/// der Vorst 1987, for grids; here each region has the reverse of the order in which Cuthill and McKee leave
/// the layers between.
SweepOrder two_ended_order(const NodeGraph& graph, Offset least_couplings);

}  // namespace resilin
