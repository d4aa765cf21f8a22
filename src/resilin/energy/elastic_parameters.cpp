// Derivatives of an elastic body's forces by the constants of its law and by its rest shape
// (docs/theory/gradients.md).
#include <algorithm>
#include <vector>

#include "resilin/core/parallel.hpp"
#include "resilin/energy/elastic.hpp"
#include "resilin/energy/lane_geometry.hpp"

namespace resilin {
namespace {

/// Slopes by one set of constants, summed over cells.
struct ConstantSlopes {
  std::vector<double> sums{};  ///< empty: all are zero
  ConstantSlopes& operator+=(const ConstantSlopes& other) {
    sums.resize(std::max(sums.size(), other.sums.size()), 0.0);
    for (std::size_t k = 0; k < other.sums.size(); ++k) sums[k] += other.sums[k];
    return *this;
  }
};

/// A : G
template <int dim>
LaneMatrix<dim> contracted(const double* tangent, const LaneMatrix<dim>& G) {
  constexpr auto size = static_cast<std::size_t>(dim * dim);
  LaneMatrix<dim> T;
  for (std::size_t i = 0; i < size; ++i) {
    T.entries[i].setZero();
    for (std::size_t k = 0; k < size; ++k)
      T.entries[i] += Eigen::Map<const LaneRow>(tangent + (i * size + k) * block_size) * G.entries[k];
  }
  return T;
}

/// Change of the stress by a change v of the reference shape, seen in the gradients of the shape functions as
/// they were; or, `is_transposed`, the numbers M of which sum W M g_a is the slope of w . dE/dx by X_a, v
/// then being w. With L = dv/dX and G = dw/dX:
///
///   d(W P g_a) = W (tr L P - A : (F L) - P L^T) g_a,   M = (P : G) I - F^T (A : G) - G^T P.
template <int dim>
LaneMatrix<dim> shape_stress(const LaneMatrix<dim>& F, const LaneMatrix<dim>& P, const double* tangent,
                             const LaneMatrix<dim>& V, bool is_transposed) {
  const LaneRow minus = LaneRow::Constant(-1);
  if (!is_transposed) return V.trace() * P - contracted<dim>(tangent, F * V) - P * V.transposed();
  return (minus * (F.transposed() * contracted<dim>(tangent, V) + V.transposed() * P))
      .plus_identity(contracted(P, V));
}

struct VolumeAndChange {
  LaneRow volume, change;
};

/// Volumes of the cells of a block at rest, and the integral of cof F : V that gradients V make of the
/// deformed one; `is_of_rest_shape`, that of tr V.
/// @param H  gradients of displacements at the points of the block
template <int dim>
VolumeAndChange volume_and_change(const ElementBlocks& blocks, std::size_t block, const double* H,
                                  const double* gradients, bool is_of_rest_shape = false) {
  constexpr std::size_t size = static_cast<std::size_t>(dim * dim) * block_size;
  VolumeAndChange sums{LaneRow::Zero(), LaneRow::Zero()};
  for (std::size_t q = 0; q < blocks.num_points; ++q) {
    const LaneRow W = LanePoint<dim>(blocks, block, q).weight();
    const auto F = LaneMatrix<dim>::load(H + q * size).plus_identity(LaneRow::Ones());
    const auto V = LaneMatrix<dim>::load(gradients + q * size);
    sums.volume += W;
    sums.change += W * (is_of_rest_shape ? V.trace() : contracted(cofactor(F), V));
  }
  return sums;
}

}  // namespace

std::vector<EnergyParameter> ElasticEnergy::parameters() const {
  const auto n = static_cast<Eigen::Index>(law().constants.size());
  return {{"constants", tiles_.constant_stride == 0 ? n : n * num_cells()},
          {"rest_positions", num_world_unknowns_}};
}

void ElasticEnergy::add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w,
                                         const Conditions&, VectorX& slopes) const {
  if (name == "constants") return add_constant_slopes(x, w, slopes);
  tiles_.blocks.dim == 2 ? add_shape_forces<2>(x, w, true, slopes) : add_shape_forces<3>(x, w, true, slopes);
}

void ElasticEnergy::add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                                         const Conditions&, VectorX& gradient) const {
  const bool is_plane = tiles_.blocks.dim == 2;
  if (name == "constants")
    return is_plane ? add_constant_forces<2>(x, change, gradient)
                    : add_constant_forces<3>(x, change, gradient);
  is_plane ? add_shape_forces<2>(x, change, false, gradient)
           : add_shape_forces<3>(x, change, false, gradient);
}

