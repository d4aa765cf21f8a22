// The arithmetic behind derivatives by an elastic body's own numbers, a tile at a time.
#include <algorithm>
#include <cmath>

#include "resilin/core/simd.hpp"
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

/// d/dp of this derivative by j of the law's volume energy into `slopes`, one row of lanes for each row of
/// `j`, to its digits but two. The law says nothing of it by itself.
void ElasticTiles::volume_slopes(const Tile& tile, const double* j, bool is_per_entry, std::size_t p,
                                 std::size_t derivative, Scratch& scratch,
                                 std::vector<double>& slopes) const {
  const LawBatch given = law_batch(tile, j, is_per_entry, scratch, nullptr);
  const std::size_t set_size = law->constants.size() * block_size;
  const std::size_t num_sets = given.constant_stride == 0 ? 1 : given.num_blocks;
  std::vector<double> sets(num_sets * set_size), results(given.num_blocks * 3 * block_size);
  slopes.assign(given.num_blocks * block_size, 0.0);
  const auto step = [&](std::size_t set, std::size_t lane) {
    const double* constants_of_set = given.constants + set * set_size + lane;
    const double own = std::abs(constants_of_set[p * block_size]);
    if (own > 0) return stencil_step * own;
    double largest = 0;
    for (std::size_t k = 0; k < law->constants.size(); ++k)
      largest = std::max(largest, std::abs(constants_of_set[k * block_size]));
    return stencil_step * largest;
  };
  for (int k = -stencil_reach; k <= stencil_reach; ++k) {
    if (k == 0) continue;
    std::copy_n(given.constants, sets.size(), sets.begin());
    for (std::size_t set = 0; set < num_sets; ++set)
      for (std::size_t lane = 0; lane < block_size; ++lane)
        sets[set * set_size + p * block_size + lane] += k * step(set, lane);
    law_kernels_->volume({given.num_blocks, j, sets.data(), given.constant_stride, results.data()});
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const std::size_t row = i / block_size, lane = i % block_size;
      slopes[i] += stencil(k) * results[(row * 3 + derivative) * block_size + lane] /
                   step(num_sets == 1 ? 0 : row, lane);
    }
  }
}

void ElasticTiles::constant_stresses(const Tile& tile, const double* u, std::size_t p,
                                     Scratch& scratch) const {
  measure(tile, u, true, scratch);
  const auto n = static_cast<std::size_t>(num_slopes(law->kind));
  law_kernels_->constant_gradient(law_batch(tile, scratch.variables, true, scratch, scratch.law),
                                  static_cast<int>(p));
  for (std::size_t e = 0; e < num_entries(tile); ++e)  // without dPsi/dp, the first row of each entry
    std::copy_n(scratch.law + (e * (n + 1) + 1) * block_size, n * block_size,
                scratch.law + e * n * block_size);
  if (has_mean_volume_) {
    call_volume(tile, scratch);
    std::vector<double> own, mean;
    volume_slopes(tile, scratch.j, true, p, 1, scratch, own);
    volume_slopes(tile, scratch.mean_j, false, p, 1, scratch, mean);
    const auto variables = static_cast<std::size_t>(num_variables(law->kind));
    for (std::size_t e = 0; e < num_entries(tile); ++e) {
      double* change = own.data() + e * block_size;
      for (std::size_t lane = 0; lane < block_size; ++lane)
        change[lane] = mean[e / blocks.num_points * block_size + lane] - change[lane];
      add_volume_energy(law->kind, scratch.variables + e * variables * block_size, change, nullptr, false,
                        scratch.law + e * n * block_size);
    }
  }
  point_kernels_->stresses(state_tile(tile, scratch), scratch.law, scratch.stress);
}

void ElasticTiles::constant_energies(const Tile& tile, const double* u, std::size_t p, Scratch& scratch,
                                     double* psi) const {
  measure(tile, u, false, scratch);
  const auto rows = static_cast<std::size_t>(num_slopes(law->kind)) + 1;
  law_kernels_->constant_gradient(law_batch(tile, scratch.variables, true, scratch, scratch.law),
                                  static_cast<int>(p));
  for (std::size_t e = 0; e < num_entries(tile); ++e)
    std::copy_n(scratch.law + e * rows * block_size, block_size, psi + e * block_size);
  if (!has_mean_volume_) return;
  call_volume(tile, scratch);
  std::vector<double> own, mean;
  volume_slopes(tile, scratch.j, true, p, 0, scratch, own);
  volume_slopes(tile, scratch.mean_j, false, p, 0, scratch, mean);
  for (std::size_t i = 0; i < own.size(); ++i)
    psi[i] += mean[i / block_size / blocks.num_points * block_size + i % block_size] - own[i];
}

void ElasticTiles::stresses_and_tangents(const Tile& tile, const double* u, Scratch& scratch) const {
  measure(tile, u, true, scratch);
  const auto take_mean = [&](std::size_t derivative) {
    for (std::size_t i = 0; i < tile.num_blocks; ++i)
      std::copy_n(scratch.mean_volume + (i * 3 + derivative) * block_size, block_size,
                  scratch.mean + i * block_size);
  };
  if (has_mean_volume_) {
    call_volume(tile, scratch);
    take_mean(1);
  }
  call_law(law_kernels_->gradient, tile, scratch.variables, true, scratch, scratch.law);
  if (has_mean_volume_)
    replace_volume(tile, volume_slope_row, num_slopes(law->kind), 1, scratch.mean, scratch, scratch.law);
  point_kernels_->stresses(state_tile(tile, scratch), scratch.law, scratch.stress);
  call_law(law_kernels_->curvature, tile, scratch.variables, true, scratch, scratch.law);
  if (has_mean_volume_) {
    const int rows = num_curvature_rows(law->kind);
    replace_volume(tile, volume_slope_row, rows, 1, scratch.mean, scratch, scratch.law);
    replace_volume(tile, volume_curvature_row(law->kind), rows, 2, nullptr, scratch, scratch.law);
  }
  point_kernels_->tangents(state_tile(tile, scratch), 0, scratch.law, scratch.tangent);
  if (has_mean_volume_) take_mean(2);
}

}  // namespace resilin
