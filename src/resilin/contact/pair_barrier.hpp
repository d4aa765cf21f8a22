#pragma once

#include <optional>
#include <span>

#include "resilin/collision/edge_mollifier.hpp"
#include "resilin/collision/pair_distance.hpp"
#include "resilin/contact/barrier.hpp"

namespace resilin {

/// The barrier between two parts of surfaces: E = k_b A m b(d) [J].
///
/// b is the barrier of the distance, m fades nearly parallel edges out. The Hessian is a sum of rank-one
/// matrices in closed form, projected one by one: the push k_b A m b'' grad d grad d^T, two for each
/// parameter that the closest points are free in, and for fading edges ten more. Where the weight is
/// negative, as that of a part that others count too, the projection follows the sign.
template <int dim>
class PairBarrier {
 public:
  /// @param vertices   of the pair, as many as its kind has [m]
  /// @param stiffness  k_b A: barrier stiffness [Pa] times the pair's share of the rest area [m^2]; negative
  ///                   to take away what other pairs count twice
  /// @param mollifier  of two edges in 3D, unless they are not to fade
  PairBarrier(const ClampedLogBarrier& barrier, PairKind kind, std::span<const Vector<dim>> vertices,
              double stiffness, const std::optional<EdgeMollifier>& mollifier = std::nullopt);

  const PairDistance<dim>& distance() const { return pair_; }
  bool is_active() const { return !(pair_.distance >= barrier_.reach()); }

  double value() const;              ///< E [J]; infinite where the parts touch
  PairVector<dim> gradient() const;  ///< dE/dx [N], for d > 0
  double normal_force() const;       ///< -k_b A m b' [N]: what pushes the parts apart along their distance
  PairVector<dim> normal_force_gradient() const;         ///< its slope by the vertices [N/m]
  PairMatrix<dim> hessian(Projection projection) const;  ///< d2E/dx2 [N/m], for d > 0

 private:
  ClampedLogBarrier barrier_;
  PairDistance<dim> pair_;
  double stiffness_;
  EdgeMollifier mollifier_{0};      ///< fades nothing
  std::optional<EdgeCross> cross_;  ///< cross of edges that fade
};

/// E(to) - E(from) [J] of a pair, the arguments those of `PairBarrier`: with its digits when the two are
/// close. +infinity when the parts touch in `to`.
template <int dim>
double pair_barrier_difference(const ClampedLogBarrier& barrier, PairKind kind,
                               std::span<const Vector<dim>> from, std::span<const Vector<dim>> to,
                               double stiffness,
                               const std::optional<EdgeMollifier>& mollifier = std::nullopt);

}  // namespace resilin
