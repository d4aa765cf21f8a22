#pragma once

#include <memory>

#include "resilin/optimize/exact_stiffness.hpp"
#include "resilin/optimize/newton.hpp"

namespace resilin {

/// Objectives E(x; t), one for each load factor t, whose gradients are affine in t, and the places of the
/// fixed unknowns in them.
class LoadFamily {
 public:
  virtual ~LoadFamily() = default;
  virtual std::unique_ptr<Objective> at(double load) const = 0;
  virtual void place_fixed(double load, VectorX& x) const = 0;
};

/// A point of the equilibrium path: positions [m] and load factor.
struct PathPoint {
  VectorX positions;
  double load = 0;
};

/// Tolerance, limits and step of an arc-length search.
struct PathSettings {
  double tolerance = 1e-8;  ///< tolerance of the force residual, as in NewtonSettings
  int max_iterations = 20;  ///< maximum iterations of the search for one point
  double arc_length = 0;    ///< [m]: sqrt(|du|^2 + load_weight^2 dt^2) from point to point ...
  double load_weight = 0;   ///< ... [m], over the free unknowns
};

/// Follows the equilibria of a family through limit points, where the load has a maximum or a minimum and no
/// load control finds a neighbour.
///
/// A step solves g(x; t) = 0 with |x - x0|^2 + load_weight^2 (t - t0)^2 = arc_length^2 by Newton's method on
/// both, the matrix bordered by the constraint: two right-hand sides with one factorisation of the exact
/// stiffness, which may be indefinite. Theory: docs/theory/statics.md. Sources: Riks 1979; Crisfield 1981
/// (sphere); Ritto-Correa & Camotim 2008 (linearised constraint, which needs no choice of a root).
class PathFollower {
 public:
  PathFollower(int dim, const std::shared_ptr<const BlockPattern>& pattern)
      : stiffness_(dim, pattern), parts_(*pattern) {}

  /// dx/dt at an equilibrium [m per unit of load], the fixed unknowns included. False where the stiffness is
  /// singular.
  bool tangent(const LoadFamily& family, std::span<const std::uint8_t> is_fixed, const PathPoint& at,
               VectorX& slope);

  /// The next equilibrium after `point` on the side away from `previous`; where the two are the same, on the
  /// side of a growing load. `point` moves only when the report says converged.
  NewtonReport advance(const LoadFamily& family, std::span<const std::uint8_t> is_fixed,
                       const PathSettings& settings, const PathPoint& previous, PathPoint& point,
                       const NewtonObserver& observer = {});

  /// The equilibrium at the load of `point`, stable or not, from its positions.
  NewtonReport settle(const LoadFamily& family, std::span<const std::uint8_t> is_fixed,
                      const PathSettings& settings, PathPoint& point, const NewtonObserver& observer = {});

 private:
  struct Search;

  ExactStiffness stiffness_;
  ConnectedComponents parts_;
};

}  // namespace resilin
