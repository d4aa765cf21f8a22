#pragma once

#include <array>
#include <vector>

#include "resilin/mesh/cell_map.hpp"

namespace resilin {

/// The surface of all cells at rest in flat pieces, and where it is nearest to a point. Sides of straight
/// simplices and of parallelepipeds are their own pieces, others are cut into small ones.
class CellSurface {
 public:
  /// @param map  kept by reference
  explicit CellSurface(const CellMap& map);

  /// The place of the surface that is nearest to a point.
  struct Nearest {
    Index cell;
    Vector3 xi;       ///< xi of that place in the cell
    double distance;  ///< [m]
  };
  Nearest nearest(const Vector3& X) const;

 private:
  /// A triangle, in 2D a segment: reference coordinates and places of its corners.
  struct Piece {
    Index cell;
    std::array<Vector3, 3> xi, places;
  };
  using Corners = std::array<Vector3, 3>;

  static std::vector<Corners> cut_side(const ElementInfo& element, int side, int n);
  std::array<double, 3> shares(const Piece& piece, const Vector3& X) const;
  double squared_distance(const Piece& piece, const Vector3& X) const;

  const CellMap& map_;
  std::vector<Piece> pieces_;
  BoxTree tree_;
};

}  // namespace resilin
