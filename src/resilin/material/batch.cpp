#include "resilin/material/batch.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

#include "resilin/core/parallel.hpp"
#include "resilin/core/simd.hpp"
#include "resilin/material/kernels/law_kernels.hpp"
#include "resilin/material/kernels/plane_stress_kernels.hpp"
#include "resilin/material/kernels/point_kernels.hpp"
#include "resilin/material/law_sum.hpp"
#include "resilin/material/plane_stress.hpp"

namespace resilin {
namespace {

constexpr std::size_t blocks_per_tile = 8;  ///< the data of a tile stay in the nearest caches
constexpr std::size_t states_per_tile = blocks_per_tile * block_size;
/// Tile of the loop for most arrays: longer ones push out of the nearest cache what was called
/// into it for the next one (23 against 13 ns per state, measured).
constexpr std::size_t states_per_short_tile = 2 * block_size;
constexpr std::size_t states_per_chunk = 2048;  ///< states per chunk of a parallel loop
/// Results from here on go past the caches: written through them, each line would be fetched first and others
/// put out for it.
constexpr std::size_t long_result = std::size_t{16} << 20;  // bytes

/// Memory of one tile. Uninitialised: each kernel writes the data that the next one reads.
struct Scratch {
  template <std::size_t rows>
  using Rows = std::array<double, rows * states_per_tile>;
  alignas(64) Rows<9> H;
  alignas(64) Rows<max_variables> variables;
  alignas(64) Rows<18> frames;
  alignas(64) Rows<max_curvature_rows> law;
  alignas(64) Rows<max_constants> constants;
  alignas(64) Rows<fibre_rows> directions;
  alignas(64) Rows<9> P;
};

template <class Real>
bool is_long_result(const StateBatch<Real>& states, std::size_t entries) {
  return states.count * entries * sizeof(Real) >= long_result;
}

/// One tile of a batch: reads its states and calls the law for them.
template <class Real>
class Tile {
 public:
  Tile(const StateBatch<Real>& states, std::size_t begin, std::size_t count, Scratch& scratch)
      : states_(states),
        kernels_(point_kernels(states.dim, states.instruction_set)),
        law_(states.dim == 3 ? solid_law(*states.law) : *states.law),
        law_kernels_(law_kernels(law_.index, states.instruction_set)),
        begin_(begin),
        count_(count),
        scratch_(scratch) {}

  std::size_t entries() const { return static_cast<std::size_t>(states_.dim * states_.dim); }
  std::size_t num_blocks() const { return (count_ + block_size - 1) / block_size; }
  const PointKernels& kernels() const { return kernels_; }
  const LawKernels& law() const { return law_kernels_; }

  void read(const Real* in, std::size_t entries, double* rows) const {
    if constexpr (std::is_same_v<Real, float>)
      kernels_.read_float(in + begin_ * entries, count_, entries, rows);
    else
      kernels_.read_double(in + begin_ * entries, count_, entries, rows);
  }
  void write(const double* rows, std::size_t entries, Real* out) const {
    const bool is_long = is_long_result(states_, entries);
    if constexpr (std::is_same_v<Real, float>)
      (is_long ? kernels_.stream_float : kernels_.write_float)(rows, count_, entries, out + begin_ * entries);
    else
      (is_long ? kernels_.stream_double : kernels_.write_double)(rows, count_, entries,
                                                                 out + begin_ * entries);
  }

  StateTile states() const {
    return {num_blocks(),
            {law_.kind, law_.uses_second_invariant},
            scratch_.H.data(),
            scratch_.frames.data(),
            has_fibres() ? scratch_.directions.data() : nullptr,
            fibre_rows * block_size};
  }

  /// The variables of the law, and the frames when they are wanted.
  void measure(bool wants_frames) const {
    read(states_.deformation_gradients, entries(), scratch_.H.data());
    if (has_fibres()) read_fibres();
    kernels_.variables(states(), !states_.holds_displacement_gradients, scratch_.H.data(),
                       scratch_.variables.data(), wants_frames ? scratch_.frames.data() : nullptr);
  }

  LawBatch law_batch(double* results) const {
    const std::size_t num_constants = states_.constants.size();
    return {num_blocks(), scratch_.variables.data(), scratch_.constants.data(),
            is_uniform() ? 0 : num_constants * block_size, results};
  }

