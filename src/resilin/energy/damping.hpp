#pragma once

#include <span>
#include <vector>

#include "resilin/element/element.hpp"
#include "resilin/energy/energy.hpp"

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

/// The damping of a stage of a time step: its velocities are v = (x - x_0) / c, so that
///
///   E(x) = c/2 v^T D v   has the slope   D v
///
/// with D at a shape known before (docs/theory/damping.md): symmetric and positive semidefinite.
class StageDamping final : public Energy {
 public:
  /// @param body            kept by reference
  /// @param at              the shape that D is taken at [m]
  /// @param base_positions  x_0 [m]
  /// @param duration        c [s]
  StageDamping(const ViscousBody& body, VectorX at, VectorX base_positions, double duration)
      : body_(body), at_(std::move(at)), base_positions_(std::move(base_positions)), duration_(duration) {}

  std::string_view name() const override { return "damping"; }
  double value(const VectorX& x, const Conditions&) const override {
    const VectorX u = x - base_positions_;
    return 0.5 / duration_ * body_.power(at_, u, u);
  }
  double difference(const VectorX& from, const VectorX& to, const Conditions&) const override {
    return 0.5 / duration_ * body_.power(at_, to - from, (to - base_positions_) + (from - base_positions_));
  }
  void add_gradient(const VectorX& x, const Conditions&, VectorX& gradient) const override {
    body_.add_forces(at_, (x - base_positions_) / duration_, false, gradient);
  }
  void add_gradient_magnitude(const VectorX& x, const Conditions&, VectorX& magnitude) const override {
    body_.add_forces(at_, (x - base_positions_) / duration_, true, magnitude);
  }
  void add_hessian(const VectorX&, const Conditions&, Projection, BlockMatrix& hessian) const override {
    body_.add_matrix(at_, 1 / duration_, hessian);
  }

 private:
  const ViscousBody& body_;
  VectorX at_, base_positions_;
  double duration_;
};

}  // namespace resilin
