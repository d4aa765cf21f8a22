#pragma once

#include <array>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// The soft shadow that bodies throw straight down: dark where they touch what lies below them, faint where
/// they are high above it.
class GroundShadow {
 public:
  /// @param triangles  corners of the surfaces of the bodies [m]
  /// @param up         of length 1
  GroundShadow(const std::vector<std::array<Vector3, 3>>& triangles, const Vector3& up);

  /// How much of the light at a place is missing, 0 to 1.
  double at(const Vector3& place) const;

 private:
  std::array<double, 2> cell_of(const Vector3& place) const;
  void cover(const std::array<Vector3, 3>& corners);

  Vector3 up_, right_, front_;
  double low_right_ = 0, low_front_ = 0;  ///< corner of the map [m]
  double step_ = 1;                       ///< step of the map [m]
  double fading_ = 1;                     ///< height at which a shadow is half as dark [m]
  int columns_ = 1, rows_ = 1;
  std::vector<float> lowest_;  ///< height of the lowest part of a body above each place of the map [m]
};

}  // namespace resilin
