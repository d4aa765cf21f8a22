#pragma once

#include <span>

#include "resilin/core/projection.hpp"
#include "resilin/core/types.hpp"
#include "resilin/linear/block_matrix.hpp"

namespace resilin {

class CellMatrices;
struct Conditions;

/// The capability of a term that is a sum over the cells of a body. Its Hessian may be formed on internal
/// values, numbers besides x such as the pressures of mixed elements, which Newton carries along. Its loop
/// over the cells takes matrices of other terms along. `Energy::cell_term` tells who has it.
class CellTerm {
 public:
  virtual ~CellTerm() = default;

  /// The internal values that belong to x ...
  virtual VectorX internal_values(const VectorX& x) const = 0;
  virtual Eigen::Index num_internal_values() const = 0;
  /// ... or those that follow from x to first order along x + t p.
  virtual VectorX predicted_internal_values(const VectorX& x, const VectorX& p, double t) const = 0;

  /// Whether the matrices are those of the same cells.
  virtual bool takes(const CellMatrices& matrices) const = 0;
  /// Adds the Hessian on these internal values (none: those that belong to x) and the matrices `along`.
  virtual void add_hessian_at(const VectorX& internal, const VectorX& x, const Conditions& c,
                              Projection projection, BlockMatrix& hessian,
                              std::span<const CellMatrices* const> along = {}) const = 0;
};

}  // namespace resilin