void ElasticEnergy::add_energy_slopes(std::string_view name, const VectorX& x, VectorX& slopes) const {
  if (name == "constants") return add_constant_energies(x, slopes);
  tiles_.blocks.dim == 2 ? add_shape_energies<2>(x, slopes) : add_shape_energies<3>(x, slopes);
}

void ElasticEnergy::add_tangent_forces(const VectorX& x, const VectorX& w, VectorX& forces) const {
  tiles_.blocks.dim == 2 ? add_tangent_products<2>(x, w, forces) : add_tangent_products<3>(x, w, forces);
}

void ElasticEnergy::add_volume_slopes(std::span<const double> by_cell, VectorX& slopes) const {
  tiles_.blocks.dim == 2 ? add_shape_volumes<2>(by_cell, slopes) : add_shape_volumes<3>(by_cell, slopes);
}

void ElasticEnergy::add_weighted_slopes(const FillSlopes& fill, VectorX& slopes) const {
  const ElementBlocks& blocks = tiles_.blocks;
  const std::size_t n = law().constants.size();
  const bool is_uniform = tiles_.constant_stride == 0;
  const ConstantSlopes sum = parallel_sum<ConstantSlopes>(
      all_blocks_.size(), blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
        ConstantSlopes of_chunk{std::vector<double>(n, 0.0)};
        ElasticTiles::Scratch scratch(tiles_);
        for_tiles(tiles_, all_blocks_.data() + begin, end - begin, [&](const ElasticTiles::Tile& tile) {
          for (std::size_t p = 0; p < n; ++p) {
            fill(tile, p, scratch, scratch.energy);
            for (std::size_t i = 0; i < tiles_.num_entries(tile) * block_size; ++i) {
              const std::size_t e = i / block_size, lane = i % block_size;
              const auto block = static_cast<std::size_t>(tile.blocks[e / blocks.num_points]);
              const Index cell = blocks.cells[block * block_size + lane];
              if (cell < 0) continue;
              const double share =
                  scratch.energy[i] *
                  blocks.weights[(block * blocks.num_points + e % blocks.num_points) * block_size + lane];
              if (is_uniform)
                of_chunk.sums[p] += share;
              else
                slopes[static_cast<Eigen::Index>(static_cast<std::size_t>(cell) * n + p)] += share;
            }
          }
        });
        return of_chunk;
      });
  for (std::size_t p = 0; is_uniform && p < sum.sums.size(); ++p)
    slopes[static_cast<Eigen::Index>(p)] += sum.sums[p];
}

void ElasticEnergy::add_constant_slopes(const VectorX& x, const VectorX& w, VectorX& slopes) const {
  const std::vector<double> u = tiles_.blocks.local_displacements(x), v = tiles_.blocks.local_values(w);
  const auto size = static_cast<std::size_t>(tiles_.blocks.dim * tiles_.blocks.dim);
  add_weighted_slopes(
      [&](const ElasticTiles::Tile& tile, std::size_t p, ElasticTiles::Scratch& scratch, double* powers) {
        tiles_.constant_stresses(tile, u.data(), p, scratch);
        tiles_.gradients(tile, v.data(), scratch, scratch.G);
        for (std::size_t e = 0; e < tiles_.num_entries(tile); ++e) {
          LaneRow power = LaneRow::Zero();
          for (std::size_t i = e * size; i < (e + 1) * size; ++i)
            power += Eigen::Map<const LaneRow>(scratch.stress + i * block_size) *
                     Eigen::Map<const LaneRow>(scratch.G + i * block_size);
          Eigen::Map<LaneRow>(powers + e * block_size) = power;
        }
      },
      slopes);
}

void ElasticEnergy::add_constant_energies(const VectorX& x, VectorX& slopes) const {
  const std::vector<double> u = tiles_.blocks.local_displacements(x);
  add_weighted_slopes([&](const ElasticTiles::Tile& tile, std::size_t p, ElasticTiles::Scratch& scratch,
                          double* psi) { tiles_.constant_energies(tile, u.data(), p, scratch, psi); },
                      slopes);
}

