#include "resilin/mesh/second_moments.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "resilin/core/dense.hpp"
#include "resilin/mesh/cell_kind.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

constexpr int digits = 10;

double rounded(double length) {
  if (!(length > 0) || !std::isfinite(length)) return 0;
  const int shift = digits - 1 - static_cast<int>(std::floor(std::log10(length)));
  // A power of ten that is exact, and one rounding: the number is that nearest to its decimal digits.
  const double unit = std::pow(10.0, std::abs(shift));
  return shift >= 0 ? std::round(length * unit) / unit : std::round(length / unit) * unit;
}

/// Area of a triangle or volume of a tetrahedron: negative where its corners are turned.
double signed_size(std::span<const Vector3> corners) {
  const Vector3 a = corners[1] - corners[0], b = corners[2] - corners[0];
  if (corners.size() == 3) return a.cross(b).z() / 2;
  return a.cross(b).dot(corners[3] - corners[0]) / 6;
}

double unsigned_size(std::span<const Vector3> corners) {
  if (corners.size() == 2) return (corners[1] - corners[0]).norm();
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / 2;
}

}  // namespace

// Over a simplex with corners v_i in d dimensions: V / ((d+1)(d+2)) (sum v_i v_i^T + (sum v_i)(sum v_i)^T).
void SecondMoments::add(std::span<const Vector3> corners, double size) {
  const auto count = static_cast<double>(corners.size());
  Vector3 sum = Vector3::Zero();
  Matrix<3> squares = Matrix<3>::Zero();
  for (const Vector3& corner : corners) {
    const Vector3 v = corner - middle_;
    sum += v;
    squares += v * v.transpose();
  }
  size_ += size;
  first_ += size / count * sum;
  second_ += size / (count * (count + 1)) * (squares + sum * sum.transpose());
}

Matrix<3> SecondMoments::second() const {
  const Vector3 center = first_ / size_;
  return second_ / size_ - center * center.transpose();
}

Vector3 SecondMoments::lengths() const {
  constexpr double of_box = 12;  // the square of a side over its second moment
  return (of_box * dense::symmetric_eigenpairs3(second()).values.cwiseMax(0)).cwiseSqrt().unaryExpr(&rounded);
}

SecondMoments second_moments(CellKind kind, std::span<const Index> cells, const VectorX& places, int dim) {
  const auto count = static_cast<std::size_t>(num_nodes(kind));
  const auto corner = [&](Index node) { return node_position(dim, node, places); };
  SecondMoments moments(cells.empty() ? Vector3(Vector3::Zero()) : corner(cells[0]));
  const auto size = static_cast<std::size_t>(dim) + 1;
  std::array<Vector3, 4> simplex;
  for (std::size_t first = 0; first < cells.size(); first += count) {
    simplex[0] = corner(cells[first]);
    for (const CellSide& side : cell_sides(kind)) {
      const std::span<const int> of_side = side.corners();
      const auto at = [&](std::size_t k) { return cells[first + static_cast<std::size_t>(of_side[k])]; };
      // Sides at the first corner add nothing.
      for (std::size_t k = 0; k + static_cast<std::size_t>(dim) <= of_side.size(); ++k) {
        simplex[1] = corner(at(0));
        for (std::size_t c = 1; c < static_cast<std::size_t>(dim); ++c) simplex[c + 1] = corner(at(k + c));
        const std::span<const Vector3> corners = std::span(simplex).first(size);
        moments.add(corners, signed_size(corners));
      }
    }
  }
  return moments;
}

SecondMoments second_moments(std::span<const Vector3> vertices, std::span<const Index> facets, int dim,
                             bool is_closed) {
  const auto count = static_cast<std::size_t>(dim);
  const Vector3 middle =
      facets.empty() ? Vector3(Vector3::Zero()) : vertices[static_cast<std::size_t>(facets[0])];
  SecondMoments moments(middle);
  std::array<Vector3, 4> simplex;
  simplex[0] = middle;
  for (std::size_t first = 0; first + count <= facets.size(); first += count) {
    for (std::size_t c = 0; c < count; ++c)
      simplex[c + 1] = vertices[static_cast<std::size_t>(facets[first + c])];
    const std::span<const Vector3> corners = is_closed ? std::span<const Vector3>(simplex).first(count + 1)
                                                       : std::span<const Vector3>(simplex).subspan(1, count);
    moments.add(corners, is_closed ? signed_size(corners) : unsigned_size(corners));
  }
  return moments;
}

}  // namespace resilin
