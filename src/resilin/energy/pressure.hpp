#pragma once

#include <vector>

#include "resilin/energy/dead_load.hpp"

namespace resilin {

/// Pressure on a part of the surface; it follows the surface: f = -t p n da, shared equally by a facet's
/// nodes.
///
/// On a closed surface, or one whose edge is held, it is the slope of t p V, V the volume inside. Else it has
/// no potential; `difference` is then the exact work along the straight path between the two states (the
/// force is quadratic in the path, so Simpson's rule is exact) and the Hessian the symmetric part of the
/// tangent.
class Pressure final : public Energy {
 public:
  Pressure(std::string name, int dim, std::vector<LoadedFacet> facets, double pressure,
           VectorX rest_positions, ActiveTime active = {});

  std::string_view name() const override { return name_; }
  double value(const VectorX& x, const Conditions& c) const override {
    return difference(rest_positions_, x, c);
  }
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_pattern(BlockPatternBuilder& builder) const override;
  void add_hessian(const VectorX& x, const Conditions& c, Projection, BlockMatrix& hessian) const override;

 private:
  double factor(const Conditions& c) const { return c.load * active_.factor(c.time) * pressure_; }

  std::string name_;
  int dim_;
  std::vector<LoadedFacet> facets_;
  double pressure_;  ///< [Pa]
  VectorX rest_positions_;
  ActiveTime active_;
};

}  // namespace resilin
