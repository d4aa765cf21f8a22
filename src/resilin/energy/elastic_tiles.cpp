#include "resilin/energy/elastic_tiles.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <span>

#include "resilin/core/parallel.hpp"
#include "resilin/core/simd.hpp"
#include "resilin/energy/axisymmetric_blocks.hpp"
#include "resilin/energy/kernels/axisymmetric_kernels.hpp"
#include "resilin/material/volume_energy.hpp"

namespace resilin {
namespace {

constexpr int max_frame_rows = 18;

}  // namespace

ElasticTiles::ElasticTiles(ElementBlocks element_blocks, const LawInfo& material_law, bool has_mean,
                           InstructionSet set, Gradients gradients)
    : blocks(std::move(element_blocks)),
      law(&material_law),
      simplex_kernels_(&element_kernels(state_dim(blocks), set)),
      quadrature_kernels_(is_axisymmetric(blocks) ? &axisymmetric_kernels(blocks.num_nodes, set)
                          : blocks.is_linear_simplex()
                              ? nullptr
                              : &quadrature_kernels(blocks.dim, blocks.num_nodes, set)),
      point_kernels_(&point_kernels(state_dim(blocks), set)),
      law_kernels_(&resilin::law_kernels(law->index, set)),
      has_mean_volume_(has_mean) {
  constexpr Index small = 50000;  // cells: about what stays in the caches
  if (quadrature_kernels_ == nullptr && (gradients == Gradients::held || blocks.num_cells <= small))
    hold_gradients();
}

void ElasticTiles::hold_gradients() {
  const std::size_t rows = static_cast<std::size_t>(blocks.dim * blocks.dim) * block_size;
  std::vector<double> all(blocks.num_blocks * rows);
  parallel_for(blocks.num_blocks, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (auto block = static_cast<Index>(begin); block < static_cast<Index>(end); ++block)
      simplex_kernels_->shape_gradients(simplex_tile({&block, 1}), blocks.rest_positions.data(),
                                        all.data() + static_cast<std::size_t>(block) * rows);
  });
  blocks.gradients = std::move(all);
}

ElasticTiles::Scratch::Scratch(const ElasticTiles& tiles) {
  const ElementBlocks& elements = tiles.blocks;
  const std::size_t entries = tiles.blocks_per_tile() * elements.num_points;
  const auto n = static_cast<std::size_t>(state_dim(elements) * state_dim(elements));
  const std::size_t mean_rows = tiles.has_mean_volume() ? 1 : 0;
  const std::size_t K_rows =
      tiles.blocks_per_tile() * static_cast<std::size_t>(elements.num_pairs() * elements.dim * elements.dim);
  struct Part {
    double** place;
    std::size_t rows;
  };
  const Part parts[] = {{&K, K_rows},
                        {&shape_gradients, elements.is_linear_simplex() ? entries * n : 0},
                        {&H, entries * n},
                        {&G, entries * n},
                        {&variables, entries * max_variables},
                        {&frames, entries * max_frame_rows},
                        {&law, entries * max_curvature_rows},
                        {&constants, entries * max_constants},
                        {&energy, entries},
                        {&energy_from, entries},
                        {&directions, entries * fibre_rows},
                        {&stress, entries * n},
                        {&tangent, entries * n * n},
                        {&j, mean_rows * entries},
                        {&volume, mean_rows * entries * 3},
                        {&mean_j, mean_rows * entries},
                        {&mean_volume, mean_rows * entries * 3},
                        {&mean, mean_rows * entries}};
  std::size_t size = 0;
  for (const Part& part : parts) size += part.rows * block_size;
  double* next = inline_.data();
  if (size > inline_size) {
    heap_.resize(size + block_size);
    void* start = heap_.data();
    std::size_t space = heap_.size() * sizeof(double);
    next = static_cast<double*>(std::align(64, size * sizeof(double), start, space));
  }
  for (const Part& part : parts) {
    *part.place = next;
    next += part.rows * block_size;
  }
}

ElementTile ElasticTiles::simplex_tile(const Tile& tile) const {
  return {tile.blocks,
          tile.num_blocks,
          blocks.num_blocks,
          blocks.nodes.data(),
          blocks.gradients.data(),
          /*gradients_are_of_tile=*/false,
          blocks.weights.data(),
          directions.empty() ? nullptr : directions.data()};
}

