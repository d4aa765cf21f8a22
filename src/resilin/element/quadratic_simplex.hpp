#pragma once

#include <array>

#include "resilin/element/element.hpp"

namespace resilin {

/// Shape functions of degree 2 on a triangle or tetrahedron, from the barycentric coordinates L_i:
///
///   corner i: L_i (2 L_i - 1)      middle of the edge (i, j): 4 L_i L_j
///
/// Source: Zienkiewicz & Taylor 2000, ch. 8.8 and 8.12. Order of the edges as in MSH.
template <std::size_t num_corners>
struct QuadraticSimplex {
  static constexpr std::size_t dim = num_corners - 1, num_edges = num_corners * dim / 2;
  using Edge = std::array<std::size_t, 2>;

  static constexpr std::array<Edge, num_edges> edges() {
    if constexpr (num_corners == 3)
      return {{{0, 1}, {1, 2}, {2, 0}}};
    else
      return {{{0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}}};
  }

  static std::array<double, num_corners> barycentric(const Vector3& xi) {
    std::array<double, num_corners> L = {1};
    for (std::size_t i = 0; i < dim; ++i) {
      L[i + 1] = xi[static_cast<Eigen::Index>(i)];
      L[0] -= L[i + 1];
    }
    return L;
  }
  /// dL_i/dxi_k
  static constexpr double barycentric_slope(std::size_t i, std::size_t k) {
    return i == 0 ? -1 : (i == k + 1 ? 1 : 0);
  }

  static std::array<Vector3, num_corners + num_edges> nodes() {
    std::array<Vector3, num_corners + num_edges> all;
    all.fill(Vector3::Zero());
    for (std::size_t i = 1; i < num_corners; ++i) all[i][static_cast<Eigen::Index>(i) - 1] = 1;
    for (std::size_t e = 0; e < num_edges; ++e)
      all[num_corners + e] = 0.5 * (all[edges()[e][0]] + all[edges()[e][1]]);
    return all;
  }

  static void shape_values(const Vector3& xi, std::span<double> values) {
    const auto L = barycentric(xi);
    for (std::size_t i = 0; i < num_corners; ++i) values[i] = L[i] * (2 * L[i] - 1);
    for (std::size_t e = 0; e < num_edges; ++e)
      values[num_corners + e] = 4 * L[edges()[e][0]] * L[edges()[e][1]];
  }

  static void shape_gradients(const Vector3& xi, std::span<double> gradients) {
    const auto L = barycentric(xi);
    for (std::size_t k = 0; k < dim; ++k) {
      for (std::size_t i = 0; i < num_corners; ++i)
        gradients[i * dim + k] = (4 * L[i] - 1) * barycentric_slope(i, k);
      for (std::size_t e = 0; e < num_edges; ++e) {
        const auto [i, j] = edges()[e];
        gradients[(num_corners + e) * dim + k] =
            4 * (L[i] * barycentric_slope(j, k) + L[j] * barycentric_slope(i, k));
      }
    }
  }
};

}  // namespace resilin
