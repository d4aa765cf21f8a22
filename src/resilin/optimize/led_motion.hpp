#pragma once

#include "resilin/core/projection.hpp"
#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// An objective besides whose x something moves by itself: a search leads it along its way, which is a number
/// [s], and x with it.
class LedMotion {
 public:
  virtual ~LedMotion() = default;

  /// Rest of the way; the objective is that at its begin.
  virtual double way_left() const = 0;
  virtual void set_way_left(double way) = 0;
  /// The rest of the way is none that is to be gone.
  virtual void leave_way() = 0;

  // ---- steps from x to x + p along which `way` is gone, too: as the objective's functions of these names,
  // with what moves by itself on chords

  virtual void prepare_along(const VectorX& x, const VectorX& p, double way) = 0;
  virtual double max_step_along(const VectorX& x, const VectorX& p, double way) const = 0;
  virtual bool add_second_order_forces_along(const VectorX& x, const VectorX& p, double way,
                                             VectorX& forces) const = 0;
  /// Adds to first order what the gradient gains by `way` alone [N], projected like the Hessian.
  /// @param room  a matrix with the pattern of the Hessian, overwritten
  virtual void add_pull(const VectorX& x, double way, Projection projection, BlockMatrix& room,
                        VectorX& forces) const = 0;
  /// Whether what moves may be led on. No where gaps are so small that bodies have to give way first.
  virtual bool has_room(const VectorX& x) const = 0;
  /// Bodies at x are in balance: where gaps are small there, the forces need them so, and it may be led on.
  /// @return whether it may; not where gaps are near rounding
  virtual bool find_room_in_balance(const VectorX& x) = 0;
  /// The energy at x is finite.
  virtual bool is_in_domain(const VectorX& x) const = 0;
};

}  // namespace resilin
