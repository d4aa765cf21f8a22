#pragma once

#include "resilin/element/quadratic_simplex.hpp"

namespace resilin {

/// Triangle of degree 2: corners 0, 1, 2, then the middles of the edges 01, 12, 20.
struct QuadraticTriangle : QuadraticSimplex<3> {
  static constexpr std::string_view name = "P2";
  static constexpr std::string_view text = "quadratic triangle";
  static constexpr CellShape shape = CellShape::triangle;
  static constexpr int num_nodes = 6;
  static constexpr int degree = 2;
  static constexpr std::string_view quadrature = "3-point";
};

}  // namespace resilin
