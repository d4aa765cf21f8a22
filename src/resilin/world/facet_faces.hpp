#pragma once

#include <span>
#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Facets of a surface with their normals, and the faces that they make up: parts of the surface in which
/// neighbours meet at a small angle, such as a side of a box or the wall of a hole.
class FacetFaces {
 public:
  /// @param facets     of one kind, lines in 2D
  /// @param positions  `dim` numbers for each node [m]
  FacetFaces(int dim, CellBlock facets, const VectorX& positions);

  const CellBlock& facets() const { return facets_; }
  Index count() const { return facets_.num_cells(); }
  /// Outward normal times area; in 2D times length [m^2].
  const Vector3& area_vector(Index facet) const { return areas_[static_cast<std::size_t>(facet)]; }
  Vector3 normal(Index facet) const { return area_vector(facet).normalized(); }
  Vector3 centroid(Index facet) const;

  /// The facet that is nearest to a point.
  struct Nearest {
    Index facet = -1;
    double distance = 0;  ///< [m]
  };
  std::vector<Nearest> nearest(std::span<const Vector3> points) const;

  /// The facets that are reached from one across edges whose facets meet at no more than this angle.
  /// @return a flag for each facet
  std::vector<bool> face_of(Index facet, double degrees) const;
  /// The number of its face, for each of these facets; faces are bounded by the other facets, too.
  std::vector<Index> number_faces(const std::vector<bool>& among, double degrees) const;

 private:
  double squared_distance(Index facet, const Vector3& point) const;
  void spread(Index facet, double degrees, const std::vector<bool>& among, Index number,
              std::vector<Index>& numbers) const;

  int dim_;
  CellBlock facets_;
  const VectorX& positions_;  ///< kept by reference
  std::vector<Vector3> areas_;
  std::vector<std::vector<Index>> neighbours_;
};

/// Areas of a selection that face opposite ways and belong to different faces, such as both sides of a plate.
struct OppositeSides {
  double area = 0;  ///< the smaller one of the two [m^2]
  Vector3 normal = Vector3::Zero();
};

/// The largest such pair of faces, as long as the smaller one has at least a twentieth of the whole area.
/// @return area 0 without any
OppositeSides opposite_sides(const FacetFaces& surface);

}  // namespace resilin
