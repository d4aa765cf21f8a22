#pragma once

#include <cstdint>
#include <span>

#include "resilin/optimize/objective.hpp"

/// Functions that the searches for an equilibrium share.
namespace resilin {

/// Sets the entries of fixed degrees of freedom to zero.
void set_fixed_to_zero(std::span<const std::uint8_t> is_fixed, VectorX& values);

/// |diagonal of the Hessian| [N/m] at the free unknowns, zero at the fixed ones.
VectorX free_diagonal(const BlockMatrix& hessian, std::span<const std::uint8_t> is_fixed,
                      const ProcessGroup& share = {});

}  // namespace resilin
