#pragma once

#include <cstddef>

#include "resilin/core/instruction_set.hpp"
#include "resilin/core/projection.hpp"
#include "resilin/material/law_text.hpp"

namespace resilin {

/// How many times the negative part of the eigenvalues a projection takes off.
inline double removed_part(Projection projection) {
  return projection == Projection::none ? 0 : projection == Projection::clamp ? 1 : 2;
}

/// Some blocks of states, `block_size` lanes (core/simd.hpp) at a time; rows of lanes are the fastest index.
struct StateTile {
  std::size_t num_blocks;
  LawForm law;
  const double* H;               ///< F - I by rows, [block][dim * dim][lane]
  const double* frames;          ///< frames of a law of stretches: [block][frame rows][lane], see `variables`
  const double* directions;      ///< directions of the fibres, [block][fibre_rows][lane]; null without
  std::size_t direction_stride;  ///< numbers from block to block; 0 when all blocks share one
};

/// Loops over states that know nothing of a mesh. A law is called between them, once for each tile: variables
/// -> law (material/kernels/law_kernels.hpp) -> stresses or tangents.
struct PointKernels {
  /// Takes the identity off F in `H` unless it holds H already, and forms the variables of the law's kind;
  /// for stretches the frames, unless null.
  void (*variables)(const StateTile&, bool holds_F, double* H, double* variables, double* frames);
  /// P by rows, [block][dim * dim][lane].
  void (*stresses)(const StateTile&, const double* law_gradient, double* P);
  /// dP/dF, [block][dim^4][lane], `removed` times the negative part of its eigenvalues taken off.
  void (*tangents)(const StateTile&, double removed, const double* law_curvature, double* A);
  /// Forces of the corners of simplices, [block][(dim + 1) * dim][lane], from P and the rows of Dm^-1.
  void (*corner_forces)(std::size_t num_blocks, const double* P, const double* gradients,
                        const double* volumes, double* forces);

  // Between arrays of matrices and rows of lanes: [block][entry][lane].
  void (*read_double)(const double* in, std::size_t count, std::size_t entries, double* rows);
  void (*read_float)(const float* in, std::size_t count, std::size_t entries, double* rows);
  void (*write_double)(const double* rows, std::size_t count, std::size_t entries, double* out);
  void (*write_float)(const double* rows, std::size_t count, std::size_t entries, float* out);
  // The same past the caches, for long results; whole once `complete_streams` was called.
  void (*stream_double)(const double* rows, std::size_t count, std::size_t entries, double* out);
  void (*stream_float)(const double* rows, std::size_t count, std::size_t entries, float* out);
  void (*complete_streams)();
};

const PointKernels& point_kernels(int dim, InstructionSet set);

template <InstructionSet set>
const PointKernels& compiled_point_kernels(int dim);

}  // namespace resilin
