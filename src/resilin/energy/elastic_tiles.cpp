#include "resilin/energy/elastic_tiles.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <span>

#include "resilin/core/parallel.hpp"
#include "resilin/core/simd.hpp"
#include "resilin/energy/axisymmetric_blocks.hpp"
#include "resilin/energy/kernels/axisymmetric_kernels.hpp"
#include "resilin/material/law_sum.hpp"
#include "resilin/material/volume_energy.hpp"

namespace resilin {
namespace {

constexpr int max_frame_rows = 18;

void add_to(const double* addends, std::size_t count, double* sums) {
  for (std::size_t i = 0; i < count; ++i) sums[i] += addends[i];
}

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
      has_mean_volume_(has_mean) {
  std::size_t fibre_part = 0;
  for (const LawPart& part : parts_of(material_law)) {
    parts_.push_back({part.law, &law_kernels(part.law->index, set), part.first_constant, fibre_part});
    if (part.law->max_fibres > 0) ++fibre_part;
  }
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
  const std::size_t mean_rows = tiles.has_mean_volume() ? 1 : 0, softened_rows = tiles.softened ? 1 : 0;
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
                        {&mean, mean_rows * entries},
                        {&isochoric_energy, softened_rows * entries},
                        {&isochoric, softened_rows * entries * max_curvature_rows},
                        {&part_energy, tiles.is_sum() ? entries : 0},
                        {&part_stress, tiles.is_sum() ? entries * n : 0},
                        {&part_tangent, tiles.is_sum() ? entries * n * n : 0},
                        {&part_K, tiles.is_sum() ? K_rows : 0}};
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
          nullptr};
}

const ElasticTiles::Part& ElasticTiles::part_of_constant(std::size_t p) const {
  std::size_t i = parts_.size() - 1;
  while (parts_[i].first_constant > p) --i;
  return parts_[i];
}

/// Null for a part without fibres, and before they are known.
const double* ElasticTiles::directions_of(const Part& part) const {
  if (part.law->max_fibres == 0 || directions.empty()) return nullptr;
  return directions.data() + part.fibre_part * blocks.num_blocks * fibre_rows * block_size;
}

