#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/projection.hpp"
#include "resilin/core/types.hpp"
#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// What loads and moving targets depend on besides the positions.
struct Conditions {
  double time = 0;            ///< [s]
  double load = 1;            ///< load factor of a static run; 1 in motion
  double collider_delay = 0;  ///< how far moving colliders are behind, while a step leads them on [s]
};

/// One term of the sum that is minimised over the positions: E(x) in joules.
///
/// Positions are one number per unknown, node by node (`dim * node + component`) [m]. All functions are pure
/// and give the same bits for any number of threads.
class Energy {
 public:
  virtual ~Energy() = default;
  virtual std::string_view name() const = 0;

  /// [J]; zero at rest; +infinity outside the domain (J <= 0 under a logarithm).
  virtual double value(const VectorX& x, const Conditions& c) const = 0;

  /// E(to) - E(from) [J] as the sum of the differences of its parts, so that it keeps its digits when the two
  /// are close. +infinity when `to` is outside the domain.
  virtual double difference(const VectorX& from, const VectorX& to, const Conditions& c) const = 0;

  /// Adds dE/dx [N] to `gradient`.
  virtual void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const = 0;

  /// Adds the sum over its parts of |dE_part/dx| [N]: the scale of the round-off in the gradient.
  virtual void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const = 0;

  /// Couplings that are always there. Called once, before `bind`.
  virtual void add_pattern(BlockPatternBuilder&) const {}
  /// Looks up its slots in the pattern that all energies share. Called once.
  virtual void bind(const BlockPattern&) {}

  /// Adds d2E/dx2 [N/m], its parts projected as asked. `bind` must have been called.
  virtual void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                           BlockMatrix& hessian) const = 0;

  /// Numbers besides x on which the Hessian may be formed, such as the pressures of elements that keep one:
  /// those that belong to x, ...
  virtual VectorX internal_values(const VectorX& /*x*/) const { return {}; }
  virtual Eigen::Index num_internal_values() const { return 0; }
  /// ... or those that follow from x to first order along x + t p.
  virtual VectorX predicted_internal_values(const VectorX& /*x*/, const VectorX& /*p*/, double /*t*/) const {
    return {};
  }
  virtual void add_hessian_at(const VectorX& /*internal*/, const VectorX& x, const Conditions& c,
                              Projection projection, BlockMatrix& hessian) const {
    add_hessian(x, c, projection, hessian);
  }

  /// The largest step t in (0, 1] such that x + t p stays inside the domain with a margin.
  virtual double max_step(const VectorX& /*x*/, const VectorX& /*p*/, const Conditions& /*c*/) const {
    return 1;
  }
};

}  // namespace resilin