  /// Puts the constants into lanes: once for all tiles when all states share them.
  void read_constants(bool is_first) const {
    if (is_uniform() && !is_first) return;
    const std::size_t num_constants = states_.constants.size();
    for (std::size_t block = 0; block < (is_uniform() ? 1 : num_blocks()); ++block)
      for (std::size_t i = 0; i < num_constants; ++i)
        for (std::size_t lane = 0; lane < block_size; ++lane) {
          const std::size_t state = begin_ + std::min(block * block_size + lane, count_ - 1);
          scratch_.constants[(block * num_constants + i) * block_size + lane] =
              states_.constants[i].data[state * states_.constants[i].stride];
        }
  }

 private:
  bool is_uniform() const {
    return std::ranges::all_of(states_.constants, [](const Column& column) { return column.stride == 0; });
  }

  /// Without families, as when only the ground substance is asked about, all directions are zero.
  bool has_fibres() const { return states_.law->max_fibres > 0; }

  void read_fibres() const {
    scratch_.directions.fill(0);
    for (std::size_t i = 0; i < num_blocks() * block_size && states_.num_fibres > 0; ++i) {
      const double* from = states_.fibres + (begin_ + std::min(i, count_ - 1)) * states_.fibre_stride;
      for (std::size_t k = 0; k < 3 * states_.num_fibres; ++k)
        scratch_.directions[(i / block_size * fibre_rows + k) * block_size + i % block_size] = from[k];
    }
  }

  const StateBatch<Real>& states_;
  const PointKernels& kernels_;
  const LawInfo& law_;
  const LawKernels& law_kernels_;
  std::size_t begin_, count_;
  Scratch& scratch_;
};

/// Calls numbers that will be read or, with `is_written`, written soon into the cache: the hardware does not
/// see several streams coming that are read a tile at a time.
template <bool is_written, class Real>
void prefetch(const Real* numbers, std::size_t begin, std::size_t end) {
  constexpr std::size_t per_line = 64 / sizeof(Real);
  for (std::size_t i = begin; i < end; i += per_line) __builtin_prefetch(numbers + i, is_written ? 1 : 0);
}

constexpr auto prefetch_nothing = [](std::size_t, std::size_t) {};

/// Calls `body(tile, scratch)` for all tiles, with the constants and the variables of the law in place.
/// `prefetch_more(begin, end)` may call further arrays of a tile's states into the cache.
template <std::size_t states_per_tile, class Real, class Prefetch, class Body>
void for_tiles(const StateBatch<Real>& states, bool wants_frames, const Prefetch& prefetch_more,
               const Body& body) {
  const auto entries = static_cast<std::size_t>(states.dim * states.dim);
  parallel_for(states.count, states_per_chunk, [&](std::size_t begin, std::size_t end) {
    Scratch scratch;
    for (std::size_t first = begin; first < end; first += states_per_tile) {
      const std::size_t next = std::min(first + states_per_tile, end);
      const Tile<Real> tile(states, first, next - first, scratch);
      prefetch_more(first, next);
      prefetch<false>(states.deformation_gradients, next * entries,
                      std::min(next + states_per_tile, states.count) * entries);
      tile.read_constants(first == begin);
      tile.measure(wants_frames);
      body(tile, scratch);
    }
    point_kernels(states.dim, states.instruction_set).complete_streams();
  });
}

/// The states of a part of their law.
template <class Real>
StateBatch<Real> states_of(const LawPart& part, const StateBatch<Real>& states) {
  StateBatch<Real> own = states;
  own.law = part.law;
  const auto first = states.constants.begin() + static_cast<std::ptrdiff_t>(part.first_constant);
  own.constants.assign(first, first + static_cast<std::ptrdiff_t>(part.law->constants.size()));
  own.num_fibres = num_own_families(part, states.num_fibres);
  own.fibres = own.num_fibres > 0 ? states.fibres + 3 * part.first_family : nullptr;
  return own;
}

/// Whether the law is a sum: then the sum of what `evaluate(states, out)` gives of its parts is in `out`,
/// `entries` numbers for each state.
template <class Real, class Evaluate>
bool sum_of_parts(const StateBatch<Real>& states, std::size_t entries, Real* out, const Evaluate& evaluate) {
  if (!is_sum(*states.law)) return false;
  const std::vector<LawPart> parts = parts_of(*states.law);
  evaluate(states_of(parts.front(), states), out);
  std::vector<Real> more(states.count * entries);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    evaluate(states_of(parts[i], states), more.data());
    for (std::size_t k = 0; k < more.size(); ++k) out[k] += more[k];
  }
  return true;
}

/// The part of a law that has this constant.
LawPart part_of(const LawInfo& law, std::size_t constant) {
  std::vector<LawPart> parts = parts_of(law);
  while (parts.back().first_constant > constant) parts.pop_back();
  return parts.back();
}

}  // namespace

