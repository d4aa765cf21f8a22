#pragma once

#include "resilin/element/multilinear_cube.hpp"

namespace resilin {

/// Quadrilateral with bilinear shape functions, corners anticlockwise.
struct BilinearQuadrilateral : MultilinearCube<2> {
  static constexpr std::string_view name = "Q1";
  static constexpr std::string_view text = "bilinear quadrilateral";
  static constexpr CellShape shape = CellShape::quadrilateral;
  static constexpr int num_nodes = 4;
  static constexpr int degree = 1;
  static constexpr std::string_view quadrature = "4-point";
};

}  // namespace resilin
