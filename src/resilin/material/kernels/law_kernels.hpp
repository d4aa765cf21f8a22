#pragma once

#include <cstddef>

#include "resilin/core/instruction_set.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// Rows of lanes that a law of this kind takes for each block: d1, d2, j of Invariants; eps:eps, nothing, tr
/// eps of SmallStrain; e_1, e_2, e_3 of Stretches; d1, d2, j, the two stretches and the two weights of
/// FibreInvariants; the members of AxesStrain.
constexpr int num_variables(LawKind kind) { return kind == LawKind::fibres || kind == LawKind::axes ? 7 : 3; }
/// How many of them Psi is differentiated by.
constexpr int num_slopes(LawKind kind) { return kind == LawKind::fibres ? 5 : kind == LawKind::axes ? 7 : 3; }
/// Rows of `LawKernels::curvature`.
constexpr int num_curvature_rows(LawKind kind) {
  const int n = num_slopes(kind);
  return n + n * (n + 1) / 2 + (kind == LawKind::stretches ? 6 : 0);
}
/// Capacity of loops over states; a law with more does not compile.
constexpr std::size_t max_constants = 12;
/// Where `gradient` has dPsi/dj, and `curvature` d2Psi/dj2 (for laws whose variables have a j).
constexpr int volume_slope_row = 2;
constexpr int volume_curvature_row(LawKind kind) {
  return kind == LawKind::fibres ? 14 : kind == LawKind::axes ? 20 : 8;
}
constexpr int max_variables = 7, max_slopes = 7, max_curvature_rows = 35;

/// Rows of lanes that hold the rest directions of fibres: three components of one family, then those of the
/// next; zero where there is no such family.
constexpr std::size_t fibre_rows = 6;

/// Points at which a law is evaluated, `block_size` lanes (core/simd.hpp) at a time.
struct LawBatch {
  std::size_t num_blocks;
  const double* variables;
  const double* constants;      ///< per block one row of lanes for each constant ...
  std::size_t constant_stride;  ///< ... so many numbers from block to block; 0 when all blocks share one
  double* results;
};

/// A law compiled for one instruction set. Outside the law's domain the energy is +infinity and its
/// derivatives are not numbers, in the lanes concerned alone.
struct LawKernels {
  void (*energy)(const LawBatch&);    ///< per block: Psi
  void (*gradient)(const LawBatch&);  ///< per block: dPsi by the variables
  /// Per block: the gradient, then d2Psi by 00 01 02 ... 11 12 ...; for stretches also three flips and three
  /// twists (material/stretches.hpp).
  void (*curvature)(const LawBatch&);
  /// Per block, from one row of j = J - 1: the law's volume energy and its first and second derivative by j.
  /// Null for a law whose volume energy does not stand apart.
  void (*volume)(const LawBatch&);
  /// Per block: dPsi/dp, then the gradient of that by the variables, p being the constant of this place.
  void (*constant_gradient)(const LawBatch&, int p);
  /// Per block: d2Psi/(dp dq).
  void (*constant_curvature)(const LawBatch&, int p, int q);
};

/// Kernels of the law at this place in the catalogue.
const LawKernels& law_kernels(int law_index, InstructionSet set);

template <template <class> class Law, InstructionSet set>
const LawKernels& compiled_law_kernels();

/// Whether a law's volume energy stands apart as `volume_energy(j)`. Elements with a mean volume need it.
template <class Law>
constexpr bool has_volume_energy = requires { &Law::template volume_energy<double>; };

}  // namespace resilin
