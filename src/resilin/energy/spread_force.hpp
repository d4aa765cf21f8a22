#pragma once

#include <optional>
#include <vector>

#include "resilin/energy/dead_load.hpp"

namespace resilin {

/// A total force or moment on facets, as a traction that is linear over their area in the rest shape:
///
///   t(X) = F / A + w x (X - c),    J w = M,    J = integral |X - c|^2 1 - (X - c)(X - c)^T dA,
///
/// with c the centroid of the area A. The nodal forces f_a = integral N_a t dA are statically equivalent to
/// the force F at c together with the moment M about it. A force that attacks at P has M = (P - c) x F.
class SpreadForce final : public LoadedRegion {
 public:
  enum class Kind { force, moment };

  /// @param facets  of one kind, in the world's node numbers
  /// @param point   where a force attacks [m]; without one at the centroid. Not of a moment
  SpreadForce(Kind kind, int dim, CellBlock facets, const std::optional<Vector3>& point = {});

  void add_forces(const Vector3& value, const VectorX& X, VectorX& forces) const override;
  void add_force_change(const Vector3& value, const VectorX& X, const VectorX& change,
                        VectorX& forces) const override;
  void add_rest_slopes(const Vector3& value, const VectorX& X, const VectorX& w,
                       VectorX& slopes) const override;
  /// A moment in the plane is one number, the third component of the value.
  int value_size(int dim) const override { return is_moment() && dim == 2 ? 1 : dim; }
  Vector3 value_slopes(int dim, const VectorX& X, const VectorX& w) const override;

  const CellBlock& facets() const { return facets_; }  ///< in the world's node numbers

  /// The traction [N/m^2] (2D: on unit thickness) of a value.
  struct Traction {
    Vector3 uniform = Vector3::Zero();  ///< F / A
    Vector3 spin = Vector3::Zero();     ///< w
    Vector3 center = Vector3::Zero();   ///< c [m]
    Vector3 at(const Vector3& X) const { return uniform + spin.cross(X - center); }
  };
  Traction traction(const Vector3& value, const VectorX& X) const;

 private:
  struct Geometry {
    double area = 0;
    Vector3 center = Vector3::Zero();
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< J
  };
  bool is_moment() const { return kind_ == Kind::moment; }
  bool turns() const { return is_moment() || point_.has_value(); }
  Geometry geometry(const VectorX& X) const;
  /// J^-1 M; in 2D about the third axis alone.
  Vector3 solve(const Eigen::Matrix3d& inertia, const Vector3& moment) const;
  Vector3 force(const Vector3& value) const { return is_moment() ? Vector3(Vector3::Zero()) : value; }
  Vector3 moment(const Vector3& value, const Vector3& center) const;

  Kind kind_;
  int dim_;
  CellBlock facets_;
  std::optional<Vector3> point_;
  std::vector<FacetPoint> points_;  ///< integrate products of two shape functions
};

}  // namespace resilin