ElementTile ElasticTiles::simplex_tile(const Tile& tile, const Part& part, Scratch& scratch) const {
  ElementTile result = simplex_tile(tile);
  result.directions = directions_of(part);
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
StateTile ElasticTiles::state_tile(const Tile& tile, const Part& part, Scratch& scratch) const {
  constexpr std::size_t rows = fibre_rows * block_size;
  const std::size_t entries = num_entries(tile);
  const double* own = directions_of(part);
  if (own != nullptr)
    for (std::size_t e = 0; e < entries; ++e)
      std::copy_n(own + static_cast<std::size_t>(tile.blocks[e / blocks.num_points]) * rows, rows,
                  scratch.directions + e * rows);
  return {entries, part.form(), scratch.H, scratch.frames, own == nullptr ? nullptr : scratch.directions,
          rows};
}

void ElasticTiles::gradients(const Tile& tile, const double* u, Scratch& scratch, double* H) const {
  constexpr LawForm any_law = {LawKind::invariants, false};  // H alone is wanted
  if (quadrature_kernels_ == nullptr)
    simplex_kernels_->measure(simplex_tile(tile, parts_.front(), scratch), any_law, u, H, scratch.variables,
                              nullptr);
  else
    quadrature_kernels_->gradients(quadrature_tile(tile), u, H);
}

void ElasticTiles::volume_cubics(const Tile& tile, const double* H, const double* G, double* cubics) const {
  simplex_kernels_->volume_cubics(num_entries(tile), H, G, cubics);
}

/// H, the law's variables and, when asked for and the law is one of stretches, their frames.
void ElasticTiles::measure(const Tile& tile, const Part& part, const double* u, bool keeps_frames,
                           Scratch& scratch) const {
  double* frames = keeps_frames ? scratch.frames : nullptr;
  if (quadrature_kernels_ == nullptr)
    return simplex_kernels_->measure(simplex_tile(tile, part, scratch), part.form(), u, scratch.H,
                                     scratch.variables, frames);
  quadrature_kernels_->gradients(quadrature_tile(tile), u, scratch.H);
  point_kernels_->variables(state_tile(tile, part, scratch), false, scratch.H, scratch.variables, frames);
}

/// Arguments of a kernel of a part for the entries of a tile, or once for each of its blocks.
LawBatch ElasticTiles::law_batch(const Tile& tile, const Part& part, const double* variables,
                                 bool is_per_entry, Scratch& scratch, double* results) const {
  const std::size_t points = is_per_entry ? blocks.num_points : 1, count = tile.num_blocks * points;
  const double* own = constants.data() + part.first_constant * block_size;
  if (constant_stride == 0) return {count, variables, own, 0, results};
  const std::size_t rows = part.law->constants.size() * block_size;
  for (std::size_t i = 0; i < count; ++i)
    std::copy_n(own + static_cast<std::size_t>(tile.blocks[i / points]) * constant_stride, rows,
                scratch.constants + i * rows);
  return {count, variables, scratch.constants, rows, results};
}

void ElasticTiles::isochoric_energies(const Tile& tile, const Part& part, Scratch& scratch) const {
  LawBatch batch = law_batch(tile, part, scratch.variables, true, scratch, scratch.isochoric_energy);
  batch.constants = isochoric_constants(tile, scratch);
  part.kernels->energy(batch);
}

/// As `law_batch` has the constants of the law for the entries of a tile.
const double* ElasticTiles::isochoric_constants(const Tile& tile, Scratch& scratch) const {
  if (constant_stride == 0) return softened->constants.data();
  for (std::size_t i = 0; i < num_entries(tile); ++i)
    std::copy_n(softened->constants.data() +
                    static_cast<std::size_t>(tile.blocks[i / blocks.num_points]) * constant_stride,
                constant_stride, scratch.constants + i * constant_stride);
  return scratch.constants;
}

double ElasticTiles::most_energy(const Tile& tile, std::size_t entry, std::size_t lane) const {
  const auto block = static_cast<std::size_t>(tile.blocks[entry / blocks.num_points]);
  return softened->most[(block * blocks.num_points + entry % blocks.num_points) * block_size + lane];
}

void ElasticTiles::soften_energies(const Tile& tile, const Part& part, Scratch& scratch, double* psi) const {
  isochoric_energies(tile, part, scratch);
  for (std::size_t i = 0; i < num_entries(tile) * block_size; ++i) {
    const double W = scratch.isochoric_energy[i], most = most_energy(tile, i / block_size, i % block_size);
    if (std::isfinite(W) && most > 0) psi[i] += softened->law.energy(W, most) - W;
  }
}

/// With phi(W) in place of W: phi' = eta, and phi'' = d eta/dW times the product of two slopes of W.
void ElasticTiles::soften_slopes(void (*kernel)(const LawBatch&), const Tile& tile, const Part& part,
                                 Scratch& scratch) const {
  const bool has_curvature = kernel == part.kernels->curvature;
  const LawKind kind = part.law->kind;
  const auto slopes = static_cast<std::size_t>(num_slopes(kind));
  const std::size_t rows = has_curvature ? static_cast<std::size_t>(num_curvature_rows(kind)) : slopes;
  isochoric_energies(tile, part, scratch);
  LawBatch batch = law_batch(tile, part, scratch.variables, true, scratch, scratch.isochoric);
  batch.constants = isochoric_constants(tile, scratch);
  kernel(batch);
  for (std::size_t i = 0; i < num_entries(tile) * block_size; ++i) {
    const std::size_t entry = i / block_size, lane = i % block_size;
    const double W = scratch.isochoric_energy[i], most = most_energy(tile, entry, lane);
    if (!(W < most)) continue;
    const double loss = softened->law.factor(W, most) - 1, bend = softened->law.factor_slope(W, most);
    double* out = scratch.law + entry * rows * block_size + lane;
    const double* of_W = scratch.isochoric + entry * rows * block_size + lane;
    for (std::size_t row = 0; row < rows; ++row) out[row * block_size] += loss * of_W[row * block_size];
    if (!has_curvature) continue;
    for (std::size_t a = 0, row = slopes; a < slopes; ++a)
      for (std::size_t b = a; b < slopes; ++b, ++row)
        out[row * block_size] += bend * of_W[a * block_size] * of_W[b * block_size];
  }
}

/// The volume energy and its derivatives at the entries (scratch.volume) and at the means of the cells
/// (scratch.mean_volume).
void ElasticTiles::call_volume(const Tile& tile, const Part& part, Scratch& scratch) const {
  const auto rows = static_cast<std::size_t>(num_variables(part.law->kind));
  const std::size_t entries = num_entries(tile);
  for (std::size_t e = 0; e < entries; ++e) {
    const double* variables = scratch.variables + e * rows * block_size;
    double* j = scratch.j + e * block_size;
    if (part.law->kind == LawKind::stretches)
      volume_of_stretches(variables, j);
    else
      std::copy_n(variables + 2 * block_size, block_size, j);
  }
  quadrature_kernels_->mean(quadrature_tile(tile), scratch.j, scratch.mean_j);
  call_law(part.kernels->volume, tile, part, scratch.j, true, scratch, scratch.volume);
  call_law(part.kernels->volume, tile, part, scratch.mean_j, false, scratch, scratch.mean_volume);
}

/// In the rows of a law's gradient, or its curvature, in scratch.law: dU/dJ of the entry gives way to the
/// pressure of its cell in scratch.mean, and d2U/dJ2 goes.
void ElasticTiles::replace_pressure(const Tile& tile, const Part& part, bool has_curvature,
                                    Scratch& scratch) const {
  const LawKind kind = part.law->kind;
  const auto rows = static_cast<std::size_t>(has_curvature ? num_curvature_rows(kind) : num_slopes(kind));
  const auto variables = static_cast<std::size_t>(num_variables(kind));
  alignas(64) double pressure[block_size], stiffness[block_size];
  for (std::size_t e = 0; e < num_entries(tile); ++e) {
    const double* own = scratch.volume + e * 3 * block_size;
    const double* mean = scratch.mean + e / blocks.num_points * block_size;
    for (int lane = 0; lane < block_size; ++lane) {
      pressure[lane] = mean[lane] - own[block_size + lane];
      stiffness[lane] = -own[2 * block_size + lane];
    }
    add_volume_energy(kind, scratch.variables + e * variables * block_size, pressure,
                      has_curvature ? stiffness : nullptr, scratch.law + e * rows * block_size);
  }
}

namespace {

/// Row `derivative` of [block][3][lane] as [block][lane].
void take_row(const double* rows, std::size_t num_blocks, std::size_t derivative, double* out) {
  for (std::size_t i = 0; i < num_blocks; ++i)
    std::copy_n(rows + (i * 3 + derivative) * block_size, block_size, out + i * block_size);
}

}  // namespace

void ElasticTiles::energies_of(const Part& part, const Tile& tile, const double* u, Scratch& scratch,
                               double* psi) const {
  measure(tile, part, u, false, scratch);
  call_law(part.kernels->energy, tile, part, scratch.variables, true, scratch, psi);
  if (softened) soften_energies(tile, part, scratch, psi);
  if (!has_mean_volume_) return;
  call_volume(tile, part, scratch);
  for (std::size_t i = 0; i < num_entries(tile) * block_size; ++i) {
    const std::size_t e = i / block_size, lane = i % block_size;
    psi[i] += scratch.mean_volume[e / blocks.num_points * 3 * block_size + lane] -
              scratch.volume[e * 3 * block_size + lane];
  }
}

void ElasticTiles::energies(const Tile& tile, const double* u, Scratch& scratch, double* psi) const {
  energies_of(parts_.front(), tile, u, scratch, psi);
  for (std::size_t i = 1; i < parts_.size(); ++i) {
    energies_of(parts_[i], tile, u, scratch, scratch.part_energy);
    add_to(scratch.part_energy, num_entries(tile) * block_size, psi);
  }
}

void ElasticTiles::magnitudes_of(const Part& part, const Tile& tile, const double* u, Scratch& scratch,
                                 double* psi) const {
  energies_of(part, tile, u, scratch, psi);
  call_law(part.kernels->gradient, tile, part, scratch.variables, true, scratch, scratch.law);
  const LawKind kind = part.law->kind;
  const int rows = num_slopes(kind);
  if (has_mean_volume_) {
    take_row(scratch.mean_volume, tile.num_blocks, 1, scratch.mean);
    replace_pressure(tile, part, false, scratch);
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
      const bool has_invariants = kind == LawKind::invariants || kind == LawKind::fibres;
      const double size = !has_invariants || row >= 2 ? of_j : row == 0 ? square : square * (1 + square);
      psi[i] +=
          std::abs(scratch.law[(entry * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row)) *
                                   block_size +
                               lane]) *
          size;
    }
  }
}

