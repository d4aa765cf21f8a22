#pragma once

#include <Eigen/Core>

#include "resilin/core/types.hpp"

namespace resilin {

/// Rigid motions of one point: rows are its velocity's components, columns the motions of the body it belongs
/// to.
using RigidMotions = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 6>;

/// The translations along the axes, then e x r for each axis e to turn about: z in 2D, x, y and z in 3D.
/// @param r  from the point that does not turn
inline RigidMotions rigid_motions(int dim, const Vector3& r) {
  if (dim == 2) {
    RigidMotions motions(2, 3);
    motions << 1, 0, -r.y(), 0, 1, r.x();
    return motions;
  }
  RigidMotions motions(3, 6);
  motions << 1, 0, 0, 0, r.z(), -r.y(), 0, 1, 0, -r.z(), 0, r.x(), 0, 0, 1, r.y(), -r.x(), 0;
  return motions;
}

}  // namespace resilin
