// Fields of an elastic body, cell by cell.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "resilin/core/parallel.hpp"
#include "resilin/core/simd.hpp"
#include "resilin/energy/axisymmetric_blocks.hpp"
#include "resilin/energy/elastic.hpp"
#include "resilin/material/law_sum.hpp"
#include "resilin/material/plane_stress.hpp"

namespace resilin {
namespace {

constexpr std::size_t points_per_chunk = 2048;

using RowMatrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// The states at all quadrature points of a body and their materials, for the law's batches.
class PointStates {
 public:
  /// @param is_uniform  all cells have one material
  /// @param fill        writes H = F - I of every point
  template <class Fill>
  PointStates(const ElasticEnergy& elastic, bool is_uniform, const Fill& fill)
      : gradients_(static_cast<std::size_t>(elastic.num_cells() * elastic.num_points())) {
    fill(gradients_);
    batch_ = {.law = &elastic.law(),
              .dim = 3,
              .count = gradients_.size(),
              .deformation_gradients = gradients_.empty() ? nullptr : gradients_.front().data(),
              .holds_displacement_gradients = true,
              .constants = {}};
    add_materials(elastic, is_uniform);
    if (is_plane_stress(elastic.law()) && !gradients_.empty()) add_thickness();
  }
  PointStates(const PointStates&) = delete;
  PointStates& operator=(const PointStates&) = delete;

  std::size_t count() const { return gradients_.size(); }
  const std::vector<RowMatrix>& gradients() const { return gradients_; }
  const StateBatch<double>& batch() const { return batch_; }

 private:
  /// One row of constants and of fibres for all points, or one for each.
  void add_materials(const ElasticEnergy& elastic, bool is_uniform) {
    if (gradients_.empty()) return;
    const Index num_cells = is_uniform ? 1 : elastic.num_cells(),
                repeats = is_uniform ? 1 : elastic.num_points();
    for (Index cell = 0; cell < num_cells; ++cell) {
      const Material material = elastic.material(cell);
      batch_.num_fibres = material.fibres.size();
      for (Index q = 0; q < repeats; ++q) {
        constants_.insert(constants_.end(), material.constants.begin(), material.constants.end());
        fibres_.insert(fibres_.end(), material.fibres.begin(), material.fibres.end());
      }
    }
    const std::size_t num_constants = elastic.law().constants.size();
    for (std::size_t k = 0; k < num_constants; ++k)
      batch_.constants.push_back({constants_.data() + k, is_uniform ? 0 : num_constants});
    if (!fibres_.empty()) batch_.fibres = fibres_.front().data();
    batch_.fibre_stride = is_uniform ? 0 : 3 * batch_.num_fibres;
  }

  /// In plane stress the thickness is what the law makes of the plane.
  void add_thickness() {
    std::vector<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>> plane(gradients_.size());
    for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = gradients_[i].topLeftCorner<2, 2>();
    std::vector<double> strains(plane.size());
    StateBatch<double> states = batch_;
    states.dim = 2;
    states.deformation_gradients = plane.front().data();
    thickness_strains(states, strains.data());
    for (std::size_t i = 0; i < plane.size(); ++i) gradients_[i](2, 2) = strains[i];
  }

  std::vector<RowMatrix> gradients_;
  std::vector<double> constants_;
  std::vector<Vector3> fibres_;
  StateBatch<double> batch_;
};

/// Calls `body(cell, point, J)` for the quadrature points of these blocks. @param u  by local node
template <class Body>
void for_volume_ratios(const ElasticTiles& tiles, std::span<const Index> of_blocks, const double* u,
                       const Body& body) {
  const ElementBlocks& blocks = tiles.blocks;
  ElasticTiles::Scratch scratch(tiles);
  for_tiles(tiles, of_blocks.data(), of_blocks.size(), [&](const ElasticTiles::Tile& tile) {
    tiles.gradients(tile, u, scratch, scratch.H);
    tiles.volume_cubics(tile, scratch.H, scratch.H, scratch.law);  // J is the first number
    for (std::size_t entry = 0; entry < tiles.num_entries(tile); ++entry) {
      const Index* cells =
          blocks.cells.data() + static_cast<std::size_t>(tile.blocks[entry / blocks.num_points]) * block_size;
      for (std::size_t lane = 0; lane < block_size; ++lane)
        if (cells[lane] >= 0)
          body(static_cast<std::size_t>(cells[lane]), entry % blocks.num_points,
               scratch.law[entry * 4 * block_size + lane]);
    }
  });
}

/// The least J and the first point where it is; the first point where it is not a number, if there is one.
struct LeastRatio {
  static constexpr std::size_t nowhere = std::numeric_limits<std::size_t>::max();
  double ratio = std::numeric_limits<double>::infinity();
  std::size_t place = nowhere;