ElementTile ElasticTiles::simplex_tile(const Tile& tile, Scratch& scratch) const {
  ElementTile result = simplex_tile(tile);
  if (!blocks.gradients.empty()) return result;
  if (!std::ranges::equal(scratch.gradients_of, std::span(tile.blocks, tile.num_blocks))) {
    simplex_kernels_->shape_gradients(result, blocks.rest_positions.data(), scratch.shape_gradients);
    scratch.gradients_of.assign(tile.blocks, tile.blocks + tile.num_blocks);
  }
  result.gradients = scratch.shape_gradients;
  result.gradients_are_of_tile = true;
  return result;
}

QuadratureTile ElasticTiles::quadrature_tile(const Tile& tile) const {
  return {tile.blocks,
          tile.num_blocks,
          blocks.num_points,
          blocks.nodes.data(),
          blocks.gradients.data(),
          blocks.weights.data(),
          blocks.reference_gradients.data(),
          transposed_lanes.data()};
}

/// State of the entries, whose fibres are those of their block.
StateTile ElasticTiles::state_tile(const Tile& tile, Scratch& scratch) const {
  constexpr std::size_t rows = fibre_rows * block_size;
  const std::size_t entries = num_entries(tile);
  if (!directions.empty())
    for (std::size_t e = 0; e < entries; ++e)
      std::copy_n(directions.data() + static_cast<std::size_t>(tile.blocks[e / blocks.num_points]) * rows,
                  rows, scratch.directions + e * rows);
  return {entries, law_form(), scratch.H, scratch.frames, directions.empty() ? nullptr : scratch.directions,
          rows};
}

void ElasticTiles::gradients(const Tile& tile, const double* u, Scratch& scratch, double* H) const {
  constexpr LawForm any_law = {LawKind::invariants, false};  // H alone is wanted
  if (quadrature_kernels_ == nullptr)
    simplex_kernels_->measure(simplex_tile(tile, scratch), any_law, u, H, scratch.variables, nullptr);
  else
    quadrature_kernels_->gradients(quadrature_tile(tile), u, H);
}

void ElasticTiles::volume_cubics(const Tile& tile, const double* H, const double* G, double* cubics) const {
  simplex_kernels_->volume_cubics(num_entries(tile), H, G, cubics);
}

/// H, the law's variables and, when asked for and the law is one of stretches, their frames.
void ElasticTiles::measure(const Tile& tile, const double* u, bool keeps_frames, Scratch& scratch) const {
  double* frames = keeps_frames ? scratch.frames : nullptr;
  if (quadrature_kernels_ == nullptr)
    return simplex_kernels_->measure(simplex_tile(tile, scratch), law_form(), u, scratch.H, scratch.variables,
                                     frames);
  quadrature_kernels_->gradients(quadrature_tile(tile), u, scratch.H);
  point_kernels_->variables(state_tile(tile, scratch), false, scratch.H, scratch.variables, frames);
}

/// Arguments of a kernel of the law for the entries of a tile, or once for each of its blocks.
LawBatch ElasticTiles::law_batch(const Tile& tile, const double* variables, bool is_per_entry,
                                 Scratch& scratch, double* results) const {
  const std::size_t points = is_per_entry ? blocks.num_points : 1, count = tile.num_blocks * points;
  const double* rows = constants.data();
  if (constant_stride != 0) {
    for (std::size_t i = 0; i < count; ++i)
      std::copy_n(constants.data() + static_cast<std::size_t>(tile.blocks[i / points]) * constant_stride,
                  constant_stride, scratch.constants + i * constant_stride);
    rows = scratch.constants;
  }
  return {count, variables, rows, constant_stride, results};
}

/// The volume energy and its derivatives at the entries (scratch.volume) and at the means of the cells
/// (scratch.mean_volume).
void ElasticTiles::call_volume(const Tile& tile, Scratch& scratch) const {
  const auto rows = static_cast<std::size_t>(num_variables(law->kind));
  const std::size_t entries = num_entries(tile);
  for (std::size_t e = 0; e < entries; ++e) {
    const double* variables = scratch.variables + e * rows * block_size;
    double* j = scratch.j + e * block_size;
    if (law->kind == LawKind::stretches)
      volume_of_stretches(variables, j);
    else
      std::copy_n(variables + 2 * block_size, block_size, j);
  }
  quadrature_kernels_->mean(quadrature_tile(tile), scratch.j, scratch.mean_j);
  call_law(law_kernels_->volume, tile, scratch.j, true, scratch, scratch.volume);
  call_law(law_kernels_->volume, tile, scratch.mean_j, false, scratch, scratch.mean_volume);
}

