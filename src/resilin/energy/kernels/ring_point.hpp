#pragma once

#include "resilin/energy/kernels/quadrature_group.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {

/// dN_a/dX by r and z, and N_a/R, at a point of axisymmetric cells.
template <int num_nodes>
struct RingPoint {
  Lanes g[num_nodes][2], h[num_nodes];

  RESILIN_INLINE RingPoint(const Group<2, num_nodes>& at, std::size_t point) {
    Lanes rows[5];
    load_rows(
        at.tile.inverse_jacobians + (at.block * at.tile.num_points + point) * (5 * block_size) + at.lane, 5,
        rows);
    const double* N = at.tile.reference_gradients + point * (3 * num_nodes);
    for (int a = 0; a < num_nodes; ++a, N += 3) {
      for (int k = 0; k < 2; ++k) g[a][k] = N[0] * rows[k] + N[1] * rows[2 + k];
      h[a] = N[2] * rows[4];
    }
  }
  /// H of the displacements of the nodes.
  RESILIN_INLINE void gradient(const Lanes u[num_nodes][2], Lanes H[9]) const {
    for (int k = 0; k < 9; ++k) H[k] = 0.0;
    for (int a = 0; a < num_nodes; ++a) {
      for (int i = 0; a > 0 && i < 2; ++i)
        for (int k = 0; k < 2; ++k) H[3 * i + k] += (u[a][i] - u[0][i]) * g[a][k];
      H[8] += u[a][0] * h[a];
    }
  }
  /// T : dH/dx_a, by component.
  RESILIN_INLINE void contract(const Lanes T[9], int a, Lanes of_node[2]) const {
    of_node[0] = T[0] * g[a][0] + T[1] * g[a][1] + T[8] * h[a];
    of_node[1] = T[3] * g[a][0] + T[4] * g[a][1];
  }
  /// Adds w P : dH/dx_a to the forces of the nodes.
  RESILIN_INLINE void add_forces(Lanes w, const Lanes P[9], Lanes f[num_nodes][2]) const {
    for (int a = 0; a < num_nodes; ++a) {
      f[a][0] += w * (P[0] * g[a][0] + P[1] * g[a][1] + P[8] * h[a]);
      f[a][1] += w * (P[3] * g[a][0] + P[4] * g[a][1]);
    }
  }
};

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