  LeastRatio& operator+=(const LeastRatio& other) {
    const bool here = std::isnan(ratio), there = std::isnan(other.ratio);
    const bool is_alike = here || there ? here && there : ratio == other.ratio;
    if (is_alike ? other.place < place : there || (!here && other.ratio < ratio)) *this = other;
    return *this;
  }
};

}  // namespace

void ElasticEnergy::for_each_point(const VectorX& x, const PointBody& body) const {
  const ElementBlocks& blocks = tiles_.blocks;
  const std::vector<double> u = blocks.local_displacements(x);
  const int dim = state_dim(blocks);
  const auto entries = static_cast<std::size_t>(dim * dim);
  parallel_for(blocks.num_blocks, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    ElasticTiles::Scratch scratch(tiles_);
    for_tiles(tiles_, all_blocks_.data() + begin, end - begin, [&](const ElasticTiles::Tile& tile) {
      tiles_.gradients(tile, u.data(), scratch, scratch.H);
      tiles_.volume_cubics(tile, scratch.H, scratch.H, scratch.law);  // J is the first number
      for (std::size_t i = 0; i < tiles_.num_entries(tile) * block_size; ++i) {
        const std::size_t entry = i / block_size, lane = i % block_size;
        const auto block = static_cast<std::size_t>(tile.blocks[entry / blocks.num_points]);
        const Index cell = blocks.cells[block * block_size + lane];
        if (cell < 0) continue;
        Matrix<3> H = Matrix<3>::Zero();
        for (std::size_t k = 0; k < entries; ++k)
          H(static_cast<int>(k) / dim, static_cast<int>(k) % dim) =
              scratch.H[(entry * entries + k) * block_size + lane];
        body(static_cast<std::size_t>(cell), entry % blocks.num_points, H,
             scratch.law[entry * 4 * block_size + lane]);
      }
    });
  });
}

ElasticEnergy::VolumeRatio ElasticEnergy::min_volume_ratio(const VectorX& x) const {
  if (is_plane_stress(law())) {
    const std::vector<double> ratios = volume_ratios(x);
    LeastRatio least;
    for (std::size_t i = 0; i < ratios.size(); ++i) least += LeastRatio{ratios[i], i};
    if (least.place == LeastRatio::nowhere) return {least.ratio, -1};
    return {least.ratio, static_cast<Index>(least.place) / num_points()};
  }
  const std::vector<double> u = tiles_.blocks.local_displacements(x);
  const LeastRatio least =
      parallel_sum<LeastRatio>(all_blocks_.size(), blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
        LeastRatio part;
        for_volume_ratios(tiles_, std::span(all_blocks_).subspan(begin, end - begin), u.data(),
                          [&](std::size_t cell, std::size_t point, double J) {
                            part += LeastRatio{J, place(cell, point)};
                          });
        return part;
      });
  if (least.place == LeastRatio::nowhere) return {least.ratio, -1};
  return {least.ratio, static_cast<Index>(least.place) / num_points()};
}

double ElasticEnergy::total_rest_volume() const {
  return std::accumulate(tiles_.blocks.weights.begin(), tiles_.blocks.weights.end(), 0.0);
}

