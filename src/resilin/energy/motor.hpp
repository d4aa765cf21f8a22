#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "resilin/energy/cable.hpp"

namespace resilin {

/// The value that a motor drives the coordinate of a joint to: f(t) position + velocity integral f dt from 0
/// to t.
struct MotorGoal {
  double position = 0;  ///< [rad or m]
  double velocity = 0;  ///< [rad/s or m/s]
  TimeFunction function{};

  double at(const Conditions& c) const;
  /// Its derivative by "position" or "velocity".
  double at_by(std::string_view parameter, const Conditions& c) const;
  /// Whether it is not known to be the same under both conditions.
  bool moves(const Conditions& before, const Conditions& after) const {
    return (velocity != 0 && before.time != after.time) || !function.is_constant() ||
           before.load != after.load;
  }
};

/// The motor of a hinge, which turns a body by an angle a against another one or the ground:
///
///   E = k / (2 r^2) |p - (c + r (cos a u + sin a v))|^2 = k (1 - cos d)
///
/// p is a point of the body at the distance r from the centre c; u and v are directions across the axis that
/// the other body carries. d is what is missing of the angle.
class Motor final : public BasicEnergy {
 public:
  struct Arms {
    CarriedPoint turned;                 ///< p
    CarriedPoint centre, along, across;  ///< c, c + r u, c + r v
  };

  Motor(std::string name, int dim, Arms arms, double radius, double stiffness, MotorGoal goal);

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
  std::vector<EnergyParameter> parameters() const override { return {{"position"}, {"velocity"}}; }
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override;
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override;

 private:
  /// The gap as a sum of weights times nodes, and a part of the ground.
  CarriedPoint gap_at(const Conditions& c) const;
  /// Its derivative by the angle.
  CarriedPoint gap_by_angle(const Conditions& c) const;
  /// A sum of the points of the arms: one of p and these of c, u and v.
  CarriedPoint sum_of(double turned, double centre, double along, double across) const;

  std::string name_;
  int dim_;
  Arms arms_;
  double factor_;  ///< k / r^2 [N/m]
  MotorGoal goal_;
};

}  // namespace resilin