/// Takes this derivative of the volume energy at the entries off their `rows` and adds `mean`, one row for
/// each tile block (null: nothing). Energies are in row `row`; derivatives go where the law's variables have
/// them.
void ElasticTiles::replace_volume(const Tile& tile, int row, int rows, int derivative, const double* mean,
                                  Scratch& scratch, double* law_rows) const {
  const auto variables = static_cast<std::size_t>(num_variables(law->kind));
  const bool has_curvature = rows == num_curvature_rows(law->kind);
  alignas(64) std::array<double, block_size> change;
  for (std::size_t e = 0; e < num_entries(tile); ++e) {
    double* out = law_rows + e * static_cast<std::size_t>(rows) * block_size;
    const double* own = scratch.volume + (e * 3 + static_cast<std::size_t>(derivative)) * block_size;
    const double* added = mean == nullptr ? nullptr : mean + e / blocks.num_points * block_size;
    for (std::size_t lane = 0; lane < block_size; ++lane)
      change[lane] = (added == nullptr ? 0 : added[lane]) - own[lane];
    if (derivative == 0) {
      double* energy = out + static_cast<std::size_t>(row) * block_size;
      for (std::size_t lane = 0; lane < block_size; ++lane) energy[lane] += change[lane];
    } else {
      add_volume_energy(law->kind, scratch.variables + e * variables * block_size,
                        derivative == 1 ? change.data() : nullptr, derivative == 2 ? change.data() : nullptr,
                        has_curvature, out);
    }
  }
}

namespace {

/// Row `derivative` of [block][3][lane] as [block][lane].
void take_row(const double* rows, std::size_t num_blocks, std::size_t derivative, double* out) {
  for (std::size_t i = 0; i < num_blocks; ++i)
    std::copy_n(rows + (i * 3 + derivative) * block_size, block_size, out + i * block_size);
}

}  // namespace

void ElasticTiles::energies(const Tile& tile, const double* u, Scratch& scratch, double* psi) const {
  measure(tile, u, false, scratch);
  call_law(law_kernels_->energy, tile, scratch.variables, true, scratch, psi);
  if (!has_mean_volume_) return;
  call_volume(tile, scratch);
  take_row(scratch.mean_volume, tile.num_blocks, 0, scratch.mean);
  replace_volume(tile, 0, 1, 0, scratch.mean, scratch, psi);
}

void ElasticTiles::magnitudes(const Tile& tile, const double* u, Scratch& scratch, double* psi) const {
  energies(tile, u, scratch, psi);
  call_law(law_kernels_->gradient, tile, scratch.variables, true, scratch, scratch.law);
  const int rows = num_slopes(law->kind);
  if (has_mean_volume_) {
    take_row(scratch.mean_volume, tile.num_blocks, 1, scratch.mean);
    replace_volume(tile, volume_slope_row, rows, 1, scratch.mean, scratch, scratch.law);
  }
  const auto entry_size = static_cast<std::size_t>(state_dim(blocks) * state_dim(blocks));
  for (std::size_t i = 0; i < num_entries(tile) * block_size; ++i) {
    const std::size_t entry = i / block_size, lane = i % block_size;
    double square = 0;
    for (std::size_t k = 0; k < entry_size; ++k) {
      const double h = scratch.H[(entry * entry_size + k) * block_size + lane];
      square += h * h;
    }
    const double first = std::sqrt(square);
    // j, stretches: polynomials of H from the first degree on; d1, eps:eps: of the second, d2: to the fourth.
    const double of_j = first + square + square * first;
    psi[i] = std::abs(psi[i]);
    for (int row = 0; row < rows; ++row) {
      const bool has_invariants = law->kind == LawKind::invariants || law->kind == LawKind::fibres;
      const double size = !has_invariants || row >= 2 ? of_j : row == 0 ? square : square * (1 + square);
      psi[i] +=
          std::abs(scratch.law[(entry * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row)) *
                                   block_size +
                               lane]) *
          size;
    }
  }
}

void ElasticTiles::add_energies(const Tile& tile, const double* psi, const double* psi_from,
                                EnergySum& sum) const {
  if (quadrature_kernels_ == nullptr)
    simplex_kernels_->add_energies(simplex_tile(tile), psi, psi_from, sum);
  else
    quadrature_kernels_->add_energies(quadrature_tile(tile), psi, psi_from, sum);
}

