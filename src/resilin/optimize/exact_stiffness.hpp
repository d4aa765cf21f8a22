#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "resilin/linear/linear_solver.hpp"
#include "resilin/optimize/objective.hpp"

namespace resilin {

/// The exact Hessian of an objective at one point with the fixed unknowns taken out, factorised whether it is
/// definite or not. By Sylvester's law of inertia its negative pivots are the directions in which the point
/// is a maximum: the unstable modes of an equilibrium.
///
/// Cost: one factorisation for each call of `factorize`.
class ExactStiffness {
 public:
  ExactStiffness(int dim, std::shared_ptr<const BlockPattern> pattern)
      : hessian_(dim, std::move(pattern)),
        solver_(make_linear_solver({.kind = "auto", .is_definite = false}, hessian_.num_unknowns())) {}

  /// At x. `fixed_motion` (zero at free unknowns; may be empty) gives `pull`: the forces [N] at the free
  /// unknowns when the fixed ones move by it.
  LinearReport factorize(const Objective& objective, std::span<const std::uint8_t> is_fixed, const VectorX& x,
                         const VectorX& fixed_motion = {}, VectorX* pull = nullptr);

  /// K x = b with the factors; b is zero at fixed unknowns.
  LinearReport solve(const VectorX& b, VectorX& x) { return solver_->solve(hessian_, b, x, 1e-10); }

  /// |diagonal| [N/m]; zero at fixed unknowns.
  const VectorX& diagonal() const { return diagonal_; }

 private:
  BlockMatrix hessian_;
  std::unique_ptr<LinearSolver> solver_;
  VectorX diagonal_;
};

}  // namespace resilin
