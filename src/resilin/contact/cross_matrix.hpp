#pragma once

#include "resilin/core/types.hpp"

namespace resilin {

/// [a] with [a] b = a x b.
inline Eigen::Matrix3d cross_matrix(const Vector3& a) {
  Eigen::Matrix3d matrix;
  matrix << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return matrix;
}

}  // namespace resilin
