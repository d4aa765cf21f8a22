#pragma once

#include "resilin/element/quadratic_simplex.hpp"

namespace resilin {

/// Tetrahedron of degree 2: corners 0, 1, 2, 3, then the middles of the edges 01, 12, 20, 30, 23, 13.
struct QuadraticTetrahedron : QuadraticSimplex<4> {
  static constexpr std::string_view name = "P2";
  static constexpr std::string_view text = "quadratic tetrahedron";
  static constexpr CellShape shape = CellShape::tetrahedron;
  static constexpr int num_nodes = 10;
  static constexpr int degree = 2;
  static constexpr std::string_view quadrature = "4-point";
};

}  // namespace resilin
