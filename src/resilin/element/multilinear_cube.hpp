#pragma once

#include <array>

#include "resilin/element/element.hpp"

namespace resilin {

/// Products of linear functions on the unit square or cube: N_a = prod_k (xi_k or 1 - xi_k), with the corners
/// anticlockwise below, then above.
template <std::size_t dimension>
struct MultilinearCube {
  static constexpr std::size_t dim = dimension, num_corners = std::size_t{1} << dim;

  static std::array<Vector3, num_corners> nodes() {
    std::array<Vector3, num_corners> all;
    for (std::size_t a = 0; a < num_corners; ++a)
      all[a] = Vector3(a % 4 == 1 || a % 4 == 2 ? 1 : 0, a % 4 >= 2 ? 1 : 0, a >= 4 ? 1 : 0);
    return all;
  }

  static void shape_values(const Vector3& xi, std::span<double> values) {
    const auto corners = nodes();
    for (std::size_t a = 0; a < num_corners; ++a) {
      values[a] = 1;
      for (std::size_t k = 0; k < dim; ++k) values[a] *= factor(corners[a], xi, k);
    }
  }

  static void shape_gradients(const Vector3& xi, std::span<double> gradients) {
    const auto corners = nodes();
    for (std::size_t a = 0; a < num_corners; ++a)
      for (std::size_t k = 0; k < dim; ++k) {
        double product = corners[a][static_cast<Eigen::Index>(k)] > 0 ? 1 : -1;
        for (std::size_t i = 0; i < dim; ++i)
          if (i != k) product *= factor(corners[a], xi, i);
        gradients[a * dim + k] = product;
      }
  }

 private:
  static double factor(const Vector3& corner, const Vector3& xi, std::size_t k) {
    const auto i = static_cast<Eigen::Index>(k);
    return corner[i] > 0 ? xi[i] : 1 - xi[i];
  }
};

}  // namespace resilin
