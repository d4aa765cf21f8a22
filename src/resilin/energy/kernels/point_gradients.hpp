#pragma once

#include "resilin/energy/kernels/quadrature_group.hpp"

/// Gradients of nodal fields at a quadrature point and nodal forces from stresses there, for elements of
/// every kind; linear simplices have one point and need no reference gradients.
namespace resilin::RESILIN_SIMD_NAMESPACE {

/// Vectors of the nodes, less that of node 0: u[a], a > 0.
template <int dim, int num_nodes>
RESILIN_INLINE void gather_differences(const Group<dim, num_nodes>& at, const double* numbers,
                                       Lanes u[num_nodes][dim]) {
  gather<dim>(numbers, at.nodes(0), u[0]);
  for (int a = 1; a < num_nodes; ++a) {
    gather<dim>(numbers, at.nodes(a), u[a]);
    for (int i = 0; i < dim; ++i) u[a][i] -= u[0][i];
  }
}

/// du/dX at a point, from those differences.
template <int dim, int num_nodes>
RESILIN_INLINE void gradient_at(const Group<dim, num_nodes>& at, std::size_t point,
                                const Lanes u[num_nodes][dim], const Lanes dxi_dX[], Lanes G[]) {
  Lanes du_dxi[dim * dim];
  if constexpr (num_nodes == dim + 1) {
    for (int i = 0; i < dim; ++i)
      for (int m = 0; m < dim; ++m) du_dxi[dim * i + m] = u[m + 1][i];
  } else {
    for (Lanes& entry : du_dxi) entry = 0.0;
    for (int a = 1; a < num_nodes; ++a) {
      const double* dN_dxi = at.reference_gradient(point, a);
      for (int i = 0; i < dim; ++i)
        for (int m = 0; m < dim; ++m) du_dxi[dim * i + m] += dN_dxi[m] * u[a][i];
    }
  }
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < dim; ++k) {
      G[dim * i + k] = du_dxi[dim * i] * dxi_dX[k];
      for (int m = 1; m < dim; ++m) G[dim * i + k] += du_dxi[dim * i + m] * dxi_dX[dim * m + k];
    }
}

/// Adds T_im dN_a/dxi_m to the forces of the nodes a > 0.
template <int dim, int num_nodes>
RESILIN_INLINE void add_shares(const Group<dim, num_nodes>& at, std::size_t point, const Lanes T[dim][dim],
                               Lanes f[num_nodes][dim]) {
  for (int a = 1; a < num_nodes; ++a)
    for (int i = 0; i < dim; ++i) {
      if constexpr (num_nodes == dim + 1) {
        f[a][i] += T[i][a - 1];
      } else {
        const double* dN_dxi = at.reference_gradient(point, a);
        for (int m = 0; m < dim; ++m) f[a][i] += dN_dxi[m] * T[i][m];
      }
    }
}

/// Completes the forces by that of node 0 and adds them, or their absolute values, at the owned nodes.
template <int dim, int num_nodes>
RESILIN_INLINE void scatter_shares(const Group<dim, num_nodes>& at, Lanes f[num_nodes][dim],
                                   bool is_magnitude, const OwnedNodes& owned, double* forces) {
  for (int i = 0; i < dim; ++i)
    for (int a = 1; a < num_nodes; ++a) f[0][i] -= f[a][i];
  if (is_magnitude)
    for (int a = 0; a < num_nodes; ++a)
      for (int i = 0; i < dim; ++i) f[a][i] = abs(f[a][i]);
  const bool is_complete = owns_all(owned, at.nodes(0), num_nodes);
  for (int a = 0; a < num_nodes; ++a) {
    if (is_complete)
      scatter_add<dim>(f[a], at.nodes(a), [](std::int32_t) { return true; }, forces);
    else
      scatter_add<dim>(f[a], at.nodes(a), [&](std::int32_t node) { return owns(owned, node); }, forces);
  }
}

/// Calls `add(at, K)` for the groups of a tile, K being the upper blocks of the element matrices in
/// `out_rows`: [tile block][pair][dim * dim][lane], aligned to 64 bytes.
template <int dim, int num_nodes, class Add>
RESILIN_INLINE void add_to_matrices(const QuadratureTile& tile, double* out_rows, const Add& add) {
  constexpr int rows = num_pairs(num_nodes) * dim * dim;
  for_groups<dim, num_nodes>(tile, [&](const Group<dim, num_nodes>& at) {
    double* out = out_rows + at.in_tile * static_cast<std::size_t>(rows * block_size) + at.lane;
    if constexpr (Lanes::width == block_size) {  // a row of lanes is a row of the block: no copy
      add(at, *reinterpret_cast<ElementHessian<dim, num_nodes>*>(out));
    } else {
      ElementHessian<dim, num_nodes> K;
      load_rows(out, rows, K[0]);
      add(at, K);
      store_rows(K[0], rows, out);
    }
  });
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
