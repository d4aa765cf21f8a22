#pragma once

#include "resilin/element/multilinear_cube.hpp"

namespace resilin {

/// Hexahedron with trilinear shape functions: corners anticlockwise below (seen from above), then above.
struct TrilinearHexahedron : MultilinearCube<3> {
  static constexpr std::string_view name = "Q1";
  static constexpr std::string_view text = "trilinear hexahedron";
  static constexpr CellShape shape = CellShape::hexahedron;
  static constexpr int num_nodes = 8;
  static constexpr int degree = 1;
  static constexpr std::string_view quadrature = "8-point";
};

}  // namespace resilin
