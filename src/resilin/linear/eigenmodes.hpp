#pragma once

#include <functional>

#include "resilin/linear/linear_solver.hpp"

namespace resilin {

/// The generalised eigenproblem K x = lambda M x over the free unknowns, K symmetric, M symmetric positive
/// definite.
struct EigenProblem {
  const BlockMatrix& stiffness;  ///< K, fixed unknowns included
  /// A += factor M, on the pattern of K.
  std::function<void(double factor, BlockMatrix& A)> add_mass;
  /// y = M x.
  std::function<void(const VectorX& x, VectorX& y)> multiply_mass;
  std::span<const std::uint8_t> is_fixed;
};

/// Eigenvalues and mode shapes of K x = lambda M x.
struct EigenModes {
  enum class Status { converged, not_converged, out_of_memory, interrupted };
  Status status = Status::converged;
  VectorX values;           ///< rising
  Eigen::MatrixXd vectors;  ///< by columns, x^T M x = 1, zero at fixed unknowns
  double zero = 0;          ///< values smaller than this are zero to round-off
  int num_solves = 0;
  std::string shortage;  ///< shortage of `out_of_memory`, as in LinearReport
};

/// The `count` smallest eigenvalues with their vectors.
///
/// Block Krylov method on (K + s M)^-1 M with a small positive s, larger where K has negative eigenvalues.
/// The block has more columns than values are asked for, so that repeated ones are all found: the six zeros
/// of a free body, the pairs of a square beam. Fully orthogonalised; small problems are solved densely.
/// Deterministic.
///
/// Source: Grimes, Lewis & Simon 1994, "A shifted block Lanczos algorithm for solving sparse symmetric
/// generalized eigenproblems".
///
/// @param count       at most the number of free unknowns
/// @param solver      for symmetric positive definite matrices
/// @param is_stopped  asked after each block; may be empty
EigenModes smallest_eigenmodes(const EigenProblem& problem, Index count, LinearSolver& solver,
                               const std::function<bool()>& is_stopped = {});

}  // namespace resilin
