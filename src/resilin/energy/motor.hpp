#pragma once

#include <string>
#include <vector>

#include "resilin/energy/cable.hpp"

namespace resilin {

/// The motor of a hinge, which turns a body by f(t) position against another one or the ground:
///
///   E = k / (2 r^2) |p - (c + r (cos a u + sin a v))|^2 = k (1 - cos d),   a = f(t) position,
///
/// p is a point of the body at the distance r from the centre c; u and v are directions across the axis that
/// the other body carries. d is what is missing of the angle.
class Motor final : public BasicEnergy {
 public:
  struct Arms {
    CarriedPoint turned;                 ///< p
    CarriedPoint centre, along, across;  ///< c, c + r u, c + r v
  };

  Motor(std::string name, int dim, Arms arms, double radius, double stiffness, double position,
        TimeFunction function);

  std::string_view name() const override { return name_; }
  EnergyProperties properties() const override { return {.category = EnergyCategory::external}; }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override;
  void add_pattern(BlockPatternBuilder& builder) const override;
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override;

  double angle(const Conditions& c) const { return position_ * function_.factor(c.time, c.load); }
  double stiffness() const { return stiffness_; }

 private:
  /// The gap as a sum of weights times nodes, and a part of the ground.
  CarriedPoint gap_at(const Conditions& c) const;

  std::string name_;
  int dim_;
  Arms arms_;
  double factor_;     ///< k / r^2 [N/m]
  double stiffness_;  ///< k [N m]
  double position_;   ///< [rad]
  TimeFunction function_;
};

}  // namespace resilin
