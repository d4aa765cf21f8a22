// Compiled once for each instruction set: see core/simd.hpp.
#include "resilin/material/kernels/point_kernels.hpp"

#include "resilin/core/simd_arrays.hpp"
#include "resilin/core/simd_intrinsics.hpp"
#include "resilin/material/kernels/lane_tangent.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {
namespace {

/// Calls `body(block, lane)` for all groups of lanes.
template <class Body>
RESILIN_INLINE void for_lanes(std::size_t num_blocks, const Body& body) {
  for (std::size_t block = 0; block < num_blocks; ++block)
    for (int lane = 0; lane < block_size; lane += Lanes::width) body(block, lane);
}

/// Where the rows of a block begin.
RESILIN_INLINE std::size_t place(std::size_t block, int lane, int rows) {
  return block * static_cast<std::size_t>(rows * block_size) + static_cast<std::size_t>(lane);
}

RESILIN_INLINE const double* directions(const StateTile& tile, std::size_t block, int lane) {
  return tile.directions == nullptr ? nullptr : tile.directions + block * tile.direction_stride + lane;
}

template <int dim>
[[gnu::flatten]] void variables(const StateTile& tile, bool holds_F, double* H_rows, double* out_rows,
                                double* frames) {
  constexpr int entries = dim * dim;
  const int rows = num_variables(tile.law.kind);
  const bool keeps_frame = tile.law.kind == LawKind::stretches && frames != nullptr;
  const Lanes unit = holds_F ? 1.0 : 0.0;
  for_lanes(tile.num_blocks, [&](std::size_t block, int lane) {
    Lanes H[entries], out[max_variables], frame[frame_rows(dim)];
    load_rows(H_rows + place(block, lane, entries), entries, H);
    for (int i = 0; i < dim; ++i) H[(dim + 1) * i] -= unit;
    variables_of<dim>(tile.law, H, directions(tile, block, lane), out, keeps_frame ? frame : nullptr);
    store_rows(H, entries, H_rows + place(block, lane, entries));
    store_variables(tile.law, out, out_rows + place(block, lane, rows));
    if (keeps_frame) store_rows(frame, frame_rows(dim), frames + place(block, lane, frame_rows(dim)));
  });
}

template <int dim>
RESILIN_INLINE void load_state(const StateTile& tile, std::size_t block, int lane, Lanes H[], Lanes frame[]) {
  load_rows(tile.H + place(block, lane, dim * dim), dim * dim, H);
  if (tile.law.kind == LawKind::stretches)
    load_rows(tile.frames + place(block, lane, frame_rows(dim)), frame_rows(dim), frame);
}

template <int dim>
[[gnu::flatten]] void stresses(const StateTile& tile, const double* law_gradient, double* P_rows) {
  const int rows = num_slopes(tile.law.kind);
  for_lanes(tile.num_blocks, [&](std::size_t block, int lane) {
    Lanes H[dim * dim], frame[frame_rows(dim)], slopes[max_slopes], P[dim * dim];
    load_state<dim>(tile, block, lane, H, frame);
    load_rows(law_gradient + place(block, lane, rows), rows, slopes);
    stress<dim>(tile.law, H, frame, directions(tile, block, lane), slopes, P);
    store_rows(P, dim * dim, P_rows + place(block, lane, dim * dim));
  });
}

template <int dim>
void tangents(const StateTile& tile, double removed, const double* law_curvature, double* A_rows) {
  constexpr int entries = dim * dim * dim * dim;
  const int rows = num_curvature_rows(tile.law.kind);
  for_lanes(tile.num_blocks, [&](std::size_t block, int lane) {
    Lanes H[dim * dim], frame[frame_rows(dim)], A[entries];
    load_state<dim>(tile, block, lane, H, frame);
    tangent<dim>(tile.law, removed, H, frame, directions(tile, block, lane),
                 law_curvature + place(block, lane, rows), A);
    store_rows(A, entries, A_rows + place(block, lane, entries));
  });
}

template <int dim>
void corner_forces(std::size_t num_blocks, const double* P_rows, const double* gradients,
                   const double* volumes, double* forces) {
  for_lanes(num_blocks, [&](std::size_t block, int lane) {
    Lanes P[dim * dim], g[dim][dim], f[dim + 1][dim];
    load_rows(P_rows + place(block, lane, dim * dim), dim * dim, P);
    load_rows(gradients + place(block, lane, dim * dim), dim * dim, g[0]);
    const Lanes minus_volume = -Lanes::load(volumes + place(block, lane, 1));
    for (int i = 0; i < dim * dim; ++i) P[i] *= minus_volume;
    apply<dim>(P, g, f + 1);
    for (int i = 0; i < dim; ++i) {
      f[0][i] = -f[1][i];
      for (int a = 2; a <= dim; ++a) f[0][i] -= f[a][i];
    }
    store_rows(f[0], (dim + 1) * dim, forces + place(block, lane, (dim + 1) * dim));
  });
}

template <class Real>
void read(const Real* in, std::size_t count, std::size_t entries, double* rows) {
  for (std::size_t first = 0; first < count; first += block_size)
    read_block(in + first * entries, count - first < block_size ? count - first : block_size, entries,
               rows + first * entries);
}

template <class Real>
void write(const double* rows, std::size_t count, std::size_t entries, Real* out) {
  for (std::size_t first = 0; first < count; first += block_size)
    write_block(rows + first * entries, count - first < block_size ? count - first : block_size, entries,
                out + first * entries);
}

/// Blocks are gathered into whole lines of the cache before they leave.
template <class Real>
void stream(const double* rows, std::size_t count, std::size_t entries, Real* out) {
  constexpr std::size_t most_entries = 81;
  alignas(64) Real numbers[most_entries * block_size];
  const std::size_t step = most_entries / entries * block_size;
  for (std::size_t first = 0; first < count; first += step) {
    const std::size_t size = count - first < step ? count - first : step;
    write(rows + first * entries, size, entries, numbers);
    stream_copy(numbers, size * entries * sizeof(Real), out + first * entries);
  }
}

void complete() { complete_streams(); }

template <int dim>
constexpr PointKernels kernels = {variables<dim>, stresses<dim>, tangents<dim>, corner_forces<dim>,
                                  read<double>,   read<float>,   write<double>, write<float>,
                                  stream<double>, stream<float>, complete};

}  // namespace

}  // namespace resilin::RESILIN_SIMD_NAMESPACE

namespace resilin {

template <InstructionSet>
const PointKernels& compiled_point_kernels(int dim) {
  return dim == 2 ? RESILIN_SIMD_NAMESPACE::kernels<2> : RESILIN_SIMD_NAMESPACE::kernels<3>;
}
template const PointKernels& compiled_point_kernels<InstructionSet::RESILIN_SIMD_NAMESPACE>(int);

}  // namespace resilin
