#pragma once

#include <stdint.h>

#include "resilin/core/instruction_set.hpp"

namespace resilin::detail {

using KernelIndex = int32_t;
using KernelOffset = int64_t;

/// The inner loops of this module, compiled once for each instruction set. Arrays of two functions are
/// indexed by dim - 2. Blocks are row-major.
struct BlockKernels {
  /// Rows [first, last) of y += A x for the stored upper blocks and their transposes. Blocks beyond the
  /// diagonal add to y[targets[slot]]; the rows themselves are overwritten up to what was added to them
  /// before.
  void (*multiply_rows[2])(const KernelOffset* row_begin, const KernelIndex* columns,
                           const KernelIndex* targets, const double* values, const double* x, double* y,
                           KernelIndex first, KernelIndex last);

  /// z = (U^T D^-1 U)^-1 z by the block factors of an incomplete Cholesky factorisation in single precision,
  /// unit upper rows W = D^-1 U without their diagonal and inverse diagonal blocks: first W^-T, row after
  /// row, then (D W)^-1, the last row first. Each does rows [first, last), the former with what they add to
  /// others.
  void (*solve_lower[2])(const KernelOffset* row_begin, const KernelIndex* columns, const float* upper,
                         float* z, KernelIndex first, KernelIndex last);
  void (*solve_upper[2])(const KernelOffset* row_begin, const KernelIndex* columns, const float* upper,
                         const float* inverse_diagonal, float* z, KernelIndex first, KernelIndex last);

  /// Eliminates the block row `row` of an incomplete factorisation: W_rj = D_r^-1 U_rj, and
  /// A_jk -= U_rj^T W_rk for every pair that is in the pattern. `slot_of_pair` lists the slots of the pairs
  /// (j, k), j <= k, row by row, -1 where absent. `work` holds padded rows: 4 doubles (3D) or 2 (2D) for
  /// each.
  void (*eliminate_row[2])(double* work, KernelOffset row_begin, KernelOffset row_end,
                           const KernelIndex* slot_of_pair, const double* inverse_diagonal);

  double (*dot)(const double* a, const double* b, KernelOffset size);
  void (*axpy)(double factor, const double* x, double* y, KernelOffset size);  ///< y += factor x
  void (*xpby)(const double* x, double factor, double* y, KernelOffset size);  ///< y = x + factor y
};

/// Those of an instruction set that this build holds; of the preferred one (core/cpu.hpp).
const BlockKernels& block_kernels(InstructionSet set);
const BlockKernels& block_kernels();

template <InstructionSet set>
const BlockKernels& compiled_block_kernels();

}  // namespace resilin::detail