void ElasticTiles::magnitudes(const Tile& tile, const double* u, Scratch& scratch, double* psi) const {
  magnitudes_of(parts_.front(), tile, u, scratch, psi);
  for (std::size_t i = 1; i < parts_.size(); ++i) {
    magnitudes_of(parts_[i], tile, u, scratch, scratch.part_energy);
    add_to(scratch.part_energy, num_entries(tile) * block_size, psi);
  }
}

void ElasticTiles::add_energies(const Tile& tile, const double* psi, const double* psi_from,
                                EnergySum& sum) const {
  if (quadrature_kernels_ == nullptr)
    simplex_kernels_->add_energies(simplex_tile(tile), psi, psi_from, sum);
  else
    quadrature_kernels_->add_energies(quadrature_tile(tile), psi, psi_from, sum);
}

void ElasticTiles::add_forces_of(const Part& part, const Tile& tile, const double* u, bool is_magnitude,
                                 const OwnedNodes& owned, Scratch& scratch, double* forces) const {
  measure(tile, part, u, true, scratch);
  call_law(part.kernels->gradient, tile, part, scratch.variables, true, scratch, scratch.law);
  if (softened) soften_slopes(part.kernels->gradient, tile, part, scratch);
  if (quadrature_kernels_ == nullptr) {
    simplex_kernels_->add_forces(simplex_tile(tile, part, scratch), part.form(), scratch.H, scratch.frames,
                                 scratch.law, is_magnitude, owned, forces);
    return;
  }
  if (has_mean_volume_) {
    call_volume(tile, part, scratch);
    take_row(scratch.mean_volume, tile.num_blocks, 1, scratch.mean);
    replace_pressure(tile, part, false, scratch);
  }
  point_kernels_->stresses(state_tile(tile, part, scratch), scratch.law, scratch.stress);
  quadrature_kernels_->add_forces(quadrature_tile(tile), scratch.stress, is_magnitude, owned, forces);
}