template <class Real>
void energy_densities(const StateBatch<Real>& states, Real* psi) {
  if (sum_of_parts(states, 1, psi,
                   [](const StateBatch<Real>& own, Real* out) { energy_densities(own, out); }))
    return;
  for_tiles<states_per_tile>(states, false, prefetch_nothing, [&](const Tile<Real>& tile, Scratch& scratch) {
    tile.law().energy(tile.law_batch(scratch.law.data()));
    tile.write(scratch.law.data(), 1, psi);
  });
}

template <class Real>
void first_piola_kirchhoff_stresses(const StateBatch<Real>& states, Real* P) {
  const auto entries = static_cast<std::size_t>(states.dim * states.dim);
  if (sum_of_parts(states, entries, P,
                   [](const StateBatch<Real>& own, Real* out) { first_piola_kirchhoff_stresses(own, out); }))
    return;
  const auto prefetch_result = [&, is_long = is_long_result(states, entries)](std::size_t begin,
                                                                              std::size_t end) {
    if (!is_long) prefetch<true>(P, begin * entries, end * entries);
  };
  for_tiles<states_per_tile>(states, true, prefetch_result, [&](const Tile<Real>& tile, Scratch& scratch) {
    tile.law().gradient(tile.law_batch(scratch.law.data()));
    tile.kernels().stresses(tile.states(), scratch.law.data(), scratch.P.data());
    tile.write(scratch.P.data(), tile.entries(), P);
  });
}

template <class Real>
void stress_tangents(const StateBatch<Real>& states, Projection projection, Real* A) {
  const auto entries = static_cast<std::size_t>(states.dim * states.dim);
  if (sum_of_parts(states, entries * entries, A, [projection](const StateBatch<Real>& own, Real* out) {
        stress_tangents(own, projection, out);
      }))
    return;
  for_tiles<states_per_tile>(states, true, prefetch_nothing, [&](const Tile<Real>& tile, Scratch& scratch) {
    alignas(64) std::array<double, 81 * states_per_tile> tangents;
    tile.law().curvature(tile.law_batch(scratch.law.data()));
    tile.kernels().tangents(tile.states(), removed_part(projection), scratch.law.data(), tangents.data());
    tile.write(tangents.data(), tile.entries() * tile.entries(), A);
  });
}

template <class Real>
void elastic_forces(const StateBatch<Real>& states, const Real* rest_shape_inverses, const Real* rest_volumes,
                    Real* forces) {
  const auto dim = static_cast<std::size_t>(states.dim);
  if (sum_of_parts(states, (dim + 1) * dim, forces, [&](const StateBatch<Real>& own, Real* out) {
        elastic_forces(own, rest_shape_inverses, rest_volumes, out);
      }))
    return;
  const auto prefetch_next = [&, is_long = is_long_result(states, (dim + 1) * dim)](std::size_t begin,
                                                                                    std::size_t end) {
    begin = std::min(begin + states_per_short_tile, states.count);
    end = std::min(end + states_per_short_tile, states.count);
    prefetch<false>(rest_shape_inverses, begin * dim * dim, end * dim * dim);
    prefetch<false>(rest_volumes, begin, end);
    if (!is_long) prefetch<true>(forces, begin * (dim + 1) * dim, end * (dim + 1) * dim);
  };
  for_tiles<states_per_short_tile>(
      states, true, prefetch_next, [&](const Tile<Real>& tile, Scratch& scratch) {
        std::array<double, 9 * states_per_tile> gradients;
        std::array<double, states_per_tile> volumes;
        std::array<double, 12 * states_per_tile> rows;
        tile.law().gradient(tile.law_batch(scratch.law.data()));
        tile.kernels().stresses(tile.states(), scratch.law.data(), scratch.P.data());
        tile.read(rest_shape_inverses, tile.entries(), gradients.data());
        tile.read(rest_volumes, 1, volumes.data());
        tile.kernels().corner_forces(tile.num_blocks(), scratch.P.data(), gradients.data(), volumes.data(),
                                     rows.data());
        tile.write(rows.data(), (dim + 1) * dim, forces);
      });
}

