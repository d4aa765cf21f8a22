#pragma once

#include "resilin/energy/energy.hpp"
#include "resilin/energy/mass.hpp"

namespace resilin {

/// What an implicit time step minimises besides the potential energy:
///
///   E = 1/(2 s) |x - x~|^2_M
///
/// x~ is where the nodes would go without forces and s [s^2] the integrator's scale
/// (docs/theory/integrators.md).
class Inertia final : public Energy {
 public:
  /// @param mass    kept by reference: must outlive this term
  /// @param target  x~ [m], dim numbers per node
  /// @param scale   s [s^2]
  Inertia(const MassMatrix& mass, VectorX target, double scale)
      : mass_(mass), target_(std::move(target)), scale_(scale) {}

  std::string_view name() const override { return "inertia"; }
  double value(const VectorX& x, const Conditions&) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions&) const override;
  void add_gradient(const VectorX& x, const Conditions&, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions&, VectorX& magnitude) const override;
  void add_hessian(const VectorX&, const Conditions&, Projection, BlockMatrix& hessian) const override {
    mass_.add_to(1 / scale_, hessian);
  }

 private:
  const MassMatrix& mass_;
  VectorX target_;
  double scale_;
};

}  // namespace resilin
