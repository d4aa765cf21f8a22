#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// By unknown: 1 where it is coupled with no other, as `eliminate` leaves those that are fixed.
std::vector<std::uint8_t> decoupled_unknowns(const BlockMatrix& A);

/// By node: whether any of its unknowns is marked, not zero.
std::vector<std::uint8_t> nodes_with_any(std::span<const std::uint8_t> of_unknowns, int dim);

}  // namespace resilin