template <int dim>
void ElasticEnergy::add_constant_forces(const VectorX& x, const VectorX& change, VectorX& gradient) const {
  const ElementBlocks& blocks = tiles_.blocks;
  const std::size_t n = law().constants.size();
  const std::vector<double> u = blocks.local_displacements(x);
  add_by_owner(
      [&](const ElasticTiles::Tile& tile, const OwnedNodes& owned, ElasticTiles::Scratch& scratch,
          double* local) {
        for (std::size_t p = 0; p < n; ++p) {
          tiles_.constant_stresses(tile, u.data(), p, scratch);
          for (std::size_t e = 0; e < tiles_.num_entries(tile); ++e) {
            const auto block = static_cast<std::size_t>(tile.blocks[e / blocks.num_points]);
            LaneRow factor;
            for (std::size_t lane = 0; lane < block_size; ++lane) {
              const Index cell = std::max(blocks.cells[block * block_size + lane], Index{0});
              const std::size_t set = tiles_.constant_stride == 0 ? 0 : static_cast<std::size_t>(cell);
              factor[static_cast<Eigen::Index>(lane)] = change[static_cast<Eigen::Index>(set * n + p)];
            }
            const auto P = LaneMatrix<dim>::load(scratch.stress + e * dim * dim * block_size);
            LanePoint<dim>(blocks, block, e % blocks.num_points).add(factor * P, owned, local);
          }
        }
      },
      gradient);
}

/// With a mean volume the stress holds U'(J_mean) cof F besides. The deformed volume V J_mean of a cell does
/// not depend on its rest shape, so that dJ_mean = -J_mean/V sum_q W tr L.
template <int dim>
void ElasticEnergy::add_shape_forces(const VectorX& x, const VectorX& direction, bool is_transposed,
                                     VectorX& result) const {
  const ElementBlocks& blocks = tiles_.blocks;
  const std::vector<double> u = blocks.local_displacements(x), v = blocks.local_values(direction);
  constexpr std::size_t size = static_cast<std::size_t>(dim * dim) * block_size;
  const LaneRow one = LaneRow::Ones();
  add_by_owner(
      [&](const ElasticTiles::Tile& tile, const OwnedNodes& owned, ElasticTiles::Scratch& scratch,
          double* local) {
        tiles_.stresses_and_tangents(tile, u.data(), scratch);
        tiles_.gradients(tile, v.data(), scratch, scratch.G);
        for (std::size_t i = 0; i < tile.num_blocks; ++i) {
          const auto block = static_cast<std::size_t>(tile.blocks[i]);
          const std::size_t first = i * blocks.num_points;
          LaneRow change_of_pressure = LaneRow::Zero();  // or, transposed, of each unit of tr L
          if (tiles_.has_mean_volume()) {
            const auto [volume, sum] = volume_and_change<dim>(blocks, block, scratch.H + first * size,
                                                              scratch.G + first * size, !is_transposed);
            const Eigen::Map<const LaneRow> mean_j(scratch.mean_j + i * block_size),
                second(scratch.mean + i * block_size);
            change_of_pressure = (volume > 0).select(-second * (1 + mean_j) * sum / volume, 0.0);
          }
          for (std::size_t q = 0; q < blocks.num_points; ++q) {
            const std::size_t e = first + q;
            const auto F = LaneMatrix<dim>::load(scratch.H + e * size).plus_identity(one);
            const auto P = LaneMatrix<dim>::load(scratch.stress + e * size);
            const auto V = LaneMatrix<dim>::load(scratch.G + e * size);
            LaneMatrix<dim> M =
                shape_stress<dim>(F, P, scratch.tangent + e * size * dim * dim, V, is_transposed);
            if (tiles_.has_mean_volume())
              M = is_transposed ? M.plus_identity(change_of_pressure) : M + change_of_pressure * cofactor(F);
            LanePoint<dim>(blocks, block, q).add(M, owned, local);
          }
        }
      },
      result);
}

