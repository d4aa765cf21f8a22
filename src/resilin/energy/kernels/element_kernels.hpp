#pragma once

#include <cstddef>
#include <cstdint>

#include "resilin/core/instruction_set.hpp"
#include "resilin/material/law_text.hpp"

// Law-independent loops over elements, `block_size` lanes (core/simd.hpp) at a time. A law is called between
// them, once for each tile: measure -> law (material/kernels/law_kernels.hpp) -> energies, forces or
// Hessians.
namespace resilin {

/// Some blocks of P1 elements. Lanes are the fastest index of every array.
struct ElementTile {
  const std::int32_t* blocks;  ///< numbers of the blocks, `num_blocks` of them
  std::size_t num_blocks;
  std::size_t total_blocks;   ///< total blocks of the body: `nodes` and the arrays below hold so many
  const std::int32_t* nodes;  ///< nodes of all blocks: [block][node][lane], local numbers
  /// [block][node - 1][component][lane], dN/dX of nodes 1, 2, ...: of all blocks, or of those of the tile.
  const double* gradients;
  bool gradients_are_of_tile;
  const double* weights;  ///< weights of all blocks: [block][lane], rest volumes
  /// For all blocks: [block][fibre_rows][lane], rest directions of the fibres; null for a law without.
  const double* directions;
};

/// A sum of energies, each lane with its own compensation for round-off.
struct EnergySum {
  double sum[8] = {};
  double rest[8] = {};
  bool is_outside = false;  ///< some energy was infinite or not a number
};

/// Nodes begin <= node < end are written by this call and no others.
struct OwnedNodes {
  std::int32_t begin, end;
};

/// Positions of the cells' blocks in a matrix: which one of its row each is, the row being that of the node
/// of the pair with the smaller world number. In one byte each where no row is too long for that.
struct MatrixPlaces {
  const std::uint32_t* row_begin;  ///< by local node: the first slot of its row
  const std::uint8_t* narrow;      ///< narrow of all blocks: [block][pair][lane]; one of the two is there
  const std::uint32_t* wide;
};

/// Variant of the element Hessians.
struct HessianForm {
  LawForm law;
  double removed;  ///< times the negative part of an element's eigenvalues is taken off: 0 none, 1 clamp, 2
                   ///< absolute
};

struct ElementKernels {
  /// dN/dX of nodes 1, 2, ... from rest positions by local node, [tile block][node - 1][component][lane];
  /// zero in lanes without volume.
  void (*shape_gradients)(const ElementTile&, const double* rest_positions, double* gradients);

  /// H = sum_a (u_a - u_0) dN_a/dX, by rows, [tile block][dim * dim][lane], and the variables of the law's
  /// kind; for stretches the frame as well (material/kernels/lane_variables.hpp), unless `frames` is null.
  void (*measure)(const ElementTile&, const LawForm&, const double* displacements, double* H,
                  double* variables, double* frames);

  /// Adds weight * (psi - psi_from); psi_from may be null.
  void (*add_energies)(const ElementTile&, const double* psi, const double* psi_from, EnergySum&);

  /// Adds dE/dx, or the absolute values of each element's share, at the owned nodes.
  void (*add_forces)(const ElementTile&, const LawForm&, const double* H, const double* frames,
                     const double* law_gradient, bool is_magnitude, const OwnedNodes&, double* forces);

  /// Upper blocks (a, b), a <= b, of the element Hessians: [tile block][pair][dim * dim][lane]. K is aligned
  /// to 64 bytes.
  void (*hessians)(const ElementTile&, const HessianForm&, const double* H, const double* frames,
                   const double* law_curvature, double* K);

  /// Before `measure` of a tile that will be assembled: calls its slots and the displacements of the next one
  /// into the cache.
  void (*prefetch)(const ElementTile&, const double* displacements, const MatrixPlaces&,
                   const double* values);

  /// Adds element Hessians to the slots whose row node is owned.
  void (*scatter)(const ElementTile&, const double* K, const MatrixPlaces&, const OwnedNodes&,
                  double* values);

  /// J(t) = c0 + c1 t + c2 t^2 + c3 t^3 along H + t G: [block][4][lane].
  void (*volume_cubics)(std::size_t num_blocks, const double* H, const double* G, double* cubics);
};

/// Displacements and forces are stored with this many numbers for each node.
constexpr int node_stride(int dim) { return dim == 3 ? 4 : 2; }

const ElementKernels& element_kernels(int dim, InstructionSet set);

template <InstructionSet set>
const ElementKernels& compiled_element_kernels(int dim);

}  // namespace resilin
