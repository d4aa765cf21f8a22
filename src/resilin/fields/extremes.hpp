#pragma once

#include <optional>

#include "resilin/fields/evaluator.hpp"

namespace resilin {

/// Where a field is smallest or largest.
struct Extreme {
  double value = 0;
  std::size_t body = 0;
  Index number = 0;  ///< number of the vertex or cell in its body
  Vector3 position =
      Vector3::Zero();  ///< position of the vertex, or of the mean of the cell's nodes, deformed [m]
};

/// Smallest and largest value of a field, and where they are.
struct Extremes {
  Extreme min, max;
};

/// Scalars by value, vectors by length, principal stresses by the smallest and the largest of all three.
/// Empty for directions and tensors, and when no value is a finite number; others are passed over.
std::optional<Extremes> extremes(const World& world, const State& state, const FieldValues& values);

}  // namespace resilin
