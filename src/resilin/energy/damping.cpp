#include "resilin/energy/damping.hpp"

#include <algorithm>
#include <array>

#include "resilin/core/parallel.hpp"
#include "resilin/core/simd.hpp"

namespace resilin {

double MassDamping::dissipation(const VectorX& from, const VectorX& to, double duration) const {
  VectorX force;
  damping_->multiply(to - from, force);
  return force.dot(to - from) / duration;
}

ViscousDamping::ViscousDamping(std::shared_ptr<const ElasticEnergy> body,
                               std::span<const Viscosity> viscosities)
    : body_(std::move(body)),
      kernels_(viscous_kernels(body_->element().dim, body_->element().num_nodes, body_->instruction_set())) {
  const ElementBlocks& blocks = body_->tiles().blocks;
  const bool is_uniform = viscosities.size() == 1;
  stride_ = is_uniform ? 0 : viscosity_rows * block_size;
  const std::size_t count = is_uniform ? 1 : blocks.num_blocks;
  rows_.resize(count * viscosity_rows * block_size);
  for (std::size_t block = 0; block < count; ++block)
    for (std::size_t lane = 0; lane < block_size; ++lane) {
      const Index cell = is_uniform ? 0 : std::max(blocks.cells[block * block_size + lane], Index{0});
      const Viscosity& viscosity = viscosities[static_cast<std::size_t>(cell)];
      double* rows = rows_.data() + block * (viscosity_rows * block_size) + lane;
      rows[0] = viscosity.eta;
      rows[block_size] = viscosity.zeta;
    }
}

void ViscousDamping::add_forces(const std::vector<double>& shape, const VectorX& v, bool is_magnitude,
                                VectorX& forces) const {
  const ElasticTiles& tiles = body_->tiles();
  const std::vector<double> velocities = tiles.blocks.local_values(v);
  body_->add_by_owner(
      [&](const ElasticTiles::Tile& tile, const OwnedNodes& owned, ElasticTiles::Scratch&, double* local) {
        kernels_.add_forces(tiles.quadrature_tile(tile), {rows_.data(), stride_}, shape.data(),
                            velocities.data(), is_magnitude, owned, local);
      },
      forces);
}

void ViscousDamping::add_cell_matrices(const std::vector<double>& shape, double factor,
                                       const ElasticTiles::Tile& tile, double* K) const {
  kernels_.add_matrices(body_->tiles().quadrature_tile(tile), {rows_.data(), stride_}, shape.data(), factor,
                        K);
}

void ViscousDamping::add_matrix(const std::vector<double>& shape, double factor, BlockMatrix& matrix) const {
  const ElementBlocks& blocks = body_->tiles().blocks;
  const auto size = static_cast<std::size_t>(blocks.num_pairs() * blocks.dim * blocks.dim * block_size);
  body_->add_blocks_by_owner(
      shape.data(),
      [&](const ElasticTiles::Tile& tile, ElasticTiles::Scratch& scratch) {
        std::fill_n(scratch.K, tile.num_blocks * size, 0.0);
        add_cell_matrices(shape, factor, tile, scratch.K);
      },
      matrix);
}

// At even speed v, with D in the middle of the way: duration v^T D v. For the slopes of a scheme of second
// order that is the work of its damping forces to that order; of the midpoint rule and of backward Euler the
// work itself where D is constant.
double ViscousDamping::dissipation(const VectorX& from, const VectorX& to, double duration) const {
  VectorX force = VectorX::Zero(to.size());
  add_forces(body_->tiles().blocks.local_displacements(0.5 * (from + to)), to - from, false, force);
  return force.dot(to - from) / duration;
}

namespace {

/// The forces D (x - x_0) / c are linear in x, and all that is asked about x follows from them. They are kept
/// for the last two places, between which a search compares.
class StageDamping final : public BasicEnergy, public CellMatrices {
 public:
  StageDamping(const ViscousDamping& damping, std::vector<double> shape, const Stage& stage)
      : damping_(damping),
        shape_(std::move(shape)),
        base_positions_(stage.base_positions),
        duration_(stage.duration) {}

  std::string_view name() const override { return damping_.name(); }
  EnergyProperties properties() const override { return damping_.properties(); }
  double value(const VectorX& x, const Conditions&) const override {
    return 0.5 * forces_at(x).dot(x - base_positions_);
  }
  // E(b) - E(a) = (b - a) . (D (a - x_0) + D (b - x_0)) / (2 c)
  double difference(const VectorX& from, const VectorX& to, const Conditions&) const override {
    const VectorX& before = forces_at(from);  // stays for the next line, which takes the other place
    const VectorX& after = forces_at(to);
    return 0.5 * (before + after).dot(to - from);
  }
  void add_gradient(const VectorX& x, const Conditions&, VectorX& gradient) const override {
    gradient += forces_at(x);
  }
  void add_gradient_magnitude(const VectorX& x, const Conditions&, VectorX& magnitude) const override {
    damping_.add_forces(shape_, (x - base_positions_) / duration_, true, magnitude);
  }
  void add_hessian(const VectorX&, const Conditions&, Projection, BlockMatrix& hessian) const override {
    damping_.add_matrix(shape_, 1 / duration_, hessian);
  }
  /// Those of the damping, and where bodies would be that had stopped.
  std::vector<EnergyParameter> parameters() const override {
    std::vector<EnergyParameter> all = damping_.stage_parameters();
    all.push_back({"base_positions", base_positions_.size()});
    return all;
  }
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions&,
                            VectorX& slopes) const override {
    if (name == "base_positions") return damping_.add_forces(shape_, -w / duration_, false, slopes);
    damping_.add_slopes(name, shape_, (x - base_positions_) / duration_, w, slopes);
  }
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change, const Conditions&,
                            VectorX& gradient) const override {
    if (name == "base_positions") return damping_.add_forces(shape_, -change / duration_, false, gradient);
    damping_.add_change(name, shape_, (x - base_positions_) / duration_, change, gradient);
  }
  const CellMatrices* cell_matrices() const override { return this; }
  const ElasticEnergy& body() const override { return damping_.body(); }
  void add_to(const ElasticTiles::Tile& tile, double* K) const override {
    damping_.add_cell_matrices(shape_, 1 / duration_, tile, K);
  }

 private:
  struct Place {
    VectorX x, forces;
  };

  const VectorX& forces_at(const VectorX& x) const {
    for (const std::size_t i : {newest_, 1 - newest_})
      if (places_[i].x.size() == x.size() && places_[i].x == x) {
        newest_ = i;
        return places_[i].forces;
      }
    newest_ = 1 - newest_;
    Place& place = places_[newest_];
    place.x = x;
    place.forces.setZero(x.size());
    if (x != base_positions_)  // where many a step starts
      damping_.add_forces(shape_, (x - base_positions_) / duration_, false, place.forces);
    return place.forces;
  }

  const ViscousDamping& damping_;
  std::vector<double> shape_;
  VectorX base_positions_;
  double duration_;
  mutable std::array<Place, 2> places_{};
  mutable std::size_t newest_ = 0;
};

}  // namespace

std::unique_ptr<Energy> ViscousDamping::in_motion(const Stage& stage) const {
  return std::make_unique<StageDamping>(*this, body_->tiles().blocks.local_displacements(stage.shape), stage);
}

}  // namespace resilin
