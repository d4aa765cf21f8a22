#pragma once

#include <vector>

#include "resilin/energy/energy.hpp"
#include "resilin/energy/material_point.hpp"

namespace resilin {

/// A spring from a place of a body to a point in space that never pulls harder than `max_force`. With y the
/// place, d = |y - target| and r = max_force / stiffness:
///
///   E = k/2 d^2            for d <= r
///   E = k r d - k/2 r^2    beyond (Huber's function: convex, so its Hessian is never negative)
class Hand final : public BasicEnergy {
 public:
  /// @param stiffness  k [N/m]
  /// @param max_force  [N], positive
  Hand(int dim, MaterialPoint place, Vector3 target, double stiffness, double max_force);

  std::string_view name() const override { return "hand"; }
  EnergyProperties properties() const override { return {}; }
  double value(const VectorX& x, const Conditions&) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions&) const override;
  void add_gradient(const VectorX& x, const Conditions&, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions&, VectorX& magnitude) const override;
  void add_hessian(const VectorX& x, const Conditions&, Projection, BlockMatrix& hessian) const override;

  Vector3 force(const VectorX& x) const;  ///< on the body [N]

 private:
  Vector3 stretch(const VectorX& x) const { return place_.position(dim_, x) - target_; }
  bool is_yielding(double distance) const { return stiffness_ * distance > max_force_; }

  int dim_;
  MaterialPoint place_;
  Vector3 target_;
  double stiffness_;
  double max_force_;
};

}  // namespace resilin
