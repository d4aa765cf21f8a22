#pragma once

#include <span>
#include <vector>

#include "resilin/element/element.hpp"
#include "resilin/energy/inertia.hpp"

namespace resilin {

/// Viscosities of a cell: S_v = 2 eta Edot + zeta tr(Edot) 1, the second Piola-Kirchhoff stress of the rate
/// of Green's strain.
struct Viscosity {
  double eta = 0;   ///< [Pa s]
  double zeta = 0;  ///< [Pa s]
};

/// The cells of a body that resist their rate of strain.
class ViscousBody {
 public:
  /// @param cells        nodes in the world, those of one cell after another
  /// @param viscosities  once, or one for each cell
  ViscousBody(int dim, const ElementInfo& element, const QuadratureRule& rule, std::span<const Index> cells,
              const VectorX& rest_positions, std::vector<Viscosity> viscosities);

  /// u^T D w [W], D = sum_q V B^T C B the damping matrix at the shape `at`.
  double power(const VectorX& at, const VectorX& u, const VectorX& w) const;
  /// Adds D v [N], or the sum over the points of |their parts|.
  void add_forces(const VectorX& at, const VectorX& v, bool is_magnitude, VectorX& forces) const;
  /// Adds factor D.
  void add_matrix(const VectorX& at, double factor, BlockMatrix& matrix) const;

 private:
  /// Calls `visit(nodes, gradients, F, weight, viscosity)` for every point.
  template <class Visit>
  void for_each_point(const VectorX& at, const Visit& visit) const;

  int dim_;
  std::size_t nodes_per_cell_;
  std::size_t points_per_cell_;
  std::vector<Index> cells_;
  std::vector<double> weights_;    ///< [cell][point]
  std::vector<double> gradients_;  ///< [cell][point][node][dim]
  std::vector<Viscosity> viscosities_;
};

/// Damping in proportion to mass: a force -D v with D = alpha M. In a stage with v = (x - x_0) / c it is the
/// slope of c/2 v^T D v, a distance with the scale c.
class MassDamping final : public MotionTerm {
 public:
  /// @param damping  alpha M [kg/s]
  explicit MassDamping(std::shared_ptr<const MassMatrix> damping) : damping_(std::move(damping)) {}

  std::string_view name() const override { return "mass damping"; }
  EnergyProperties properties() const override {
    return {.category = EnergyCategory::damping, .is_quadratic = true};
  }

 private:
  std::unique_ptr<Energy> in_motion(const Stage& stage) const override {
    return std::make_unique<MassDistance>(EnergyCategory::damping, *damping_, stage.base_positions,
                                          stage.duration);
  }

  std::shared_ptr<const MassMatrix> damping_;
};

/// Resistance of a body to its rate of strain. In a stage with v = (x - x_0) / c it is
///
///   E(x) = c/2 v^T D v   with the slope   D v,
///
/// D taken at the shape that is expected of the stage (docs/theory/damping.md): symmetric and positive
/// semidefinite.
class ViscousDamping final : public MotionTerm {
 public:
  explicit ViscousDamping(ViscousBody body) : body_(std::move(body)) {}

  std::string_view name() const override { return "viscous damping"; }
  EnergyProperties properties() const override {
    return {.category = EnergyCategory::damping, .is_quadratic = true};
  }
  const ViscousBody& body() const { return body_; }

 private:
  std::unique_ptr<Energy> in_motion(const Stage& stage) const override;

  ViscousBody body_;
};

}  // namespace resilin
