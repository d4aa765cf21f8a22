#pragma once

#include <limits>
#include <vector>

#include "resilin/fit/law_problem.hpp"
#include "resilin/fit/least_squares_search.hpp"

namespace resilin {

/// Residuals of laws are far from linear in exponents, and cost little.
inline SearchSettings law_search_settings() {
  return {.first_damping = 1e-3, .longest_step = std::numeric_limits<double>::infinity()};
}

/// Result of a search for the smallest sum of squares.
struct FitPoint {
  VectorX c, v;
  double sum = 0;  ///< |r|^2 in units of the problem
};

/// The c that makes |A c - y| smallest, by QR with column pivoting. Where A does not determine c, the columns
/// without which the others do get 0, later ones first.
struct LinearSolution {
  VectorX c;
  VectorX left;       ///< y - A c
  DenseMatrix basis;  ///< (rows, rank), orthonormal: what some c reaches
};
LinearSolution solve_linear(const DenseMatrix& A, const VectorX& y);

/// Variable projection: c is eliminated by a linear solve, and the search goes on in v alone, with the part
/// of dr/dv that no c can make up for (Kaufman 1975). Without v a single solve. c has no limits here.
///
/// False when the law says nothing at `start`.
bool fit_separably(const LawProblem& problem, const VectorX& start, FitPoint& point);

/// From the best of all starts of `problem.starts()`; those that found a point, the best first.
std::vector<FitPoint> fit_from_many_starts(const LawProblem& problem);

}  // namespace resilin
