#pragma once

#include <cstdint>
#include <vector>

#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// By unknown: 1 where it is coupled with no other, as `eliminate` leaves those that are fixed.
std::vector<std::uint8_t> decoupled_unknowns(const BlockMatrix& A);

}  // namespace resilin
