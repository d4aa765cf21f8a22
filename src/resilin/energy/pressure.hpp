#pragma once

#include "resilin/energy/dead_load.hpp"

namespace resilin {

/// Pressure on a part of the surface; it follows the surface: f_a = -t p integral N_a n da.
///
/// On a closed surface, or one whose edge is held, it is the slope of t p V, V the volume inside. Else it has
/// no potential; `difference` is then the exact work along the straight path between the two states (the
/// force is quadratic in the path, so Simpson's rule is exact) and the Hessian the symmetric part of the
/// tangent.
class Pressure final : public BasicEnergy {
 public:
  /// @param facets  of one kind, outward, in the world's node numbers
  Pressure(std::string name, int dim, CellBlock facets, double pressure, VectorX rest_positions,
           ActiveTime active = {});

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
  std::vector<EnergyParameter> parameters() const override { return {{"value"}}; }
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override;
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override;
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override;

  const CellBlock& facets() const { return facets_; }
  /// Under these conditions [Pa].
  double pressure(const Conditions& c) const { return factor(c); }
  double full_pressure() const { return pressure_; }  ///< at factor 1 [Pa]

 private:
  double factor(const Conditions& c) const { return active_.factor(c) * pressure_; }
  void add_forces(const VectorX& x, double pressure, VectorX& forces) const;
  void add_facet_hessian(std::span<const Index> nodes, const VectorX& x, double p,
                         BlockMatrix& hessian) const;

  std::string name_;
  int dim_;
  CellBlock facets_;
  const std::vector<FacetPoint>& points_;
  double pressure_;  ///< [Pa]
  VectorX rest_positions_;
  ActiveTime active_;
};

}  // namespace resilin
