#pragma once

#include <string>

#include "resilin/energy/joint_coordinate.hpp"
#include "resilin/energy/motion_term.hpp"

namespace resilin {

/// The damper of a joint, a force -d dq/dt on its coordinate q. In a stage with v = (x - x_0) / c it is
///
///   E(x) = c d/2 (g . v)^2,   g = dq/dx at the shape that is expected of the stage.
class JointDamper final : public MotionTerm {
 public:
  /// @param damping  d [N s/m or N m s]
  JointDamper(std::string name, JointCoordinate coordinate, double damping)
      : name_(std::move(name)), coordinate_(std::move(coordinate)), damping_(damping) {}

  std::string_view name() const override { return name_; }
  EnergyProperties properties() const override {
    return {.category = EnergyCategory::damping, .is_quadratic = true};
  }
  void add_pattern(BlockPatternBuilder& builder) const override { coordinate_.add_pattern(builder); }
  double dissipation(const VectorX& from, const VectorX& to, double duration) const override;

  /// dE/dx of the damper in a motion [N].
  void add_gradient_in_motion(const VectorX& x, const VectorX& velocities, VectorX& gradient) const {
    coordinate_.add_forces(damping_ * coordinate_.rate(x, velocities) * coordinate_.slopes(x), gradient);
  }

 private:
  std::unique_ptr<Energy> in_motion(const Stage& stage) const override;

  std::string name_;
  JointCoordinate coordinate_;
  double damping_;
};

}  // namespace resilin
