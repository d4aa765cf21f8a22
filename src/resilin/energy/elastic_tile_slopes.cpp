// The arithmetic behind derivatives by an elastic body's own numbers, a tile at a time.
#include <algorithm>
#include <cmath>

#include "resilin/core/simd.hpp"
#include "resilin/energy/axisymmetric_blocks.hpp"
#include "resilin/energy/elastic_tiles.hpp"
#include "resilin/material/volume_energy.hpp"

namespace resilin {
namespace {

/// f' from f(-3h) .. f(3h): exact for polynomials of degree 6.
constexpr int stencil_reach = 3;
constexpr double stencil(int k) {
  constexpr double weights[] = {0, 45.0 / 60, -9.0 / 60, 1.0 / 60};
  return k < 0 ? -weights[-k] : weights[k];
}
/// Share of a constant's size. Volume energies are linear in their constants, or nearly so.
constexpr double stencil_step = 1e-2;

}  // namespace

/// d/dp of this derivative by j of a part's volume energy into `slopes`, one row of lanes for each row of
/// `j`, to its digits but two. The law says nothing of it by itself.
void ElasticTiles::volume_slopes(const Tile& tile, const Part& part, const double* j, bool is_per_entry,
                                 std::size_t p, std::size_t derivative, Scratch& scratch,
                                 std::vector<double>& slopes) const {
  const LawBatch given = law_batch(tile, part, j, is_per_entry, scratch, nullptr);
  const std::size_t num_constants = part.law->constants.size(), set_size = num_constants * block_size;
  const std::size_t num_sets = given.constant_stride == 0 ? 1 : given.num_blocks;
  std::vector<double> sets(num_sets * set_size), results(given.num_blocks * 3 * block_size);
  slopes.assign(given.num_blocks * block_size, 0.0);
  const auto step = [&](std::size_t set, std::size_t lane) {
    const double* constants_of_set = given.constants + set * set_size + lane;
    const double own = std::abs(constants_of_set[p * block_size]);
    if (own > 0) return stencil_step * own;
    double largest = 0;
    for (std::size_t k = 0; k < num_constants; ++k)
      largest = std::max(largest, std::abs(constants_of_set[k * block_size]));
    return stencil_step * (largest > 0 ? largest : 1);
  };
  for (int k = -stencil_reach; k <= stencil_reach; ++k) {
    if (k == 0) continue;
    std::copy_n(given.constants, sets.size(), sets.begin());
    for (std::size_t set = 0; set < num_sets; ++set)
      for (std::size_t lane = 0; lane < block_size; ++lane)
        sets[set * set_size + p * block_size + lane] += k * step(set, lane);
    part.kernels->volume({given.num_blocks, j, sets.data(), given.constant_stride, results.data()});
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const std::size_t row = i / block_size, lane = i % block_size;
      slopes[i] += stencil(k) * results[(row * 3 + derivative) * block_size + lane] /
                   step(num_sets == 1 ? 0 : row, lane);
    }
  }
}

void ElasticTiles::constant_stresses(const Tile& tile, const double* u, std::size_t p,
                                     Scratch& scratch) const {
  const Part& part = part_of_constant(p);
  const std::size_t own_p = p - part.first_constant;
  measure(tile, part, u, true, scratch);
  const auto n = static_cast<std::size_t>(num_slopes(part.law->kind)),
             variables = static_cast<std::size_t>(num_variables(part.law->kind));
  part.kernels->constant_gradient(law_batch(tile, part, scratch.variables, true, scratch, scratch.law),
                                  static_cast<int>(own_p));
  for (std::size_t e = 0; e < num_entries(tile); ++e)  // without dPsi/dp, the first row of each entry
    std::copy_n(scratch.law + (e * (n + 1) + 1) * block_size, n * block_size,
                scratch.law + e * n * block_size);
  if (has_mean_volume_) {
    call_volume(tile, part, scratch);
    std::vector<double> own, mean;
    volume_slopes(tile, part, scratch.j, true, own_p, 1, scratch, own);
    volume_slopes(tile, part, scratch.mean_j, false, own_p, 1, scratch, mean);
    for (std::size_t e = 0; e < num_entries(tile); ++e) {
      double* change = own.data() + e * block_size;
      for (std::size_t lane = 0; lane < block_size; ++lane)
        change[lane] = mean[e / blocks.num_points * block_size + lane] - change[lane];
      add_volume_energy(part.law->kind, scratch.variables + e * variables * block_size, change, nullptr,
                        scratch.law + e * n * block_size);
    }
  }
  point_kernels_->stresses(state_tile(tile, part, scratch), scratch.law, scratch.stress);
}

