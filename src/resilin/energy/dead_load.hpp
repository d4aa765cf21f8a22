#pragma once

#include <cmath>
#include <span>

#include "resilin/element/element.hpp"
#include "resilin/energy/energy.hpp"
#include "resilin/energy/time_function.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {

/// When a load acts, from < t <= until [s], and how strongly.
struct ActiveTime {
  double from = -std::numeric_limits<double>::infinity();
  double until = std::numeric_limits<double>::infinity();
  TimeFunction function{};

  /// Times are met to a small part of a step, so that a window that ends at a step's end includes that step.
  bool contains(double time) const;
  /// What counts of the load: the function's value or the load factor, zero outside its time.
  double factor(const Conditions& c) const { return contains(c.time) ? function.factor(c.time, c.load) : 0; }
  bool is_always() const {
    return function.is_constant() && from == -until && until > 0 && std::isinf(until);
  }
};

/// The largest of the works at the two ends of a way that a change of conditions may do on a term: its energy
/// after the change less that before.
double larger_work(const Energy& term, const VectorX& from, const Conditions& before, const VectorX& to,
                   const Conditions& after);

/// Forces that keep their size and direction while the body deforms: E = -t f.(x - X), t the load factor or
/// the function of time.
class DeadLoad final : public Energy {
 public:
  DeadLoad(std::string name, VectorX nodal_forces, VectorX rest_positions, ActiveTime active = {})
      : name_(std::move(name)),
        forces_(std::move(nodal_forces)),
        rest_positions_(std::move(rest_positions)),
        active_(std::move(active)) {}

  std::string_view name() const override { return name_; }
  EnergyProperties properties() const override { return {.is_quadratic = true}; }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_hessian(const VectorX&, const Conditions&, Projection, BlockMatrix&) const override {}
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override;

 private:
  double factor(const Conditions& c) const { return active_.factor(c); }

  std::string name_;
  VectorX forces_;  ///< [N]
  VectorX rest_positions_;
  ActiveTime active_;
};

/// Adds a traction [N/m^2] (2D: [N/m^2] on unit thickness) over the facets of the rest shape to nodal forces
/// [N]: f_a += traction integral N_a dA.
void add_traction(int dim, const CellBlock& facets, const VectorX& rest_positions, const Vector3& traction,
                  VectorX& nodal_forces);

/// Adds a force per rest volume [N/m^3] on cells to nodal forces [N]: f_a += force integral N_a dV.
/// @param cells  nodes in the world, those of one cell after another
void add_body_force(const ElementInfo& element, std::span<const Index> cells, const VectorX& rest_positions,
                    const Vector3& force, VectorX& nodal_forces);

}  // namespace resilin
