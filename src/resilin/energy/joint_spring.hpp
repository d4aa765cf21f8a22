#pragma once

#include <array>
#include <optional>
#include <string>

#include "resilin/energy/joint_coordinate.hpp"
#include "resilin/energy/motor.hpp"

namespace resilin {

/// An energy of the coordinate q of a joint, by one of
///
///   spring     E = k/2 (q - q_0 - goal(t))^2
///   stop       E = k/2 (distance of q from [low, high])^2
///   effort     E = -f(t) T q
///
/// Differences of angles are taken in (-pi, pi], for a stop from the middle of its interval.
///
/// Hessian: E'' dq dq^T + E' d2q/dx2. As dense matrices of the few vectors that q follows from, both are
/// projected together.
class JointSpring final : public BasicEnergy {
 public:
  struct Law {
    double stiffness = 0;                           ///< k [N/m or N m]
    double rest = 0;                                ///< q_0 [m or rad]
    std::optional<std::array<double, 2>> limits{};  ///< low and high: a stop
    std::optional<double> effort{};                 ///< T [N or N m]
    MotorGoal goal{};
    bool is_motor = false;
  };

  JointSpring(std::string name, JointCoordinate coordinate, Law law);

  std::string_view name() const override { return name_; }
  EnergyProperties properties() const override {
    return {.category = law_.is_motor ? EnergyCategory::external : EnergyCategory::elastic};
  }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override;
  void add_pattern(BlockPatternBuilder& builder) const override { coordinate_.add_pattern(builder); }
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override;

  /// A spring has "stiffness" and "rest", a motor its "effort", or "position" and "velocity", a stop none.
  std::vector<EnergyParameter> parameters() const override;
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override;
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override;

  const JointCoordinate& coordinate() const { return coordinate_; }

 private:
  /// q less what it is pulled to, or the middle of a stop.
  double offset(double q, const Conditions& c) const;
  /// How much of an offset is stretch: for a stop what lies beyond it.
  double stretch(double offset) const;
  double effort(const Conditions& c) const;
  double slope(double offset, const Conditions& c) const;
  double slope_by(std::string_view parameter, double offset, const Conditions& c) const;

  std::string name_;
  JointCoordinate coordinate_;
  Law law_;
};

}  // namespace resilin
