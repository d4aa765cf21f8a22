#pragma once

#include <span>

#include "resilin/core/types.hpp"
#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// How what consists of simplices is spread around its middle: volumes, areas or lengths.
class SecondMoments {
 public:
  /// @param middle  about which sums are taken, somewhere near: for their digits [m]
  explicit SecondMoments(const Vector3& middle) : middle_(middle) {}

  /// A simplex by its corners. @param size  its volume, area or length, which may count as negative
  void add(std::span<const Vector3> corners, double size);
  double size() const { return size_; }
  Vector3 mean() const { return middle_ + first_ / size_; }  ///< the centroid [m]
  Matrix<3> second() const;                                  ///< mean of (X - centroid)(X - centroid)^T [m^2]

  /// The sides of the box with the same second moments, rising: of a box they are its own, however it is
  /// turned. Rounded to 10 digits, so that they do not tell how it is turned [m]. In 2D the first is zero.
  Vector3 lengths() const;

 private:
  Vector3 middle_;
  double size_ = 0;
  Vector3 first_ = Vector3::Zero();
  Matrix<3> second_ = Matrix<3>::Zero();
};

/// The moments of solid cells between their corners. @param places  dim numbers for each node [m]
SecondMoments second_moments(CellKind kind, std::span<const Index> cells, const VectorX& places, int dim);

/// The moments of the inside of a closed surface of lines (2D) or triangles, `dim` corners for each; for an
/// open surface, those of its facets.
SecondMoments second_moments(std::span<const Vector3> vertices, std::span<const Index> facets, int dim,
                             bool is_closed);

}  // namespace resilin
