#pragma once

#include <cstddef>

#include "resilin/core/cpu.hpp"

namespace resilin {

/// Points at which a law is evaluated, `block_size` lanes (core/simd.hpp) at a time.
struct LawBatch {
  std::size_t num_blocks;
  const double* invariants;     ///< per block d1, d2, j; for small-strain laws eps:eps, unused, tr eps
  const double* constants;      ///< per block one row of lanes for each constant ...
  std::size_t constant_stride;  ///< ... so many numbers from block to block; 0 when all blocks share one
  double* results;
};

/// A law compiled for one instruction set. Outside the law's domain the energy is +infinity and its
/// derivatives are not numbers, in the lanes concerned alone.
struct LawKernels {
  void (*energy)(const LawBatch&);     ///< per block: Psi
  void (*gradient)(const LawBatch&);   ///< per block: dPsi/d(d1, d2, j)
  void (*curvature)(const LawBatch&);  ///< per block: the gradient, then d2Psi by 00 01 02 11 12 22
};

constexpr int gradient_rows = 3, curvature_rows = 9;

/// Kernels of the law at this place in the catalogue.
const LawKernels& law_kernels(int law_index, InstructionSet set);

namespace baseline {
const LawKernels& law_kernels(int law_index);
}
namespace avx2 {
const LawKernels& law_kernels(int law_index);
}
namespace avx512 {
const LawKernels& law_kernels(int law_index);
}

}  // namespace resilin
