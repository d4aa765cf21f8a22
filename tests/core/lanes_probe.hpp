#pragma once

#include <cstddef>

#include "resilin/core/instruction_set.hpp"

namespace resilin::testing {

/// F = I + H = U diag(s) V^T of a matrix; columns one after the other.
struct SvdNumbers {
  double U[9], V[9];
  double s[3];
  double e[3];  ///< s - 1, when the strain was kept
};
struct Svd2Numbers {
  double U[4], V[4], s[2], e[2];
};

/// Functions of lanes (core/simd.hpp) as one instruction set has them, called for arrays whose sizes are
/// multiples of 8.
struct LanesProbe {
  using Function = void (*)(std::size_t size, const double* x, double* y);
  Function sqrt, reciprocal_sqrt, power_of_two, log1p, log1p_minus, cbrt1p, exp, expm1, expm1_minus;
  void (*power_difference)(std::size_t size, const double* x, const double* alpha, double* y);

  /// Decomposes matrices by rows, one after the other.
  void (*svd)(std::size_t count, bool keeps_strain, const double* H, SvdNumbers* out);
  void (*svd2)(std::size_t count, const double* H, Svd2Numbers* out);
  /// On return A holds the eigenvalues on its diagonal and V the eigenvectors in its columns. `sweeps`: of
  /// the method for 3x3; 0 goes on until round-off.
  void (*diagonalize3)(std::size_t count, int sweeps, double* A, double* V);
  void (*diagonalize6)(std::size_t count, double* A, double* V);

  // Between arrays of matrices and rows of lanes, one block of 8 (core/simd_arrays.hpp).
  void (*read_block)(const double* in, std::size_t count, std::size_t entries, double* rows);
  void (*write_block)(const double* rows, std::size_t count, std::size_t entries, double* out);
};

const LanesProbe& lanes_probe(InstructionSet set);

/// Defined by lanes_probe.cpp, once for each instruction set.
template <InstructionSet set>
const LanesProbe& compiled_lanes_probe();
template <>
const LanesProbe& compiled_lanes_probe<InstructionSet::baseline>();
template <>
const LanesProbe& compiled_lanes_probe<InstructionSet::avx2>();
template <>
const LanesProbe& compiled_lanes_probe<InstructionSet::avx512>();

}  // namespace resilin::testing
