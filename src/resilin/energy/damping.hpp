#pragma once

#include <memory>
#include <span>
#include <vector>

#include "resilin/energy/elastic.hpp"
#include "resilin/energy/inertia.hpp"
#include "resilin/energy/kernels/viscous_kernels.hpp"

namespace resilin {

/// Viscosities of a cell: S_v = 2 eta Edot + zeta tr(Edot) 1, the second Piola-Kirchhoff stress of the rate
/// of Green's strain.
struct Viscosity {
  double eta = 0;   ///< [Pa s]
  double zeta = 0;  ///< [Pa s]
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
  double dissipation(const VectorX& from, const VectorX& to, double duration) const override;

 private:
  std::unique_ptr<Energy> in_motion(const Stage& stage) const override {
    return std::make_unique<MassDistance>(EnergyCategory::damping, *damping_, stage.base_positions,
                                          stage.duration, "base_positions");
  }

  std::shared_ptr<const MassMatrix> damping_;
};

/// Resistance of a body to its rate of strain. In a stage with v = (x - x_0) / c it is
///
///   E(x) = c/2 v^T D v   with the slope   D v,   D = sum_q V B^T C B,
///
/// D taken at the shape that is expected of the stage (docs/theory/damping.md): symmetric and positive
/// semidefinite.
class ViscousDamping final : public MotionTerm {
 public:
  /// @param body         bound to its pattern; its cells, its quadrature and its places in the matrix serve
  /// here too
  /// @param viscosities  once, or one for each cell of the body
  ViscousDamping(std::shared_ptr<const ElasticEnergy> body, std::span<const Viscosity> viscosities);

  std::string_view name() const override { return "viscous damping"; }
  EnergyProperties properties() const override {
    return {.category = EnergyCategory::damping, .is_quadratic = true};
  }
  double dissipation(const VectorX& from, const VectorX& to, double duration) const override;

  /// Adds D v [N] at a shape, or the sum over the cells of |their parts|.
  /// @param shape  displacements by local node (ElementBlocks::local_displacements) [m]
  void add_forces(const std::vector<double>& shape, const VectorX& v, bool is_magnitude,
                  VectorX& forces) const;
  /// Adds factor D.
  void add_matrix(const std::vector<double>& shape, double factor, BlockMatrix& matrix) const;
  /// Adds factor D of the cells of a tile, see CellMatrices.
  void add_cell_matrices(const std::vector<double>& shape, double factor, const ElasticTiles::Tile& tile,
                         double* K) const;
  const ElasticEnergy& body() const { return *body_; }

  /// Parameters of D v in a stage's term: "viscosities" (eta and zeta, of one cell after another where they
  /// differ), "rest_positions" and "shape".
  std::vector<EnergyParameter> stage_parameters() const;
  /// Adds the slopes of w . D v.
  void add_slopes(std::string_view name, const std::vector<double>& shape, const VectorX& v, const VectorX& w,
                  VectorX& slopes) const;
  /// Adds what a change does to D v to first order.
  void add_change(std::string_view name, const std::vector<double>& shape, const VectorX& v,
                  const VectorX& change, VectorX& forces) const;

 private:
  std::unique_ptr<Energy> in_motion(const Stage& stage) const override;
  template <int dim>
  void add_viscosity_slopes(const std::vector<double>& shape, const VectorX& v, const VectorX& w,
                            VectorX& slopes) const;
  template <int dim>
  void add_slopes_of(std::string_view name, const std::vector<double>& shape, const VectorX& v,
                     const VectorX& w, VectorX& slopes) const;
  template <int dim>
  void add_forces_of(std::string_view name, const std::vector<double>& shape, const VectorX& v,
                     const VectorX& change, VectorX& forces) const;

  std::shared_ptr<const ElasticEnergy> body_;
  const ViscousKernels& kernels_;
  std::vector<double> rows_;  ///< [block][eta, zeta][lane], or one set
  std::size_t stride_ = 0;    ///< stride of ViscosityRows
};

}  // namespace resilin
