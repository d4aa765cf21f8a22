#pragma once

#include "resilin/energy/kernels/gather.hpp"
#include "resilin/energy/kernels/lane_hessians.hpp"
#include "resilin/energy/kernels/quadrature_kernels.hpp"

/// Common data of loops over elements with quadrature points.
namespace resilin::RESILIN_SIMD_NAMESPACE {

constexpr int num_pairs(int num_nodes) { return num_nodes * (num_nodes + 1) / 2; }

/// Points that go through the pairs of nodes together, so that each block of K is written once for them.
constexpr std::size_t points_per_pass = 4;

/// A group of lanes of one block.
template <int dim, int num_nodes>
struct Group {
  const QuadratureTile& tile;
  std::size_t in_tile;  ///< number of the block in the tile
  std::size_t block;    ///< and among all blocks
  int lane;             ///< first lane

  const std::int32_t* nodes(int a) const {
    return tile.nodes + (block * num_nodes + static_cast<std::size_t>(a)) * block_size + lane;
  }
  /// Start of the rows of an entry in an array of the tile.
  std::size_t row(std::size_t point, int rows) const {
    return (in_tile * tile.num_points + point) * static_cast<std::size_t>(rows * block_size) +
           static_cast<std::size_t>(lane);
  }
  Lanes weight(std::size_t point) const {
    return Lanes::load(tile.weights + (block * tile.num_points + point) * block_size + lane);
  }
  RESILIN_INLINE void inverse_jacobian(std::size_t point, Lanes dxi_dX[]) const {
    load_rows(tile.inverse_jacobians + (block * tile.num_points + point) * (dim * dim * block_size) + lane,
              dim * dim, dxi_dX);
  }
  const double* reference_gradient(std::size_t point, int a) const {
    return tile.reference_gradients + (point * num_nodes + static_cast<std::size_t>(a)) * dim;
  }
  /// g_a = dN_a/dX, a > 0; of a linear simplex, whose reference gradients are unit vectors, a row of dxi/dX.
  RESILIN_INLINE void gradient(std::size_t point, int a, const Lanes dxi_dX[], Lanes g[dim]) const {
    if constexpr (num_nodes == dim + 1) {
      for (int k = 0; k < dim; ++k) g[k] = dxi_dX[dim * (a - 1) + k];
      return;
    }
    const double* dN_dxi = reference_gradient(point, a);
    for (int k = 0; k < dim; ++k) {
      g[k] = dN_dxi[0] * dxi_dX[k];
      for (int m = 1; m < dim; ++m) g[k] += dN_dxi[m] * dxi_dX[dim * m + k];
    }
  }
};

template <int dim, int num_nodes, class Body>
RESILIN_INLINE void for_groups(const QuadratureTile& tile, const Body& body) {
  for (std::size_t i = 0; i < tile.num_blocks; ++i)
    for (int lane = 0; lane < block_size; lane += Lanes::width)
      body(Group<dim, num_nodes>{tile, i, static_cast<std::size_t>(tile.blocks[i]), lane});
}

/// Adds the energies of a group of lanes with compensation (Knuth's two-sum).
RESILIN_INLINE void add_to_sum(Lanes part, int lane, EnergySum& total) {
  const Lanes sum = Lanes::load(total.sum + lane);
  const Lanes next = sum + part, shown = next - sum;
  const Lanes rest = (sum - (next - shown)) + (part - shown);
  next.store(total.sum + lane);
  (Lanes::load(total.rest + lane) + rest).store(total.rest + lane);
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
