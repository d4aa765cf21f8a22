#pragma once

#include <vector>

#include "resilin/fit/law_problem.hpp"

namespace resilin {

/// Result of a search for the smallest sum of squares.
struct FitPoint {
  VectorX c, z;
  double sum = 0;  ///< |r|^2 in units of the problem
  int iterations = 0;
  bool is_converged = false;
};

/// The c that makes |A c - y| smallest, by QR with column pivoting. Where A does not determine c, the columns
/// without which the others do get 0, later ones first.
struct LinearSolution {
  VectorX c;
  VectorX left;       ///< y - A c
  DenseMatrix basis;  ///< (rows, rank), orthonormal: what some c reaches
};
LinearSolution solve_linear(const DenseMatrix& A, const VectorX& y);

/// Variable projection: c is eliminated by a linear solve, and Levenberg-Marquardt goes on in z alone, with
/// the part of dr/dz that no c can make up for (Kaufman 1975). Without z a single solve. c has no limits
/// here.
///
/// False when the law says nothing at `start`.
bool fit_separably(const LawProblem& problem, const VectorX& start, FitPoint& point);

/// From the best of all starts of `problem.starts()`; those that found a point, the best first.
std::vector<FitPoint> fit_from_many_starts(const LawProblem& problem);

}  // namespace resilin