template <class Real>
void constant_derivatives(const StateBatch<Real>& states, std::size_t constant, Real* dpsi, Real* dP) {
  if (is_sum(*states.law)) {
    const LawPart part = part_of(*states.law, constant);
    return constant_derivatives(states_of(part, states), constant - part.first_constant, dpsi, dP);
  }
  const auto rows = static_cast<std::size_t>(num_slopes(states.law->kind));
  for_tiles<states_per_tile>(
      states, dP != nullptr, prefetch_nothing, [&](const Tile<Real>& tile, Scratch& scratch) {
        // By block: the derivative of Psi, then those of its slopes.
        std::array<double, (max_slopes + 1) * states_per_tile> both;
        std::array<double, states_per_tile> energies;
        tile.law().constant_gradient(tile.law_batch(both.data()), static_cast<int>(constant));
        for (std::size_t block = 0; block < tile.num_blocks(); ++block) {
          const double* from = both.data() + block * (rows + 1) * block_size;
          std::copy_n(from, block_size, energies.data() + block * block_size);
          std::copy_n(from + block_size, rows * block_size, scratch.law.data() + block * rows * block_size);
        }
        if (dpsi != nullptr) tile.write(energies.data(), 1, dpsi);
        if (dP == nullptr) return;
        tile.kernels().stresses(tile.states(), scratch.law.data(), scratch.P.data());
        tile.write(scratch.P.data(), tile.entries(), dP);
      });
}

template <class Real>
void second_constant_derivatives(const StateBatch<Real>& states, std::size_t p, std::size_t q, Real* d2psi) {
  if (is_sum(*states.law)) {
    const LawPart part = part_of(*states.law, p), other = part_of(*states.law, q);
    std::fill_n(d2psi, states.count, Real(0));
    if (part.first_constant == other.first_constant)
      second_constant_derivatives(states_of(part, states), p - part.first_constant, q - part.first_constant,
                                  d2psi);
    return;
  }
  for_tiles<states_per_tile>(states, false, prefetch_nothing, [&](const Tile<Real>& tile, Scratch& scratch) {
    tile.law().constant_curvature(tile.law_batch(scratch.law.data()), static_cast<int>(p),
                                  static_cast<int>(q));
    tile.write(scratch.law.data(), 1, d2psi);
  });
}

void thickness_strains(const StateBatch<double>& states, double* strains) {
  const PlaneStressKernels& kernels = plane_stress_kernels(states.instruction_set);
  const LawInfo& solid = solid_law(*states.law);
  const LawKernels& law = law_kernels(solid.index, states.instruction_set);
  for_tiles<states_per_tile>(states, false, prefetch_nothing,
                             [&](const Tile<double>& tile, Scratch& scratch) {
                               kernels.thickness_strain(solid.kind, law, tile.law_batch(scratch.law.data()));
                               tile.write(scratch.law.data(), 1, strains);
                             });
}

template void energy_densities(const StateBatch<double>&, double*);
template void energy_densities(const StateBatch<float>&, float*);
template void first_piola_kirchhoff_stresses(const StateBatch<double>&, double*);
template void first_piola_kirchhoff_stresses(const StateBatch<float>&, float*);
template void stress_tangents(const StateBatch<double>&, Projection, double*);
template void stress_tangents(const StateBatch<float>&, Projection, float*);
template void elastic_forces(const StateBatch<double>&, const double*, const double*, double*);
template void elastic_forces(const StateBatch<float>&, const float*, const float*, float*);
template void constant_derivatives(const StateBatch<double>&, std::size_t, double*, double*);
template void constant_derivatives(const StateBatch<float>&, std::size_t, float*, float*);
template void second_constant_derivatives(const StateBatch<double>&, std::size_t, std::size_t, double*);
template void second_constant_derivatives(const StateBatch<float>&, std::size_t, std::size_t, float*);

}  // namespace resilin
