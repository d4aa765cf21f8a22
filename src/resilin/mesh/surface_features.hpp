#pragma once

#include <vector>

#include "resilin/mesh/solid_surface.hpp"

namespace resilin {

/// A line along which a surface has a sharp edge.
struct CreaseLine {
  std::vector<Vector3> points;  ///< along the line; a closed one has its first point last again
  std::vector<double> lengths;  ///< from the first point to each [m]
  Index first = -1, last = -1;  ///< corners at its ends, in `SurfaceFeatures::corners`; -1 for a closed line
  double turning = 0;           ///< sum of the angles at its inner points [rad]

  bool is_closed() const { return first < 0; }
  double length() const { return lengths.back(); }
  Vector3 at(double s) const;
  /// Length up to the nearest point of the line.
  double nearest(const Vector3& p) const;
};

/// Sharp edges of a surface, such as those of a part from CAD.
struct SurfaceFeatures {
  std::vector<Vector3> corners;
  std::vector<CreaseLine> lines;
};

/// Edges whose triangles enclose more than 35 degrees between their normals, and edges of three triangles or
/// more. Lines end where other than two meet and where they turn by more than 45 degrees.
///
/// @param finest  groups of lines that hang together are passed over where they are shorter than this, or are
///                branches whose mean length is below half of it, such as the noise of a scan [m]
SurfaceFeatures find_features(const SolidSurface& surface, double finest);

}  // namespace resilin
