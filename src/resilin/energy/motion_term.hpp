#pragma once

#include "resilin/energy/energy.hpp"

namespace resilin {

/// A term that acts only while time passes: zero by itself, and something in the stages of a step in motion,
/// whose velocities follow from their positions.
class MotionTerm : public Energy {
 public:
  double value(const VectorX&, const Conditions&) const final { return 0; }
  double difference(const VectorX&, const VectorX&, const Conditions&) const final { return 0; }
  void add_gradient(const VectorX&, const Conditions&, VectorX&) const final {}
  void add_gradient_magnitude(const VectorX&, const Conditions&, VectorX&) const final {}
  void add_hessian(const VectorX&, const Conditions&, Projection, BlockMatrix&) const final {}

  std::unique_ptr<Energy> begin_stage(const Stage& stage) const final {
    return stage.is_static() ? nullptr : in_motion(stage);
  }

 private:
  virtual std::unique_ptr<Energy> in_motion(const Stage& stage) const = 0;
};

}  // namespace resilin
