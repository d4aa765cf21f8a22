#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// The Delaunay tetrahedra of points on an integer grid inside a cube, whose eight corners are points too.
///
/// Points are inserted one by one (Bowyer 1981, Watson 1981). The signs of both predicates are exact: 128-bit
/// integers hold every determinant. Coplanar and cospherical points therefore need no special care, and the
/// result depends on the points and their order alone.
class Delaunay {
 public:
  using Point = std::array<std::int32_t, 3>;
  static constexpr std::int32_t extent = 1 << 24;  ///< coordinates lie strictly between 0 and this
  static constexpr Index num_corners = 8;          ///< points 0 to 7 are those of the cube

  struct Tetrahedron {
    std::array<Index, 4> nodes;      ///< in positive orientation; the first is -1 once it is gone
    std::array<Index, 4> neighbors;  ///< opposite the nodes; -1 at the cube's sides
    Index birth = 0;                 ///< point with which it came
    bool is_there() const { return nodes[0] >= 0; }
  };

  Delaunay();

  /// @return the number of the point; of an earlier one at the same place
  Index insert(const Point& point);

  const std::vector<Tetrahedron>& tetrahedra() const { return tetrahedra_; }
  Index num_points() const { return static_cast<Index>(points_.size()); }

 private:
  /// Side of a new tetrahedron by the edge that it shares with another new one.
  struct Rim {
    std::int64_t edge = -1;  ///< -1: the slot is free
    Index tetrahedron = -1;
    int side = 0;
  };

  const Point& point(Index i) const { return points_[static_cast<std::size_t>(i)]; }
  Tetrahedron& at(Index t) { return tetrahedra_[static_cast<std::size_t>(t)]; }
  const Tetrahedron& at(Index t) const { return tetrahedra_[static_cast<std::size_t>(t)]; }
  int orientation(const std::array<Index, 4>& nodes, int replaced, const Point& p) const;
  bool is_in_sphere(const Tetrahedron& tetrahedron, const Point& p) const;
  Index find_around(const Point& p) const;
  Index take_place();
  void join(const Rim& rim);

  std::vector<Point> points_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<Index> free_;
  Index last_ = 0;
  // Work space of `insert`.
  std::vector<Index> cavity_;
  std::vector<std::uint8_t> is_in_cavity_;
  std::vector<std::pair<Index, int>> sides_;  ///< sides of the cavity
  std::vector<Rim> rims_;                     ///< open addressing, a power of two of slots
};

}  // namespace resilin