void ElasticTiles::add_forces(const Tile& tile, const double* u, bool is_magnitude, const OwnedNodes& owned,
                              Scratch& scratch, double* forces) const {
  measure(tile, u, true, scratch);
  call_law(law_kernels_->gradient, tile, scratch.variables, true, scratch, scratch.law);
  if (quadrature_kernels_ == nullptr) {
    simplex_kernels_->add_forces(simplex_tile(tile, scratch), law_form(), scratch.H, scratch.frames,
                                 scratch.law, is_magnitude, owned, forces);
    return;
  }
  if (has_mean_volume_) {
    call_volume(tile, scratch);
    take_row(scratch.mean_volume, tile.num_blocks, 1, scratch.mean);
    replace_volume(tile, volume_slope_row, num_slopes(law->kind), 1, scratch.mean, scratch, scratch.law);
  }
  point_kernels_->stresses(state_tile(tile, scratch), scratch.law, scratch.stress);
  quadrature_kernels_->add_forces(quadrature_tile(tile), scratch.stress, is_magnitude, owned, forces);
}

void ElasticTiles::hessians(const Tile& tile, const double* u, Projection projection, const double* pressures,
                            Scratch& scratch) const {
  measure(tile, u, true, scratch);
  call_law(law_kernels_->curvature, tile, scratch.variables, true, scratch, scratch.law);
  const double removed = removed_part(projection);
  if (quadrature_kernels_ == nullptr) {
    simplex_kernels_->hessians(simplex_tile(tile, scratch), {law_form(), removed}, scratch.H, scratch.frames,
                               scratch.law, scratch.K);
    return;
  }
  if (has_mean_volume_) {
    call_volume(tile, scratch);
    take_row(scratch.mean_volume, tile.num_blocks, 1, scratch.mean);
    if (pressures != nullptr)
      for (std::size_t i = 0; i < tile.num_blocks; ++i)
        std::copy_n(pressures + static_cast<std::size_t>(tile.blocks[i]) * block_size, block_size,
                    scratch.mean + i * block_size);
    const int rows = num_curvature_rows(law->kind);
    replace_volume(tile, volume_slope_row, rows, 1, scratch.mean, scratch, scratch.law);
    replace_volume(tile, volume_curvature_row(law->kind), rows, 2, nullptr, scratch, scratch.law);
  }
  point_kernels_->tangents(state_tile(tile, scratch), removed, scratch.law, scratch.tangent);
  quadrature_kernels_->hessians(quadrature_tile(tile), scratch.tangent, scratch.K);
  if (has_mean_volume_) {
    take_row(scratch.mean_volume, tile.num_blocks, 2, scratch.mean);
    if (removed > 0)
      for (std::size_t i = 0; i < tile.num_blocks * block_size; ++i)
        scratch.mean[i] -= removed * std::min(scratch.mean[i], 0.0);
    quadrature_kernels_->add_mean_volume(quadrature_tile(tile), scratch.H, scratch.mean, scratch.K);
  }
}

void ElasticTiles::scatter(const Tile& tile, const MatrixPlaces& places, const OwnedNodes& owned,
                           Scratch& scratch, double* values) const {
  if (quadrature_kernels_ == nullptr)
    simplex_kernels_->scatter(simplex_tile(tile), scratch.K, places, owned, values);
  else
    quadrature_kernels_->scatter(quadrature_tile(tile), scratch.K, places, owned, values);
}

void ElasticTiles::prefetch(const Tile& tile, const double* u, const MatrixPlaces& places,
                            const double* values) const {
  if (quadrature_kernels_ == nullptr)
    simplex_kernels_->prefetch(simplex_tile(tile), u, places, values);
  else
    quadrature_kernels_->prefetch(quadrature_tile(tile), places, values);
}

void ElasticTiles::volume_energies(const Tile& tile, const double* u, Scratch& scratch) const {
  measure(tile, u, false, scratch);
  call_volume(tile, scratch);
}

void ElasticTiles::mean_pressures(const Tile& tile, const double* u, const double* v, double step,
                                  Scratch& scratch, double* pressures) const {
  volume_energies(tile, u, scratch);
  take_row(scratch.mean_volume, tile.num_blocks, 1, pressures);
  if (v == nullptr) return;
  gradients(tile, v, scratch, scratch.G);
  volume_cubics(tile, scratch.H, scratch.G, scratch.law);  // the slope of J along v is the second number
  for (std::size_t e = 0; e < num_entries(tile); ++e)
    std::copy_n(scratch.law + (e * 4 + 1) * block_size, block_size, scratch.j + e * block_size);
  quadrature_kernels_->mean(quadrature_tile(tile), scratch.j, scratch.mean_j);
  for (std::size_t i = 0; i < tile.num_blocks; ++i)
    for (int lane = 0; lane < block_size; ++lane)
      pressures[i * block_size + static_cast<std::size_t>(lane)] +=
          step * scratch.mean_volume[(i * 3 + 2) * block_size + static_cast<std::size_t>(lane)] *
          scratch.mean_j[i * block_size + static_cast<std::size_t>(lane)];
}

}  // namespace resilin
