#pragma once

#include <cstdint>
#include <span>

#include "resilin/optimize/objective.hpp"

/// What the searches for an equilibrium share: the force that is out of balance at the free unknowns.
namespace resilin {

void set_fixed_to_zero(std::span<const std::uint8_t> is_fixed, VectorX& values);

/// |diagonal of the Hessian| [N/m] at the free unknowns, zero at the fixed ones.
VectorX free_diagonal(const BlockMatrix& hessian, std::span<const std::uint8_t> is_fixed);

struct Residual {
  double norm = 0;   ///< over the free unknowns [N]
  Index worst = -1;  ///< the free unknown with the largest one
};
Residual free_residual(const VectorX& gradient, std::span<const std::uint8_t> is_fixed);

/// What rounding may leave of the residual [N]: of the sums of forces, and of the positions themselves when
/// `diagonal` is known. docs/theory/stopping.md (S.2).
double residual_round_off(const Objective& objective, std::span<const std::uint8_t> is_fixed,
                          const VectorX& x, const VectorX& diagonal);

}  // namespace resilin
