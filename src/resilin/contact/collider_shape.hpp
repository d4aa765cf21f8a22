#pragma once

#include <limits>
#include <string_view>

#include "resilin/contact/collider_mesh.hpp"
#include "resilin/core/types.hpp"

namespace resilin {

/// A solid that bodies stay out of, as the signed distance to its surface: positive outside.
///
/// In 2D all points have z = 0 and the shape is its section there.
class ColliderShape {
 public:
  virtual ~ColliderShape() = default;
  virtual std::string_view kind() const = 0;

  /// Whether its surface is one plane (in 2D a line), the same everywhere.
  virtual bool is_flat() const { return false; }

  /// The point that a motion of the shape is told by [m].
  virtual Vector3 reference_point() const = 0;

  /// Radius of a ball about that point [m]; 0: the shape is no ball.
  virtual double radius() const { return 0; }

  /// Its surface for whoever draws it. Of one without end a square, in 2D a line, that reaches so far around
  /// the place below `middle` [m].
  virtual ColliderMesh facets(int dim, const Vector3& middle, double reach) const = 0;

  /// Signed distance d [m], also inside.
  virtual double distance(const Vector3& x) const = 0;

  /// d(to) - d(from), with its digits when the two are close.
  virtual double distance_change(const Vector3& from, const Vector3& to) const = 0;

  /// grad d: the unit normal, away from the solid.
  virtual Vector3 normal(const Vector3& x) const = 0;

  /// Hessian of d [1/m]; zero for a plane. The normal is in its kernel.
  virtual Eigen::Matrix3d curvature(const Vector3& x) const = 0;

  /// The first t >= 0 at which x + t p has come as near as `distance`, less than it has now; infinity when it
  /// never does.
  virtual double time_of_approach(const Vector3& x, const Vector3& p, double distance) const = 0;
};

}  // namespace resilin
