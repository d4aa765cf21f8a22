#pragma once

#include <vector>

#include "resilin/linear/merged_pattern.hpp"

namespace resilin {

/// Node by position, such that neighbours stand close together (George & Liu 1981, ch. 4).
std::vector<Index> reverse_cuthill_mckee(const NodeGraph& graph);

/// Node by position, such that a factorisation stays sparse: nested dissection by METIS, approximate minimum
/// degree where the build has no METIS.
std::vector<Index> fill_reducing_order(const NodeGraph& graph);

}  // namespace resilin
