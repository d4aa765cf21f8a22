#pragma once

#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Winding number of a surface around a point, also for a surface with holes:
///
///   w(X) = 1 / (4 pi) sum_triangles (solid angle seen from X)
///
/// 1 inside a closed surface that is wound outwards, -1 inside one wound inwards, 0 outside; near a flat hole
/// it passes 1/2 where the lid would be. What is far off is taken as one dipole, so that a point costs
/// O(log n); that errs by some hundredths.
///
/// Source: Jacobson, Kavan & Sorkine 2013, "Robust inside-outside segmentation using generalized winding
/// numbers"; the dipoles: Barill et al. 2018, "Fast winding numbers for soups and clouds", to first order.
class WindingNumber {
 public:
  WindingNumber(const Mesh& mesh, const CellBlock& triangles);

  double operator()(const Vector3& X) const;

 private:
  struct Node {
    Vector3 center = Vector3::Zero();  ///< mean of its triangles by area
    Vector3 dipole = Vector3::Zero();  ///< sum of their area vectors [m^2]
    double radius = 0;                 ///< radius of the ball about `center` that holds them [m]
    Index first = 0, last = 0;         ///< triangles, in `corners_`
    Index left = -1;                   ///< children are left and left + 1; -1 for a leaf
  };
  /// In the order of the mesh.
  struct Triangles {
    std::vector<Vector3> middles, areas;  ///< areas as vectors [m^2]
  };
  void build(Index node, std::vector<Index>& order, const Triangles& triangles);

  std::vector<Node> nodes_;
  std::vector<std::array<Vector3, 3>> corners_;  ///< corners of triangles, in the order of the leaves
};

}  // namespace resilin