/// dE = sum_q W (Psi tr L - P : (F L)), so that X_a gets sum_q W (Psi I - F^T P) g_a. With a mean volume P
/// holds U'(J_mean) cof F, of which dJ_mean leaves U'(J_mean) (J - J_mean) tr L.
template <int dim>
void ElasticEnergy::add_shape_energies(const VectorX& x, VectorX& slopes) const {
  const ElementBlocks& blocks = tiles_.blocks;
  const std::vector<double> u = blocks.local_displacements(x);
  constexpr std::size_t size = static_cast<std::size_t>(dim * dim) * block_size;
  const LaneRow one = LaneRow::Ones(), minus = -one;
  add_by_owner(
      [&](const ElasticTiles::Tile& tile, const OwnedNodes& owned, ElasticTiles::Scratch& scratch,
          double* local) {
        tiles_.energies(tile, u.data(), scratch, scratch.energy);
        tiles_.stresses_and_tangents(tile, u.data(), scratch);
        for (std::size_t e = 0; e < tiles_.num_entries(tile); ++e) {
          const std::size_t i = e / blocks.num_points;
          const auto F = LaneMatrix<dim>::load(scratch.H + e * size).plus_identity(one);
          const auto P = LaneMatrix<dim>::load(scratch.stress + e * size);
          LaneRow of_identity = Eigen::Map<const LaneRow>(scratch.energy + e * block_size);
          if (tiles_.has_mean_volume())
            of_identity += Eigen::Map<const LaneRow>(scratch.mean_volume + (i * 3 + 1) * block_size) *
                           (Eigen::Map<const LaneRow>(scratch.j + e * block_size) -
                            Eigen::Map<const LaneRow>(scratch.mean_j + i * block_size));
          LanePoint<dim>(blocks, static_cast<std::size_t>(tile.blocks[i]), e % blocks.num_points)
              .add((minus * (F.transposed() * P)).plus_identity(of_identity), owned, local);
        }
      },
      slopes);
}

/// sum_q W (dP/dF : G) g_a; with a mean volume its pressure changes by U'' dJ_mean besides.
template <int dim>
void ElasticEnergy::add_tangent_products(const VectorX& x, const VectorX& w, VectorX& forces) const {
  const ElementBlocks& blocks = tiles_.blocks;
  const std::vector<double> u = blocks.local_displacements(x), v = blocks.local_values(w);
  constexpr std::size_t size = static_cast<std::size_t>(dim * dim) * block_size;
  const LaneRow one = LaneRow::Ones();
  add_by_owner(
      [&](const ElasticTiles::Tile& tile, const OwnedNodes& owned, ElasticTiles::Scratch& scratch,
          double* local) {
        tiles_.stresses_and_tangents(tile, u.data(), scratch);
        tiles_.gradients(tile, v.data(), scratch, scratch.G);
        for (std::size_t i = 0; i < tile.num_blocks; ++i) {
          const auto block = static_cast<std::size_t>(tile.blocks[i]);
          const std::size_t first = i * blocks.num_points;
          LaneRow change_of_pressure = LaneRow::Zero();
          if (tiles_.has_mean_volume()) {
            const auto [volume, sum] =
                volume_and_change<dim>(blocks, block, scratch.H + first * size, scratch.G + first * size);
            const Eigen::Map<const LaneRow> second(scratch.mean + i * block_size);
            change_of_pressure = (volume > 0).select(second * sum / volume, 0.0);
          }
          for (std::size_t q = 0; q < blocks.num_points; ++q) {
            const std::size_t e = first + q;
            const auto F = LaneMatrix<dim>::load(scratch.H + e * size).plus_identity(one);
            auto M = contracted<dim>(scratch.tangent + e * size * dim * dim,
                                     LaneMatrix<dim>::load(scratch.G + e * size));
            if (tiles_.has_mean_volume()) M = M + change_of_pressure * cofactor(F);
            LanePoint<dim>(blocks, block, q).add(M, owned, local);
          }
        }
      },
      forces);
}

template <int dim>
void ElasticEnergy::add_shape_volumes(std::span<const double> by_cell, VectorX& slopes) const {
  const ElementBlocks& blocks = tiles_.blocks;
  add_by_owner(
      [&](const ElasticTiles::Tile& tile, const OwnedNodes& owned, ElasticTiles::Scratch&, double* local) {
        for (std::size_t e = 0; e < tiles_.num_entries(tile); ++e) {
          const auto block = static_cast<std::size_t>(tile.blocks[e / blocks.num_points]);
          LaneRow by;
          for (std::size_t lane = 0; lane < block_size; ++lane) {
            const Index cell = blocks.cells[block * block_size + lane];
            by[static_cast<Eigen::Index>(lane)] = cell < 0 ? 0 : by_cell[static_cast<std::size_t>(cell)];
          }
          LanePoint<dim>(blocks, block, e % blocks.num_points)
              .add(LaneMatrix<dim>::zero().plus_identity(by), owned, local);
        }
      },
      slopes);
}

}  // namespace resilin
