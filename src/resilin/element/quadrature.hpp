#pragma once

#include <string_view>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// A point of the reference cell at which energies are sampled.
struct QuadraturePoint {
  Vector3 xi;     ///< reference coordinates; the third is zero in 2D
  double weight;  ///< the weights sum to the size of the reference cell
};

/// Reference cells: the triangle and tetrahedron of the origin and the unit vectors; the unit square and
/// cube.
enum class CellShape { triangle, quadrilateral, tetrahedron, hexahedron };

/// Family of a shape, the same in all dimensions. Code that differs by family switches over it without a
/// default, so that the compiler shows every place that a new family has to fill.
enum class ShapeFamily { simplices, cubes };

/// Whether a reference cell is a simplex or a cube.
constexpr ShapeFamily family(CellShape shape) {
  switch (shape) {
    case CellShape::triangle:
    case CellShape::tetrahedron:
      return ShapeFamily::simplices;
    case CellShape::quadrilateral:
    case CellShape::hexahedron:
      break;
  }
  return ShapeFamily::cubes;
}
constexpr bool is_simplex(CellShape shape) { return family(shape) == ShapeFamily::simplices; }

/// Dimension of a reference cell: 2 or 3.
constexpr int dimension(CellShape shape) {
  switch (shape) {
    case CellShape::triangle:
    case CellShape::quadrilateral:
      return 2;
    case CellShape::tetrahedron:
    case CellShape::hexahedron:
      break;
  }
  return 3;
}

double size(CellShape shape);  ///< size of the reference cell: 1/2, 1, 1/6, 1

/// Points and weights on a reference cell.
struct QuadratureRule {
  std::string_view name;  ///< "4-point"; "exact" for a rule whose error is round-off for smooth energies
  int degree;             ///< polynomials of this degree (in each coordinate on squares and cubes) are exact
  std::vector<QuadraturePoint> points;
};

/// The rules for a cell, from few points to many.
///
/// The degree-2 rules of simplices have their points at the vertices' mean pushed outwards (Zienkiewicz &
/// Taylor 2000, tables 5.3 and 5.4); the larger ones are products of Gauss and Gauss-Jacobi rules on the
/// collapsed cube (Stroud 1971, ch. 2.4).
const std::vector<QuadratureRule>& quadrature_rules(CellShape shape);

/// The smallest rule that is exact for this degree; the largest one beyond that.
const QuadratureRule& rule_of_degree(CellShape shape, int degree);

}  // namespace resilin