void ElasticTiles::add_forces(const Tile& tile, const double* u, bool is_magnitude, const OwnedNodes& owned,
                              Scratch& scratch, double* forces) const {
  for (const Part& part : parts_) add_forces_of(part, tile, u, is_magnitude, owned, scratch, forces);
}

void ElasticTiles::hessians_of(const Part& part, const Tile& tile, const double* u, Projection projection,
                               const double* pressures, Scratch& scratch, double* K) const {
  measure(tile, part, u, true, scratch);
  call_law(part.kernels->curvature, tile, part, scratch.variables, true, scratch, scratch.law);
  if (softened) soften_slopes(part.kernels->curvature, tile, part, scratch);
  const double removed = removed_part(projection);
  if (quadrature_kernels_ == nullptr) {
    simplex_kernels_->hessians(simplex_tile(tile, part, scratch), {part.form(), removed}, scratch.H,
                               scratch.frames, scratch.law, K);
    return;
  }
  if (has_mean_volume_) {
    call_volume(tile, part, scratch);
    take_row(scratch.mean_volume, tile.num_blocks, 1, scratch.mean);
    if (pressures != nullptr)
      for (std::size_t i = 0; i < tile.num_blocks; ++i) {
        double* mean = scratch.mean + i * block_size;
        if (&part == &parts_.front())
          std::copy_n(pressures + static_cast<std::size_t>(tile.blocks[i]) * block_size, block_size, mean);
        else
          std::fill_n(mean, block_size, 0.0);
      }
    replace_pressure(tile, part, true, scratch);
  }
  point_kernels_->tangents(state_tile(tile, part, scratch), removed, scratch.law, scratch.tangent);
  quadrature_kernels_->hessians(quadrature_tile(tile), scratch.tangent, K);
  if (has_mean_volume_) {
    take_row(scratch.mean_volume, tile.num_blocks, 2, scratch.mean);
    if (removed > 0)
      for (std::size_t i = 0; i < tile.num_blocks * block_size; ++i)
        scratch.mean[i] -= removed * std::min(scratch.mean[i], 0.0);
    quadrature_kernels_->add_mean_volume(quadrature_tile(tile), scratch.H, scratch.mean, K);
  }
}

void ElasticTiles::hessians(const Tile& tile, const double* u, Projection projection, const double* pressures,
                            Scratch& scratch) const {
  hessians_of(parts_.front(), tile, u, projection, pressures, scratch, scratch.K);
  const auto size =
      tile.num_blocks * static_cast<std::size_t>(blocks.num_pairs() * blocks.dim * blocks.dim) * block_size;
  for (std::size_t i = 1; i < parts_.size(); ++i) {
    hessians_of(parts_[i], tile, u, projection, pressures, scratch, scratch.part_K);
    add_to(scratch.part_K, size, scratch.K);
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
  const std::size_t of_points = num_entries(tile) * 3 * block_size,
                    of_cells = tile.num_blocks * 3 * block_size;
  std::vector<double> points, means;
  for (const Part& part : parts_) {
    measure(tile, part, u, false, scratch);
    call_volume(tile, part, scratch);
    if (!is_sum()) return;
    points.resize(of_points);
    means.resize(of_cells);
    add_to(scratch.volume, of_points, points.data());
    add_to(scratch.mean_volume, of_cells, means.data());
  }
  std::ranges::copy(points, scratch.volume);
  std::ranges::copy(means, scratch.mean_volume);
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
