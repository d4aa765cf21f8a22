#pragma once

#include "resilin/energy/dead_load.hpp"

// Loads on the boundary of axisymmetric solids, over the whole ring (docs/theory/axisymmetry.md).
namespace resilin {

/// A dead load along a boundary line: a traction [N/m^2] or, `is_total`, a force [N] per full turn that is
/// spread by area. f_a = value integral N_a 2 pi R dS.
class RingTraction final : public LoadedRegion {
 public:
  RingTraction(CellBlock facets, bool is_total) : facets_(std::move(facets)), is_total_(is_total) {}
  void add_forces(const Vector3& value, const VectorX& X, VectorX& forces) const override;
  /// Derivatives of axisymmetric solids are refused before: nothing.
  void add_force_change(const Vector3&, const VectorX&, const VectorX&, VectorX&) const override {}
  void add_rest_slopes(const Vector3&, const VectorX&, const VectorX&, VectorX&) const override {}
  const CellBlock& facets() const { return facets_; }  ///< in the world's node numbers

 private:
  CellBlock facets_;
  bool is_total_;
};

/// Follower pressure on a boundary line at its current radius: f_a = -t p integral N_a n 2 pi r ds. On a
/// closed boundary it is the slope of t p V, V being the volume of the ring.
class RingPressure final : public BasicEnergy {
 public:
  /// @param facets  of one kind, the body on their left, in the world's node numbers
  RingPressure(std::string name, CellBlock facets, double pressure, VectorX rest_positions,
               ActiveTime active);

  std::string_view name() const override { return name_; }
  EnergyProperties properties() const override { return {.has_potential = false}; }
  double value(const VectorX& x, const Conditions& c) const override {
    return difference(rest_positions_, x, c);
  }
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_pattern(BlockPatternBuilder& builder) const override;
  void add_hessian(const VectorX& x, const Conditions& c, Projection, BlockMatrix& hessian) const override;
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override;
  const CellBlock& facets() const { return facets_; }  ///< in the world's node numbers
  /// Nodal forces at factor 1 when bodies stand at x [N].
  void add_full_forces(const VectorX& x, VectorX& forces) const;

 private:
  double factor(const Conditions& c) const { return active_.factor(c) * pressure_; }
  /// Adds the forces of a pressure [N].
  void add_forces(const VectorX& x, double pressure, VectorX& forces) const;

  std::string name_;
  CellBlock facets_;
  double pressure_;  ///< [Pa]
  VectorX rest_positions_;
  ActiveTime active_;
};

}  // namespace resilin
