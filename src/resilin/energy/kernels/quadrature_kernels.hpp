#pragma once

#include <cstddef>
#include <cstdint>

#include "resilin/core/instruction_set.hpp"
#include "resilin/energy/kernels/element_kernels.hpp"

// Loops over elements with several quadrature points, `block_size` lanes (core/simd.hpp) at a time. They know
// nothing of the law, which is called for the points between them (material/point_kernels.hpp):
// gradients -> law -> energies, forces or Hessians.
namespace resilin {

/// Some blocks of elements of one kind. Lanes are the fastest index of every array. A point of a block is an
/// entry: block by block, point by point.
struct QuadratureTile {
  const std::int32_t* blocks;  ///< numbers of the blocks, `num_blocks` of them
  std::size_t num_blocks;
  std::size_t num_points;             ///< number of points of an element
  const std::int32_t* nodes;          ///< nodes of all blocks: [block][node][lane], local numbers
  const double* inverse_jacobians;    ///< inverse jacobians of all blocks: [block][point][dim * dim][lane],
                                      ///< dxi/dX by rows
  const double* weights;              ///< weights of all blocks: [block][point][lane], rest volumes
  const double* reference_gradients;  ///< dN/dxi, the same for all elements: [point][node][dim]
  const std::uint8_t*
      transposed_lanes;  ///< transposed lanes of all blocks: [block][pair], the lanes whose second node has
                         ///< the smaller world number: their matrix block is stored transposed

  std::size_t num_entries() const { return num_blocks * num_points; }
};

struct QuadratureKernels {
  /// H = sum_a (u_a - u_0) dN_a/dX by rows: [entry][dim * dim][lane].
  void (*gradients)(const QuadratureTile&, const double* displacements, double* H);

  /// Adds weight * (psi - psi_from), psi by entry; psi_from may be null.
  void (*add_energies)(const QuadratureTile&, const double* psi, const double* psi_from, EnergySum&);

  /// Adds dE/dx from P by rows, [entry][dim * dim][lane], or the absolute values of each element's share, at
  /// the owned nodes.
  void (*add_forces)(const QuadratureTile&, const double* P, bool is_magnitude, const OwnedNodes&,
                     double* forces);

  /// Upper blocks (a, b), a <= b, of the element Hessians, [tile block][pair][dim * dim][lane], from the
  /// stress tangents A, [entry][dim^4][lane].
  void (*hessians)(const QuadratureTile&, const double* A, double* K);

  /// Mean over the points of one row of lanes by entry: [tile block][lane].
  void (*mean)(const QuadratureTile&, const double* rows, double* means);

  /// Adds c/V b b^T to the element Hessians, b = d(V J_mean)/dx, c one row of lanes for each tile block.
  void (*add_mean_volume)(const QuadratureTile&, const double* H, const double* c, double* K);

  /// Before `hessians` of a tile that will be assembled: calls its slots into the cache.
  void (*prefetch)(const QuadratureTile&, const MatrixPlaces&, const double* values);

  /// Adds element Hessians to the slots whose row node is owned.
  void (*scatter)(const QuadratureTile&, const double* K, const MatrixPlaces&, const OwnedNodes&,
                  double* values);
};

/// For elements of so many nodes in so many dimensions, P1 aside.
const QuadratureKernels& quadrature_kernels(int dim, int num_nodes, InstructionSet set);

template <InstructionSet set>
const QuadratureKernels& compiled_quadrature_kernels(int dim, int num_nodes);

}  // namespace resilin
