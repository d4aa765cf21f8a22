#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "resilin/mesh/box_tree.hpp"
#include "resilin/mesh/inside_grid.hpp"
#include "resilin/mesh/solid_surface.hpp"
#include "resilin/mesh/winding_number.hpp"

namespace resilin {

/// A point of a surface.
struct SurfacePlace {
  Vector3 X;
  Vector3 normal;       ///< normal of length 1; outward where all parts of the surface are wound alike
  Index triangle = -1;  ///< triangle below the point
};

/// Points of a surface: nearest ones, ones spread over its area, its inside.
class SurfacePlaces {
 public:
  /// @param surface  kept by reference
  explicit SurfacePlaces(const SolidSurface& surface);

  const SolidSurface& surface() const { return surface_; }
  /// @param hint  a triangle that may be near, -1 for none: makes the search faster and changes nothing else
  SurfacePlace nearest(const Vector3& p, Index hint = -1) const;
  /// Whether the surface is nearer to a point than `distance`.
  bool is_near(const Vector3& p, double distance) const;

  /// Points spread evenly by area, in the order of the triangles.
  std::vector<SurfacePlace> spread(std::size_t count) const;

  /// Whether the surface winds around the point more than half a time, in whichever direction.
  bool is_inside(const Vector3& p) const {
    const InsideGrid::Side side = grid_.side(p);
    return side == InsideGrid::Side::unknown ? std::abs(winding_(p)) > 0.5 : side == InsideGrid::Side::inside;
  }

  /// Whether the point is outside, where that costs no search; false does not tell.
  bool is_known_outside(const Vector3& p) const { return grid_.side(p) == InsideGrid::Side::outside; }

  /// Makes `is_inside` fast for many points about `distance` or more from the surface; changes nothing else.
  void expect_points(double distance);

  /// Whether the inside is on one side of the point and the outside on the other. False where shells overlap.
  bool is_rim(const SurfacePlace& place) const;
  bool has_overlaps() const { return has_overlaps_; }

  /// Depth of the solid below a point of its surface, along the normal; infinity where nothing is met [m].
  double thickness(const SurfacePlace& place) const;

  /// Volume of the inside [m^3]. Where shells overlap it counts once there, to some hundredths.
  double volume() const { return volume_; }

 private:
  const std::array<Vector3, 3>& corners(Index triangle) const {
    return corners_[static_cast<std::size_t>(triangle)];
  }
  Vector3 nearest_on(Index triangle, const Vector3& p) const;

  const SolidSurface& surface_;
  std::vector<std::array<Vector3, 3>> corners_;
  std::vector<Vector3> areas_;  ///< as vectors [m^2]
  BoxTree tree_;
  WindingNumber winding_;
  InsideGrid grid_;    ///< knows no side before `expect_points`
  double extent_ = 0;  ///< extent of the box [m]
  bool has_overlaps_ = false;
  double volume_ = 0;
};

}  // namespace resilin
