#pragma once

#include <functional>
#include <optional>

#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// Solves A p = b about right for a matrix near to the one that is meant; false when it cannot.
using NearSolve = std::function<bool(const VectorX& b, VectorX& p)>;
/// A times a vector.
using Product = std::function<void(const VectorX& p, VectorX& product)>;

/// Solves A p = b, A symmetric positive definite, by conjugate gradients with `near` as preconditioner:
/// Nocedal & Wright 2006, algorithm 5.3. Of a scene on one process.
/// @return none where A or `near` turn out not to be definite, or after some 20 iterations: they are not near
std::optional<VectorX> solve_by_near(const Product& times, const NearSolve& near, const VectorX& b,
                                     double tolerance);

}  // namespace resilin
