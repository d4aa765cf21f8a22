#pragma once

#include "resilin/energy/mass.hpp"
#include "resilin/energy/motion_term.hpp"

namespace resilin {

/// Mass-weighted distance of bodies from given positions: E = 1/(2 s) |x - x~|^2_M.
class MassDistance final : public BasicEnergy {
 public:
  /// @param mass    kept by reference: must outlive this term
  /// @param target  x~ [m], dim numbers per node
  /// @param scale   s, so that E is an energy
  /// @param target_name  of the place among the term's parameters
  MassDistance(EnergyCategory category, const MassMatrix& mass, VectorX target, double scale,
               std::string_view target_name = "target")
      : category_(category),
        mass_(mass),
        target_(std::move(target)),
        scale_(scale),
        target_name_(target_name) {}

  std::string_view name() const override { return "mass distance"; }
  EnergyProperties properties() const override { return {.category = category_, .is_quadratic = true}; }
  double value(const VectorX& x, const Conditions&) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions&) const override;
  void add_gradient(const VectorX& x, const Conditions&, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions&, VectorX& magnitude) const override;
  void add_hessian(const VectorX&, const Conditions&, Projection, BlockMatrix& hessian) const override {
    mass_.add_to(1 / scale_, hessian);
  }
  /// The entries of the mass matrix, and the place.
  std::vector<EnergyParameter> parameters() const override {
    return {{"mass", mass_.num_entries()}, {target_name_, target_.size()}};
  }
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override;
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override;

 private:
  EnergyCategory category_;
  const MassMatrix& mass_;
  VectorX target_;
  double scale_;
  std::string_view target_name_;
};

/// Inertial term that an implicit time step minimises besides the potential energy: the distance to x~, where
/// the nodes would go without forces, with the integrator's scale s [s^2] (docs/theory/integrators.md).
class Inertia final : public MotionTerm {
 public:
  explicit Inertia(std::shared_ptr<const MassMatrix> mass) : mass_(std::move(mass)) {}

  std::string_view name() const override { return "inertia"; }
  EnergyProperties properties() const override {
    return {.category = EnergyCategory::inertia, .is_quadratic = true};
  }

 private:
  std::unique_ptr<Energy> in_motion(const Stage& stage) const override {
    return std::make_unique<MassDistance>(EnergyCategory::inertia, *mass_, stage.target(), stage.scale());
  }

  std::shared_ptr<const MassMatrix> mass_;
};

}  // namespace resilin
