#pragma once

#include "resilin/core/projection.hpp"
#include "resilin/linear/block_matrix.hpp"
#include "resilin/optimize/connected_components.hpp"

namespace resilin {

class Dependents;

/// A function E(x) in joules to be minimised, as Newton sees it: it knows nothing of finite elements.
class Objective {
 public:
  virtual ~Objective() = default;
  /// Unknowns that follow from others; null: none. They are fixed for the search. Forces are reduced by
  /// `gradient`, the Hessian by who solves with it.
  virtual const Dependents* dependents() const { return nullptr; }
  /// Updates quantities that the objective keeps of a known shape, such as the normal forces of friction, to
  /// x: by that it becomes another function. @return whether that may have changed the gradient
  virtual bool form_lag(const VectorX& /*x*/) { return false; }
  /// Takes as much of what was formed the last time as makes rounds of forming and minimising settle
  /// (Relaxation); the rest is what was in use before. @return whether that may have changed the gradient
  virtual bool relax_lag() { return false; }
  /// From now on the gradient at any x is that with what lags formed there, and has no potential; the Hessian
  /// is that with what was formed last while this holds. Or again all as before.
  virtual void couple_lag(bool /*is_coupled*/) {}
  /// Called once the search goes from x to x + t p.
  virtual void follow(const VectorX& /*x*/, const VectorX& /*p*/, double /*t*/) {}
  /// Called once in each iteration, before the objective is asked about points between x and x + p: what all
  /// of these need may be found here.
  virtual void prepare(const VectorX& /*x*/, const VectorX& /*p*/) {}
  /// E(to) - E(from) [J], summed from small differences; +infinity when `to` is outside the domain.
  virtual double difference(const VectorX& from, const VectorX& to) const = 0;
  /// |E(x)| summed over its parts [J]: the scale of the round-off in a difference.
  virtual double magnitude(const VectorX& x) const = 0;
  /// dE/dx [N] at all unknowns, fixed ones included.
  virtual void gradient(const VectorX& x, VectorX& gradient) const = 0;
  /// Sum of the |parts| of the gradient [N]: the scale of its round-off.
  virtual void gradient_magnitude(const VectorX& x, VectorX& magnitude) const = 0;
  /// d2E/dx2 [N/m], its elements projected as asked.
  virtual void hessian(const VectorX& x, Projection projection, BlockMatrix& hessian) const = 0;
  /// Numbers besides x on which the Hessian may be formed, such as the pressures of elements that keep one:
  /// those that belong to x, ...
  virtual VectorX internal_values(const VectorX& /*x*/) const { return {}; }
  /// ... or those that follow from x to first order along x + t p.
  virtual VectorX predicted_internal_values(const VectorX& /*x*/, const VectorX& /*p*/, double /*t*/) const {
    return {};
  }
  virtual void hessian_at(const VectorX& /*internal*/, const VectorX& x, Projection projection,
                          BlockMatrix& hessian) const {
    this->hessian(x, projection, hessian);
  }
  /// Whether the gradient is that of an energy: not where forces depend on the path, such as a pressure that
  /// follows an open surface. `hessian` is then the symmetric part of the gradient's derivative and
  /// `difference` the work along the straight path.
  virtual bool has_potential(const VectorX& /*x*/) const { return true; }
  /// The largest step t in (0, 1] that keeps x + t p inside the domain.
  virtual double max_step(const VectorX& x, const VectorX& p) const = 0;
  /// Adds forces [N] that times the inverse of the Hessian lead the step p around what cuts it short although
  /// to first order it does not. @return whether there are any
  virtual bool add_second_order_forces(const VectorX& /*x*/, const VectorX& /*p*/,
                                       VectorX& /*forces*/) const {
    return false;
  }
  /// The forces that must balance in each part [N]: a residual is small when it is small against this number.
  virtual VectorX force_scales(const VectorX& x, const VectorX& gradient,
                               const ConnectedComponents& parts) const = 0;
  /// The same with momentum over a step, without forces that are but the rounding of numbers that cancel,
  /// without grazing touches and what answers them.
  /// @param roundings  of the gradient in each part [N]; empty: none are known, and reactions do not count
  virtual VectorX distinct_acting_scales(const VectorX& x, const VectorX& roundings,
                                         const ConnectedComponents& parts) const = 0;
};

}  // namespace resilin