void ElasticTiles::constant_energies(const Tile& tile, const double* u, std::size_t p, Scratch& scratch,
                                     double* psi) const {
  const Part& part = part_of_constant(p);
  const std::size_t own_p = p - part.first_constant;
  measure(tile, part, u, false, scratch);
  const auto rows = static_cast<std::size_t>(num_slopes(part.law->kind)) + 1;
  part.kernels->constant_gradient(law_batch(tile, part, scratch.variables, true, scratch, scratch.law),
                                  static_cast<int>(own_p));
  for (std::size_t e = 0; e < num_entries(tile); ++e)
    std::copy_n(scratch.law + e * rows * block_size, block_size, psi + e * block_size);
  if (!has_mean_volume_) return;
  call_volume(tile, part, scratch);
  std::vector<double> own, mean;
  volume_slopes(tile, part, scratch.j, true, own_p, 0, scratch, own);
  volume_slopes(tile, part, scratch.mean_j, false, own_p, 0, scratch, mean);
  for (std::size_t i = 0; i < own.size(); ++i)
    psi[i] += mean[i / block_size / blocks.num_points * block_size + i % block_size] - own[i];
}

void ElasticTiles::stresses_and_tangents_of(const Part& part, const Tile& tile, const double* u,
                                            Scratch& scratch, double* stress, double* tangent) const {
  measure(tile, part, u, true, scratch);
  if (has_mean_volume_) {
    call_volume(tile, part, scratch);
    for (std::size_t i = 0; i < tile.num_blocks; ++i)
      std::copy_n(scratch.mean_volume + (i * 3 + 1) * block_size, block_size, scratch.mean + i * block_size);
  }
  call_law(part.kernels->gradient, tile, part, scratch.variables, true, scratch, scratch.law);
  if (has_mean_volume_) replace_pressure(tile, part, false, scratch);
  point_kernels_->stresses(state_tile(tile, part, scratch), scratch.law, stress);
  call_law(part.kernels->curvature, tile, part, scratch.variables, true, scratch, scratch.law);
  if (has_mean_volume_) replace_pressure(tile, part, true, scratch);
  point_kernels_->tangents(state_tile(tile, part, scratch), 0, scratch.law, tangent);
}

void ElasticTiles::stresses_and_tangents(const Tile& tile, const double* u, Scratch& scratch) const {
  const std::size_t n = static_cast<std::size_t>(state_dim(blocks) * state_dim(blocks)),
                    entries = num_entries(tile) * block_size, of_cells = tile.num_blocks * block_size;
  std::vector<double> stiffness(has_mean_volume_ ? of_cells : 0, 0.0);
  for (const Part& part : parts_) {
    const bool is_first = &part == &parts_.front();
    if (is_first) {
      stresses_and_tangents_of(part, tile, u, scratch, scratch.stress, scratch.tangent);
    } else {
      stresses_and_tangents_of(part, tile, u, scratch, scratch.part_stress, scratch.part_tangent);
      for (std::size_t i = 0; i < n * entries; ++i) scratch.stress[i] += scratch.part_stress[i];
      for (std::size_t i = 0; i < n * n * entries; ++i) scratch.tangent[i] += scratch.part_tangent[i];
    }
    for (std::size_t i = 0; i < stiffness.size(); ++i)
      stiffness[i] += scratch.mean_volume[(i / block_size * 3 + 2) * block_size + i % block_size];
  }
  if (has_mean_volume_) std::ranges::copy(stiffness, scratch.mean);
}

}  // namespace resilin
