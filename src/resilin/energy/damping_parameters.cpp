// Derivatives of viscous forces by viscosities, by the shape at which they are formed and by the rest shape
// (docs/theory/gradients.md).
#include <algorithm>

#include "resilin/core/parallel.hpp"
#include "resilin/energy/damping.hpp"
#include "resilin/energy/lane_geometry.hpp"

namespace resilin {
namespace {

/// The viscosities of a block.
struct LaneViscosity {
  LaneRow eta, zeta;

  static LaneViscosity load(const double* rows) {
    return {Eigen::Map<const LaneRow>(rows), Eigen::Map<const LaneRow>(rows + block_size)};
  }
  /// S = eta (C + C^T) + zeta tr C I
  template <int dim>
  LaneMatrix<dim> stress(const LaneMatrix<dim>& C) const {
    return (eta * (C + C.transposed())).plus_identity(zeta * C.trace());
  }
};

}  // namespace

std::vector<EnergyParameter> ViscousDamping::stage_parameters() const {
  const Eigen::Index num_unknowns = body_->parameters().back().size;
  return {{"viscosities", stride_ == 0 ? Eigen::Index{2} : Eigen::Index{2} * body_->num_cells()},
          {"rest_positions", num_unknowns},
          {"shape", num_unknowns}};
}

/// With F of the shape and G, W those of v and w the power is sum_q V S(F^T G) : F^T W. Its slopes by both
/// viscosities are (C + C^T) : C_w and tr C tr C_w, C = F^T G and C_w = F^T W.
template <int dim>
void ViscousDamping::add_viscosity_slopes(const std::vector<double>& shape, const VectorX& v,
                                          const VectorX& w, VectorX& slopes) const {
  const ElementBlocks& blocks = body_->tiles().blocks;
  const std::vector<double> velocities = blocks.local_values(v), weights = blocks.local_values(w);
  std::vector<double> of_cells(2 * static_cast<std::size_t>(blocks.num_cells));
  parallel_for(blocks.num_blocks, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) {
      LaneRow by_eta = LaneRow::Zero(), by_zeta = LaneRow::Zero();
      for (std::size_t q = 0; q < blocks.num_points; ++q) {
        const LanePoint<dim> point(blocks, block, q);
        const LaneMatrix<dim> F_T = point.gradient(shape).plus_identity(LaneRow::Ones()).transposed();
        const LaneMatrix<dim> C = F_T * point.gradient(velocities), C_w = F_T * point.gradient(weights);
        by_eta += point.weight() * contracted(C + C.transposed(), C_w);
        by_zeta += point.weight() * C.trace() * C_w.trace();
      }
      for (std::size_t lane = 0; lane < block_size; ++lane) {
        const Index cell = blocks.cells[block * block_size + lane];
        if (cell < 0) continue;
        of_cells[2 * static_cast<std::size_t>(cell)] = by_eta[static_cast<Eigen::Index>(lane)];
        of_cells[2 * static_cast<std::size_t>(cell) + 1] = by_zeta[static_cast<Eigen::Index>(lane)];
      }
    }
  });
  for (std::size_t k = 0; k < of_cells.size(); ++k)
    slopes[static_cast<Eigen::Index>(stride_ == 0 ? k % 2 : k)] += of_cells[k];
}

/// Slopes of the same power by F, G and W are G S_w + W S, F S_w and F S.
template <int dim>
void ViscousDamping::add_slopes_of(std::string_view name, const std::vector<double>& shape, const VectorX& v,
                                   const VectorX& w, VectorX& slopes) const {
  const ElementBlocks& blocks = body_->tiles().blocks;
  const std::vector<double> velocities = blocks.local_values(v), weights = blocks.local_values(w);
  body_->add_by_owner(
      [&](const ElasticTiles::Tile& tile, const OwnedNodes& owned, ElasticTiles::Scratch&, double* local) {
        for (std::size_t i = 0; i < tile.num_blocks; ++i) {
          const auto block = static_cast<std::size_t>(tile.blocks[i]);
          const LaneViscosity viscosity = LaneViscosity::load(rows_.data() + block * stride_);
          for (std::size_t q = 0; q < blocks.num_points; ++q) {
            const LanePoint<dim> point(blocks, block, q);
            const LaneMatrix<dim> F = point.gradient(shape).plus_identity(LaneRow::Ones()),
                                  G = point.gradient(velocities), W = point.gradient(weights);
            const LaneMatrix<dim> S = viscosity.stress<dim>(F.transposed() * G),
                                  S_w = viscosity.stress<dim>(F.transposed() * W);
            const LaneMatrix<dim> by_F = G * S_w + W * S;
            if (name == "shape") {
              point.add(by_F, owned, local);
              continue;
            }
            const LaneMatrix<dim> P = F * S, P_w = F * S_w;
            const LaneMatrix<dim> sum = F.transposed() * by_F + G.transposed() * P_w + W.transposed() * P;
            point.add((LaneRow::Constant(-1) * sum).plus_identity(contracted(P, W)), owned, local);
          }
        }
      },
      slopes);
}

