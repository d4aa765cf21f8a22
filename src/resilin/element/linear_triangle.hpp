#pragma once

#include <array>

#include "resilin/element/element.hpp"

namespace resilin {

/// Triangle with linear shape functions: N_0 = 1 - xi - eta, N_1 = xi, N_2 = eta.
struct LinearTriangle {
  static constexpr std::string_view name = "P1";
  static constexpr std::string_view text = "linear triangle";
  static constexpr CellShape shape = CellShape::triangle;
  static constexpr int num_nodes = 3;
  static constexpr int degree = 1;
  static constexpr std::string_view quadrature = "1-point";  // exact: the gradient is constant

  static std::array<Vector3, 3> nodes() { return {Vector3::Zero(), Vector3::UnitX(), Vector3::UnitY()}; }
  static void shape_values(const Vector3& xi, std::span<double> values) {
    values[0] = 1 - xi[0] - xi[1];
    values[1] = xi[0];
    values[2] = xi[1];
  }
  static void shape_gradients(const Vector3&, std::span<double> gradients) {
    constexpr std::array<double, 6> constant = {-1, -1, 1, 0, 0, 1};
    for (std::size_t i = 0; i < constant.size(); ++i) gradients[i] = constant[i];
  }
};

}  // namespace resilin
