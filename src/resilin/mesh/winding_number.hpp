#pragma once

#include <array>
#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Winding number of a surface around a point, also for a surface with holes:
///
///   w(X) = 1 / (4 pi) sum_triangles (solid angle seen from X)
///
/// 1 inside a closed surface that is wound outwards, -1 inside one wound inwards, 0 outside; near a flat hole
/// it passes 1/2 where the lid would be. Triangles that are far off are taken together, by the moments of
/// their dipoles up to the second, so that a point costs O(log n); that errs by a few hundredths, for thick
/// shells with a cavity too, whose walls cancel each other's dipoles.
///
/// Source: Jacobson, Kavan & Sorkine 2013, "Robust inside-outside segmentation using generalized winding
/// numbers"; the moments: Barill et al. 2018, "Fast winding numbers for soups and clouds", section 4.
class WindingNumber {
 public:
  WindingNumber(const Mesh& mesh, const CellBlock& triangles);

  double operator()(const Vector3& X) const;

 private:
  struct Node {
    Vector3 center = Vector3::Zero();  ///< mean of its triangles by area
    Vector3 dipole = Vector3::Zero();  ///< sum of their area vectors [m^2]
    /// Integral of the form n_i s_j, with s from the center and the normal n; symmetric [m^3].
    Matrix<3> first_moment = Matrix<3>::Zero();
    /// Integral of the form n_i s_j s_k: its value for x, y, z is the polynomial with these coefficients of
    /// xxx, xxy, xxz, xyy, xyz, xzz, yyy, yyz, yzz, zzz [m^4].
    std::array<double, 10> second_moment{};
    Vector3 contracted = Vector3::Zero();  ///< the second moment by pairs of indices: 2 n.s s + s.s n [m^4]
    double radius = 0;                     ///< radius of the ball about `center` that holds them [m]
    Index first = 0, last = 0;             ///< triangles, in `corners_`
    Index left = -1;                       ///< children are left and left + 1; -1 for a leaf
  };
  /// In the order of the mesh.
  struct Triangles {
    std::vector<Vector3> middles, areas;  ///< areas as vectors [m^2]
  };
  void build(Index node, std::vector<Index>& order, const Triangles& triangles);
  static void add_moments(Node& node, const std::array<Vector3, 3>& corners, const Vector3& area);
  static double far_angle(const Node& node, const Vector3& R, double square);

  std::vector<Node> nodes_;
  std::vector<std::array<Vector3, 3>> corners_;  ///< corners of triangles, in the order of the leaves
};

}  // namespace resilin
