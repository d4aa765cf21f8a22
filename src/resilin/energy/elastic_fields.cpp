// What is read off an elastic body cell by cell.
#include <cmath>
#include <limits>
#include <numeric>

#include "resilin/core/parallel.hpp"
#include "resilin/energy/elastic.hpp"
#include "resilin/energy/elastic_tiles.hpp"

namespace resilin {

void ElasticEnergy::for_each_cell(
    const VectorX& x, const std::function<void(std::size_t cell, const Matrix<3>& H, double J)>& body) const {
  const std::vector<double> u = blocks_.local_displacements(x);
  const int dim = blocks_.dim;
  const auto entries = static_cast<std::size_t>(dim * dim);
  parallel_for(blocks_.num_blocks, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    Scratch scratch;
    for_tiles(begin, end, [&](std::size_t first, std::size_t count) {
      kernels_->measure(tile(first, count), LawForm{LawKind::invariants, false}, u.data(), scratch.H.data(),
                        scratch.variables.data(), nullptr);
      for (std::size_t i = 0; i < count * block_size; ++i) {
        const std::size_t block = i / block_size, lane = i % block_size;
        const Index cell = blocks_.cells[(first + block) * block_size + lane];
        if (cell < 0) continue;
        Matrix<3> H = Matrix<3>::Zero();
        for (std::size_t k = 0; k < entries; ++k)
          H(static_cast<int>(k) / dim, static_cast<int>(k) % dim) =
              scratch.H[(block * entries + k) * block_size + lane];
        body(static_cast<std::size_t>(cell), H, 1 + scratch.variables[(block * 3 + 2) * block_size + lane]);
      }
    });
  });
}

ElasticEnergy::VolumeRatio ElasticEnergy::min_volume_ratio(const VectorX& x) const {
  const std::vector<double> ratios = volume_ratios(x);
  VolumeRatio least{std::numeric_limits<double>::infinity(), -1};
  for (std::size_t cell = 0; cell < ratios.size(); ++cell) {
    if (std::isnan(ratios[cell])) return {ratios[cell], static_cast<Index>(cell)};
    if (ratios[cell] < least.ratio) least = {ratios[cell], static_cast<Index>(cell)};
  }
  return least;
}

double ElasticEnergy::total_rest_volume() const {
  return std::accumulate(blocks_.weights.begin(), blocks_.weights.end(), 0.0);
}

Material ElasticEnergy::material(Index cell) const {
  Material material{law_, std::vector<double>(law_->constants.size()), {}};
  const auto place = static_cast<std::size_t>(lane_of_cell_[static_cast<std::size_t>(cell)]);
  const std::size_t block = place / block_size, lane = place % block_size;
  const std::size_t at = constant_stride_ == 0 ? 0 : block * constant_stride_ + lane;
  for (std::size_t k = 0; k < material.constants.size(); ++k)
    material.constants[k] = constants_[at + k * block_size];
  for (std::size_t family = 0; family < num_families_; ++family) {
    const double* rows = directions_.data() + (block * fibre_rows + 3 * family) * block_size + lane;
    material.fibres.emplace_back(rows[0], rows[block_size], rows[2 * block_size]);
  }
  return material;
}

std::vector<double> ElasticEnergy::rest_volumes() const {
  std::vector<double> volumes;
  for (const Index lane : lane_of_cell_) volumes.push_back(blocks_.weights[static_cast<std::size_t>(lane)]);
  return volumes;
}

std::vector<double> ElasticEnergy::point_volumes() const { return rest_volumes(); }

std::vector<double> ElasticEnergy::volume_ratios(const VectorX& x) const {
  std::vector<double> ratios(static_cast<std::size_t>(num_cells()));
  for_each_cell(x, [&](std::size_t cell, const Matrix<3>&, double J) { ratios[cell] = J; });
  return ratios;
}

std::vector<double> ElasticEnergy::energy_densities(const VectorX& x) const {
  std::vector<double> densities(static_cast<std::size_t>(num_cells()));
  // In plane strain H has a third row and column of zeros, so that the three-dimensional law serves both.
  for_each_cell(x, [&](std::size_t cell, const Matrix<3>& H, double) {
    densities[cell] = from_displacement_gradient::energy_density<3>(material(static_cast<Index>(cell)), H);
  });
  return densities;
}

std::vector<Matrix<3>> ElasticEnergy::cauchy_stresses(const VectorX& x) const {
  std::vector<Matrix<3>> stresses(static_cast<std::size_t>(num_cells()));
  for_each_cell(x, [&](std::size_t cell, const Matrix<3>& H, double) {
    stresses[cell] = from_displacement_gradient::cauchy_stress<3>(material(static_cast<Index>(cell)), H);
  });
  return stresses;
}

std::vector<double> ElasticEnergy::von_mises_stresses(const VectorX& x) const {
  std::vector<double> values;
  for (const Matrix<3>& stress : cauchy_stresses(x)) values.push_back(von_mises(stress));
  return values;
}

std::vector<Matrix<3>> ElasticEnergy::deformation_gradients(const VectorX& x) const {
  std::vector<Matrix<3>> gradients(static_cast<std::size_t>(num_cells()));
  for_each_cell(
      x, [&](std::size_t cell, const Matrix<3>& H, double) { gradients[cell] = Matrix<3>::Identity() + H; });
  return gradients;
}

Index ElasticEnergy::worst_cell(const VectorX& residual) const {
  double largest = -1;
  Index worst = -1;
  for (std::size_t cell = 0; cell < lane_of_cell_.size(); ++cell) {
    double sum = 0;
    for (int a = 0; a < blocks_.num_nodes; ++a) {
      const Index node =
          pattern_nodes_[cell * static_cast<std::size_t>(blocks_.num_nodes) + static_cast<std::size_t>(a)];
      sum += residual.segment(Eigen::Index{blocks_.dim} * node, blocks_.dim).norm();
    }
    if (sum > largest) {
      largest = sum;
      worst = static_cast<Index>(cell);
    }
  }
  return worst;
}

}  // namespace resilin