/// d(W F S g_a) of what changes.
template <int dim>
void ViscousDamping::add_forces_of(std::string_view name, const std::vector<double>& shape, const VectorX& v,
                                   const VectorX& change, VectorX& forces) const {
  const ElementBlocks& blocks = body_->tiles().blocks;
  const std::vector<double> velocities = blocks.local_values(v);
  const std::vector<double> changes =
      name == "viscosities" ? std::vector<double>() : blocks.local_values(change);
  body_->add_by_owner(
      [&](const ElasticTiles::Tile& tile, const OwnedNodes& owned, ElasticTiles::Scratch&, double* local) {
        for (std::size_t i = 0; i < tile.num_blocks; ++i) {
          const auto block = static_cast<std::size_t>(tile.blocks[i]);
          const LaneViscosity viscosity = LaneViscosity::load(rows_.data() + block * stride_);
          LaneViscosity of_change{LaneRow::Zero(), LaneRow::Zero()};
          for (std::size_t lane = 0; changes.empty() && lane < block_size; ++lane) {
            const Index cell = stride_ == 0 ? 0 : std::max(blocks.cells[block * block_size + lane], Index{0});
            of_change.eta[static_cast<Eigen::Index>(lane)] = change[Eigen::Index{2} * cell];
            of_change.zeta[static_cast<Eigen::Index>(lane)] = change[Eigen::Index{2} * cell + 1];
          }
          for (std::size_t q = 0; q < blocks.num_points; ++q) {
            const LanePoint<dim> point(blocks, block, q);
            const LaneMatrix<dim> F = point.gradient(shape).plus_identity(LaneRow::Ones()),
                                  G = point.gradient(velocities);
            const LaneMatrix<dim> C = F.transposed() * G;
            if (changes.empty()) {
              point.add(F * of_change.stress(C), owned, local);
              continue;
            }
            const LaneMatrix<dim> L = point.gradient(changes), S = viscosity.stress(C);
            if (name == "shape") {
              point.add(L * S + F * viscosity.stress(L.transposed() * G), owned, local);
              continue;
            }
            const LaneRow minus = LaneRow::Constant(-1);
            const LaneMatrix<dim> P = F * S, dF = minus * (F * L), dG = minus * (G * L);
            const LaneMatrix<dim> dC = dF.transposed() * G + F.transposed() * dG;
            point.add(L.trace() * P + dF * S + F * viscosity.stress(dC) - P * L.transposed(), owned, local);
          }
        }
      },
      forces);
}

void ViscousDamping::add_slopes(std::string_view name, const std::vector<double>& shape, const VectorX& v,
                                const VectorX& w, VectorX& slopes) const {
  const bool is_plane = body_->element().dim == 2;
  if (name == "viscosities")
    return is_plane ? add_viscosity_slopes<2>(shape, v, w, slopes)
                    : add_viscosity_slopes<3>(shape, v, w, slopes);
  is_plane ? add_slopes_of<2>(name, shape, v, w, slopes) : add_slopes_of<3>(name, shape, v, w, slopes);
}

void ViscousDamping::add_change(std::string_view name, const std::vector<double>& shape, const VectorX& v,
                                const VectorX& change, VectorX& forces) const {
  body_->element().dim == 2 ? add_forces_of<2>(name, shape, v, change, forces)
                            : add_forces_of<3>(name, shape, v, change, forces);
}

}  // namespace resilin
