#pragma once

#include <array>

#include "resilin/element/element.hpp"

namespace resilin {

/// Tetrahedron with linear shape functions: N_0 = 1 - xi - eta - zeta, N_1 = xi, N_2 = eta, N_3 = zeta.
struct LinearTetrahedron {
  static constexpr std::string_view name = "P1";
  static constexpr std::string_view text = "linear tetrahedron";
  static constexpr CellShape shape = CellShape::tetrahedron;
  static constexpr int num_nodes = 4;
  static constexpr int degree = 1;
  static constexpr std::string_view quadrature = "1-point";  // exact: the gradient is constant

  static std::array<Vector3, 4> nodes() {
    return {Vector3::Zero(), Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ()};
  }
  static void shape_values(const Vector3& xi, std::span<double> values) {
    values[0] = 1 - xi[0] - xi[1] - xi[2];
    for (std::size_t a = 1; a < 4; ++a) values[a] = xi[static_cast<Eigen::Index>(a) - 1];
  }
  static void shape_gradients(const Vector3&, std::span<double> gradients) {
    constexpr std::array<double, 12> constant = {-1, -1, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (std::size_t i = 0; i < constant.size(); ++i) gradients[i] = constant[i];
  }
};

}  // namespace resilin
