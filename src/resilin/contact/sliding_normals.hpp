#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "resilin/collision/surface.hpp"
#include "resilin/contact/term_sums.hpp"

namespace resilin {

/// The normals of a surface as bodies slide along it: those of the smooth surface that its facets stand for.
///
/// A body that lands with a speed v has come a way v dt across a surface in a step. Of that, two facets at a
/// small angle a see a v dt along themselves, towards each other or away from each other: by the normals of
/// the facets friction would turn around from one side of their edge to the other, and no place on it might
/// balance. At a point of a facet the normal is therefore the mean of those around its corners, by the
/// areas of their facets and the weights of the point (Phong 1975, "Illumination for computer generated
/// pictures"): it goes through edges and corners without a jump.
///
/// Facets across a sharp edge are no part of that: of one that is turned by 30 degrees or more from the way
/// that the two parts are apart, the more the direction of that way counts instead, and from 60 degrees on it
/// alone. Theory: docs/theory/friction.md.
class SlidingNormals {
 public:
  /// @param parts  kept by reference
  explicit SlidingNormals(const CollisionSurface& parts);

  /// Where the second part of the pair meets a point, or two edges each other.
  /// @param places  of the vertices, dim numbers each [m]
  /// @return        of length 1, to the side of the first part
  Vector3 normal_at(const PartForce& pair, const VectorX& places) const;

  /// How that changes with the pair and with the places.
  struct Slopes {
    std::array<Vector3, most_pair_vertices> weights{};
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    std::vector<std::pair<Index, Eigen::Matrix3d>> places;  ///< by vertex, some of them more than once
  };
  Slopes slopes_at(const PartForce& pair, const VectorX& places) const;

 private:
  Vector3 of_part(std::span<const Index> vertices, std::span<const double> weights, const Vector3& apart,
                  const VectorX& places) const;

  Vector3 add_slopes_of_part(const PartForce& pair, std::size_t begin, std::size_t end, const VectorX& places,
                             Slopes& slopes) const;

  const CollisionSurface& parts_;
  std::vector<std::size_t> row_begin_;  ///< first facet of each vertex, in `facets_`, and the end
  std::vector<Index> facets_;           ///< triangles, in 2D edges, around each vertex
};

}  // namespace resilin