Material ElasticEnergy::material(Index cell) const {
  Material material{&law(), std::vector<double>(law().constants.size()), {}};
  const auto lane_place = static_cast<std::size_t>(lane_of_cell_[static_cast<std::size_t>(cell)]);
  const std::size_t block = lane_place / block_size, lane = lane_place % block_size;
  const std::size_t at = tiles_.constant_stride == 0 ? 0 : block * tiles_.constant_stride + lane;
  for (std::size_t k = 0; k < material.constants.size(); ++k)
    material.constants[k] = tiles_.constants[at + k * block_size];
  const double* of_part = tiles_.directions.data();
  for (const LawPart& part : parts_of(law())) {
    if (part.law->max_fibres == 0) continue;
    const std::size_t own = num_own_families(part, num_families_);
    for (std::size_t family = 0; family < own; ++family) {
      const double* rows = of_part + (block * fibre_rows + 3 * family) * block_size + lane;
      material.fibres.emplace_back(rows[0], rows[block_size], rows[2 * block_size]);
    }
    of_part += tiles_.blocks.num_blocks * fibre_rows * block_size;
  }
  return material;
}

std::vector<double> ElasticEnergy::point_volumes() const {
  const auto points = static_cast<std::size_t>(num_points());
  std::vector<double> volumes;
  volumes.reserve(lane_of_cell_.size() * points);
  for (const Index lane_place : lane_of_cell_) {
    const auto block = static_cast<std::size_t>(lane_place / block_size);
    const auto lane = static_cast<std::size_t>(lane_place % block_size);
    for (std::size_t q = 0; q < points; ++q)
      volumes.push_back(tiles_.blocks.weights[(block * points + q) * block_size + lane]);
  }
  return volumes;
}

std::vector<double> ElasticEnergy::rest_volumes() const {
  const std::vector<double> of_points = point_volumes();
  std::vector<double> volumes(lane_of_cell_.size(), 0.0);
  for (std::size_t i = 0; i < of_points.size(); ++i)
    volumes[i / static_cast<std::size_t>(num_points())] += of_points[i];
  return volumes;
}

std::vector<double> ElasticEnergy::volume_ratios(const VectorX& x) const {
  const std::vector<double> u = tiles_.blocks.local_displacements(x);
  std::vector<double> ratios(static_cast<std::size_t>(num_cells() * num_points()));
  parallel_for(all_blocks_.size(), blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    for_volume_ratios(tiles_, std::span(all_blocks_).subspan(begin, end - begin), u.data(),
                      [&](std::size_t cell, std::size_t point, double J) { ratios[place(cell, point)] = J; });
  });
  if (is_plane_stress(law())) {  // those of the area, until the thickness is known
    const std::vector<Matrix<3>> gradients = deformation_gradients(x);
    for (std::size_t i = 0; i < ratios.size(); ++i)
      if (!std::isnan(gradients[i](2, 2))) ratios[i] *= gradients[i](2, 2);
  }
  return ratios;
}

std::vector<ElasticEnergy::VolumeChange> ElasticEnergy::mean_volume_changes(const VectorX& x) const {
  const ElementBlocks& blocks = tiles_.blocks;
  if (!tiles_.has_mean_volume()) return {};
  std::vector<VolumeChange> changes(static_cast<std::size_t>(num_cells() * num_points()), {0, 0});
  const std::vector<double> u = blocks.local_displacements(x);
  parallel_for(blocks.num_blocks, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    ElasticTiles::Scratch scratch(tiles_);
    for_tiles(tiles_, all_blocks_.data() + begin, end - begin, [&](const ElasticTiles::Tile& tile) {
      tiles_.volume_energies(tile, u.data(), scratch);
      for (std::size_t i = 0; i < tiles_.num_entries(tile) * block_size; ++i) {
        const std::size_t entry = i / block_size, lane = i % block_size, in_tile = entry / blocks.num_points;
        const Index cell = blocks.cells[static_cast<std::size_t>(tile.blocks[in_tile]) * block_size + lane];
        if (cell < 0) continue;
        const double* own = scratch.volume + entry * 3 * block_size + lane;
        const double* mean = scratch.mean_volume + in_tile * 3 * block_size + lane;
        changes[place(static_cast<std::size_t>(cell), entry % blocks.num_points)] = {
            mean[0] - own[0], mean[block_size] - own[block_size]};
      }
    });
  });
  return changes;
}

