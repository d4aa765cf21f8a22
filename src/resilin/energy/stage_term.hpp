#pragma once

#include "resilin/energy/energy.hpp"

namespace resilin {

/// A term that is zero by itself, and something in the stages of a step, where it is known how bodies came to
/// where they are.
class StageTerm : public BasicEnergy {
 public:
  double value(const VectorX&, const Conditions&) const final { return 0; }
  double difference(const VectorX&, const VectorX&, const Conditions&) const final { return 0; }
  void add_gradient(const VectorX&, const Conditions&, VectorX&) const final {}
  void add_gradient_magnitude(const VectorX&, const Conditions&, VectorX&) const final {}
  void add_hessian(const VectorX&, const Conditions&, Projection, BlockMatrix&) const final {}
};

}  // namespace resilin
