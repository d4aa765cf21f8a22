#pragma once

#include <Eigen/Core>
#include <span>

#include "resilin/core/types.hpp"

namespace resilin {

/// Dense matrix of any size, column by column.
using DenseMatrix = Eigen::MatrixXd;

/// Predictions of a law for measured numbers, as a function of its constants. The solvers know nothing else
/// of a homogeneous test (homogeneous_model.hpp).
class PredictedValues {
 public:
  virtual ~PredictedValues() = default;
  virtual Eigen::Index size() const = 0;

  /// The values, and their slopes by the constants of these places (a column each; exact). Either may be
  /// null. False when there are none: outside the law's domain, or no equilibrium.
  virtual bool evaluate(std::span<const double> constants, std::span<const int> places, VectorX* values,
                        DenseMatrix* slopes) const = 0;
};

}  // namespace resilin