std::vector<double> ElasticEnergy::energy_densities(const VectorX& x) const {
  // In plane strain H has a third row and column of zeros, in plane stress the change of thickness, so that
  // the three-dimensional law serves all.
  const bool is_uniform = tiles_.constant_stride == 0 && tiles_.directions.empty();
  const PointStates states(*this, is_uniform, [&](std::vector<RowMatrix>& H) {
    for_each_point(x, [&](std::size_t cell, std::size_t point, const Matrix<3>& h, double) {
      H[place(cell, point)] = h;
    });
  });
  std::vector<double> densities(states.count());
  resilin::energy_densities(states.batch(), densities.data());
  const std::vector<VolumeChange> changes = mean_volume_changes(x);
  for (std::size_t i = 0; i < changes.size(); ++i) densities[i] += changes[i].energy;
  return densities;
}

std::vector<Matrix<3>> ElasticEnergy::cauchy_stresses(const VectorX& x) const {
  const bool is_uniform = tiles_.constant_stride == 0 && tiles_.directions.empty();
  const PointStates states(*this, is_uniform, [&](std::vector<RowMatrix>& H) {
    for_each_point(x, [&](std::size_t cell, std::size_t point, const Matrix<3>& h, double) {
      H[place(cell, point)] = h;
    });
  });
  std::vector<RowMatrix> P(states.count());
  if (!P.empty()) first_piola_kirchhoff_stresses(states.batch(), P.front().data());
  const std::vector<VolumeChange> changes = mean_volume_changes(x);
  std::vector<Matrix<3>> stresses(P.size());
  const bool is_small = law().kind == LawKind::small_strain;
  parallel_for(P.size(), points_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Matrix<3> F = Matrix<3>::Identity() + states.gradients()[i];
      stresses[i] =
          changes.empty() ? Matrix<3>::Zero() : Matrix<3>(changes[i].pressure * Matrix<3>::Identity());
      if (is_small)
        stresses[i] += P[i];
      else
        stresses[i] += P[i] * F.transpose() / F.determinant();
    }
  });
  return stresses;
}

std::vector<double> ElasticEnergy::von_mises_stresses(const VectorX& x) const {
  std::vector<double> values;
  for (const Matrix<3>& stress : cauchy_stresses(x)) values.push_back(von_mises(stress));
  return values;
}

std::vector<Matrix<3>> ElasticEnergy::deformation_gradients(const VectorX& x) const {
  std::vector<Matrix<3>> gradients(static_cast<std::size_t>(num_cells() * num_points()));
  if (is_plane_stress(law())) {
    const bool is_uniform = tiles_.constant_stride == 0 && tiles_.directions.empty();
    const PointStates states(*this, is_uniform, [&](std::vector<RowMatrix>& H) {
      for_each_point(x, [&](std::size_t cell, std::size_t point, const Matrix<3>& h, double) {
        H[place(cell, point)] = h;
      });
    });
    for (std::size_t i = 0; i < gradients.size(); ++i)
      gradients[i] = Matrix<3>::Identity() + states.gradients()[i];
    return gradients;
  }
  for_each_point(x, [&](std::size_t cell, std::size_t point, const Matrix<3>& H, double) {
    gradients[place(cell, point)] = Matrix<3>::Identity() + H;
  });
  return gradients;
}

Index ElasticEnergy::worst_cell(const VectorX& residual) const {
  double largest = -1;
  Index worst = -1;
  for (std::size_t cell = 0; cell < lane_of_cell_.size(); ++cell) {
    double sum = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(tiles_.blocks.num_nodes); ++a) {
      const Index node = world_node(cell, a);
      sum += residual.segment(Eigen::Index{tiles_.blocks.dim} * node, tiles_.blocks.dim).norm();
    }
    if (sum > largest) {
      largest = sum;
      worst = static_cast<Index>(cell);
    }
  }
  return worst;
}

}  // namespace resilin
