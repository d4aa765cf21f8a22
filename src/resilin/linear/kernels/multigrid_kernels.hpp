#pragma once

#include <stdint.h>

#include "resilin/core/instruction_set.hpp"

namespace resilin::detail {

/// Views of the arrays of one level, for the inner loops. Numbers are float. Each node has `lanes` numbers in
/// a vector, the power of two not below the size of its block; the padding has no meaning. Blocks have none,
/// but are read by whole lanes: behind the last block of an array there are `lanes` more numbers.
struct LevelView {
  const int64_t* row_begin;  ///< strictly upper part
  const int32_t* columns;
  const float* upper;     ///< size x size for every entry of `columns`
  const float* diagonal;  ///< size x size for every node
  const float* inverse_diagonal;
};

/// Places in the rows of a level, in one byte each or in two: one of the two is there.
struct PlacesView {
  const uint8_t* narrow;
  const uint16_t* wide;
};

/// Numbers of fine nodes in two bytes: whole ones from -32767 to 32767 times the scale of their node. Like
/// blocks they are read by whole lanes.
struct ShortNumbers {
  int16_t* numbers;
  float* scales;
};

/// The prolongation of a level and the map of the Galerkin product. Rows are fine nodes, columns coarse ones.
struct TransferView {
  const int64_t* row_begin;
  const int32_t* columns;
  ShortNumbers blocks;  ///< fine size x coarse size for every entry of `columns`

  ShortNumbers tentative;        ///< fine size x coarse size for every fine node
  const int64_t* lower_begin;    ///< strictly lower part of the fine matrix by rows
  const int32_t* lower_columns;  ///< for every lower entry
  PlacesView lower_places;       ///< likewise: of which entry of that column's upper row it is the transpose
  /// By full entry, those of a row being its lower ones, the diagonal, the upper ones: place of its aggregate
  /// in the row of the prolongation; the largest number: none.
  PlacesView smoothing_places;

  const int64_t* target_begin;  ///< by fine node: its first entry of the next
  /// By prolongation entry and coarse column of the node's row of A P, in the order in which they come: which
  /// block of the coarse row of the entry, counted from 1, the diagonal; 0: one below it.
  PlacesView coarse_places;
};

/// Blocks of the next level's matrix.
struct CoarseView {
  const int64_t* row_begin;  ///< strictly upper part
  float* diagonal;
  float* upper;
};

/// Fine nodes [first, last).
struct NodeRange {
  int32_t first, last;
};

/// Inner loops of the multigrid, compiled once for each instruction set. First index: dim - 2; second: 0 for
/// the level of the given matrix (blocks of dim), 1 for those below it (blocks of 3 in 2D, 6 in 3D). Each
/// does the rows of `nodes`. A = L + D + U, where the lower rows L are the transposes of the upper ones: they
/// are added where they belong, so that nodes with a neighbour in common must not run at the same time.
struct MultigridKernels {
  /// x = (D + L)^-1 r, row after row; of r is left what later rows see of it.
  void (*sweep_forward[2][2])(const LevelView& level, NodeRange nodes, float* r, float* x);
  /// x = (D + U)^-1 b, the last row first.
  void (*sweep_backward[2][2])(const LevelView& level, NodeRange nodes, const float* b, float* x);
  /// r = -U x; b -= L x.
  void (*negate_upper[2][2])(const LevelView& level, NodeRange nodes, const float* x, float* r);
  void (*subtract_lower[2][2])(const LevelView& level, NodeRange nodes, const float* x, float* b);
  /// y += A x.
  void (*multiply_add[2][2])(const LevelView& level, NodeRange nodes, const float* x, float* y);
  /// x = D^-1 r.
  void (*apply_inverse_diagonal[2][2])(const LevelView& level, NodeRange nodes, const float* r, float* x);
  /// coarse += P^T fine; fine += P coarse.
  void (*restrict_add[2][2])(const TransferView& transfer, NodeRange nodes, const float* fine, float* coarse);
  void (*prolong_add[2][2])(const TransferView& transfer, NodeRange nodes, const float* coarse, float* fine);
  /// Writes numbers of a node in two bytes. @return their scale
  float (*shorten)(const float* numbers, int64_t count, int16_t* to);
  // The first index of these is 0 for places in one byte and 1 for those in two.
  /// P = (I - damping D^-1 A) T. Writes transfer.blocks; `row_work` holds the widest row of A P, its rows
  /// padded.
  void (*smooth_prolongation[2][2][2])(const LevelView& level, const TransferView& transfer, NodeRange nodes,
                                       float damping, float* row_work);
  /// Adds the upper blocks of P^T A P to `coarse`. `place_of`: a number for each coarse node, all negative.
  void (*galerkin_product[2][2][2])(const LevelView& level, const TransferView& transfer, NodeRange nodes,
                                    float* row_work, int32_t* place_of, CoarseView coarse);
};

/// Those of an instruction set that this build holds; of the preferred one (core/cpu.hpp).
const MultigridKernels& multigrid_kernels(InstructionSet set);
const MultigridKernels& multigrid_kernels();

template <InstructionSet set>
const MultigridKernels& compiled_multigrid_kernels();

}  // namespace resilin::detail
