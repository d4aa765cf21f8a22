#include "resilin/energy/elastic.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/simd.hpp"
#include "resilin/core/text.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/energy/elastic_tiles.hpp"
#include "resilin/energy/inversion_bound.hpp"
#include "resilin/material/law_kernels.hpp"
#include "resilin/material/point_kernels.hpp"

namespace resilin {
namespace {

/// Sum of the lanes and their compensations, in a fixed order.
struct LaneSum {
  EnergySum lanes;
  LaneSum& operator+=(const LaneSum& other) {
    for (std::size_t i = 0; i < block_size; ++i) {
      const double next = lanes.sum[i] + other.lanes.sum[i], shown = next - lanes.sum[i];
      lanes.rest[i] += (lanes.sum[i] - (next - shown)) + (other.lanes.sum[i] - shown) + other.lanes.rest[i];
      lanes.sum[i] = next;
    }
    lanes.is_outside = lanes.is_outside || other.lanes.is_outside;
    return *this;
  }
  double total() const {
    if (lanes.is_outside) return std::numeric_limits<double>::infinity();
    double sum = 0, rest = 0;
    for (std::size_t i = 0; i < block_size; ++i) {
      const double next = sum + lanes.sum[i], shown = next - sum;
      rest += (sum - (next - shown)) + (lanes.sum[i] - shown) + lanes.rest[i];
      sum = next;
    }
    return sum + rest;
  }
};

}  // namespace

ElasticEnergy::ElasticEnergy(int dim, const ElementChoice& choice, std::span<const Index> cells,
                             const VectorX& rest_positions, const LawInfo& law,
                             std::span<const double> constants, const FibreDirections& fibres,
                             InstructionSet instruction_set)
    : element_(&require_element(choice.element, dim, "element")),
      rule_(&element_->quadrature(choice.quadrature, "quadrature")),
      blocks_(make_element_blocks(*element_, *rule_, cells, rest_positions)),
      law_(&law),
      instruction_set_(instruction_set),
      kernels_(&element_kernels(dim, instruction_set)),
      law_kernels_(&resilin::law_kernels(law.index, instruction_set)),
      all_blocks_(blocks_.num_blocks),
      pattern_nodes_(cells.begin(), cells.end()) {
  std::iota(all_blocks_.begin(), all_blocks_.end(), 0);
  lane_of_cell_.resize(static_cast<std::size_t>(blocks_.num_cells));
  for (std::size_t i = 0; i < blocks_.cells.size(); ++i)
    if (blocks_.cells[i] >= 0)
      lane_of_cell_[static_cast<std::size_t>(blocks_.cells[i])] = static_cast<Index>(i);
  const std::size_t count = law.constants.size();
  const bool is_uniform = constants.size() == count;
  if (!is_uniform && constants.size() != count * static_cast<std::size_t>(blocks_.num_cells))
    throw InputError("constants", std::to_string(count) + " numbers, once or for every cell",
                     std::to_string(constants.size()));
  constant_stride_ = is_uniform ? 0 : count * block_size;
  constants_.resize(count * block_size * (is_uniform ? 1 : blocks_.num_blocks));
  for (std::size_t i = 0; i < constants_.size(); ++i) {
    const std::size_t lane = i % block_size, k = i / block_size % count, block = i / (block_size * count);
    const Index cell = is_uniform ? 0 : std::max(blocks_.cells[block * block_size + lane], Index{0});
    constants_[i] = constants[static_cast<std::size_t>(cell) * count + k];
  }
  set_directions(fibres);
  parts_ = std::make_shared<std::vector<OwnerPart>>(split_by_owner(blocks_, num_threads()));
}

void ElasticEnergy::set_directions(const FibreDirections& fibres) {
  const auto num_cells = static_cast<std::size_t>(blocks_.num_cells);
  const std::size_t count = fibres.directions.size();
  num_families_ = fibres.num_families;
  const bool is_uniform = count == num_families_;
  if (law_->max_fibres == 0) {
    if (count == 0 && num_families_ == 0) return;
    throw InputError("fibres", "none: " + std::string(law_->name) + " is isotropic", std::to_string(count));
  }
  if (num_families_ == 0 || num_families_ > static_cast<std::size_t>(law_->max_fibres) ||
      (!is_uniform && count != num_families_ * num_cells))
    throw InputError("fibres",
                     "1 to " + std::to_string(law_->max_fibres) + " families, once or for every cell",
                     std::to_string(num_families_) + " families and " + std::to_string(count) +
                         " directions for " + std::to_string(num_cells) + " cells");
  for (const Vector3& fibre : fibres.directions)
    if (!(std::abs(fibre.norm() - 1) < 1e-9))
      throw InputError("fibres", "vectors of length 1", "one of length " + format_number(fibre.norm()));
  directions_.assign(blocks_.num_blocks * fibre_rows * block_size, 0.0);
  for (std::size_t i = 0; i < blocks_.cells.size(); ++i) {
    const auto cell = static_cast<std::size_t>(std::max(blocks_.cells[i], Index{0}));
    for (std::size_t family = 0; family < num_families_; ++family)
      for (std::size_t k = 0; k < 3; ++k)
        directions_[(i / block_size * fibre_rows + 3 * family + k) * block_size + i % block_size] =
            fibres.directions[is_uniform ? family : cell * num_families_ + family]
                             [static_cast<Eigen::Index>(k)];
  }
}

ElementTile ElasticEnergy::tile(const Index* block_numbers, std::size_t count) const {
  return {block_numbers,
          count,
          blocks_.num_blocks,
          blocks_.nodes.data(),
          blocks_.gradients.data(),
          blocks_.weights.data(),
          directions_.empty() ? nullptr : directions_.data()};
}

HessianForm ElasticEnergy::form(Projection projection) const {
  return {law_form(), removed_part(projection)};
}

void ElasticEnergy::call_law(void (*kernel)(const LawBatch&), const ElementTile& tile, Scratch& scratch,
                             double* results) const {
  const double* constants = constants_.data();
  if (constant_stride_ != 0) {
    for (std::size_t i = 0; i < tile.num_blocks; ++i)
      std::copy_n(constants_.data() + static_cast<std::size_t>(tile.blocks[i]) * constant_stride_,
                  constant_stride_, scratch.constants.data() + i * constant_stride_);
    constants = scratch.constants.data();
  }
  kernel({tile.num_blocks, scratch.variables.data(), constants, constant_stride_, results});
}

double ElasticEnergy::energy_sum(const double* displacements, const double* displacements_from) const {
  return parallel_sum<LaneSum>(
             blocks_.num_blocks, blocks_per_chunk,
             [&](std::size_t begin, std::size_t end) {
               LaneSum sum;
               Scratch scratch;
               const auto evaluate = [&](const ElementTile& part, const double* u, double* energy) {
                 kernels_->measure(part, law_form(), u, scratch.H.data(), scratch.variables.data(), nullptr);
                 call_law(law_kernels_->energy, part, scratch, energy);
               };
               for_tiles(begin, end, [&](std::size_t first, std::size_t count) {
                 const ElementTile part = tile(first, count);
                 evaluate(part, displacements, scratch.energy.data());
                 const double* from = nullptr;
                 if (displacements_from != nullptr) {
                   evaluate(part, displacements_from, scratch.energy_from.data());
                   from = scratch.energy_from.data();
                 }
                 kernels_->add_energies(part, scratch.energy.data(), from, sum.lanes);
               });
               return sum;
             })
      .total();
}

double ElasticEnergy::value(const VectorX& x, const Conditions&) const {
  return energy_sum(blocks_.local_displacements(x).data(), nullptr);
}

double ElasticEnergy::difference(const VectorX& from, const VectorX& to, const Conditions&) const {
  return energy_sum(blocks_.local_displacements(to).data(), blocks_.local_displacements(from).data());
}

std::shared_ptr<const std::vector<OwnerPart>> ElasticEnergy::parts() const {
  if (parts_->size() == static_cast<std::size_t>(num_threads())) return parts_;
  return std::make_shared<std::vector<OwnerPart>>(split_by_owner(blocks_, num_threads()));
}

void ElasticEnergy::add_forces(const VectorX& x, bool is_magnitude, VectorX& forces) const {
  const std::vector<double> u = blocks_.local_displacements(x);
  std::vector<double> local(u.size(), 0.0);
  const auto shares = parts();
  parallel_tasks(shares->size(), [&](std::size_t p) {
    const OwnerPart& share = (*shares)[p];
    Scratch scratch;
    for_tiles(0, share.blocks.size(), [&](std::size_t first, std::size_t count) {
      const ElementTile part = tile(share.blocks.data() + first, count);
      kernels_->measure(part, law_form(), u.data(), scratch.H.data(), scratch.variables.data(),
                        scratch.frames.data());
      call_law(law_kernels_->gradient, part, scratch, scratch.law.data());
      kernels_->add_forces(part, law_form(), scratch.H.data(), scratch.frames.data(), scratch.law.data(),
                           is_magnitude, share.owned, local.data());
    });
    for (auto node = static_cast<std::size_t>(share.owned.begin);
         node < static_cast<std::size_t>(share.owned.end); ++node)
      for (int i = 0; i < blocks_.dim; ++i)
        forces[Eigen::Index{blocks_.dim} * blocks_.world_nodes[node] + i] +=
            local[node * blocks_.stride() + static_cast<std::size_t>(i)];
  });
}

void ElasticEnergy::add_gradient(const VectorX& x, const Conditions&, VectorX& gradient) const {
  add_forces(x, false, gradient);
}

void ElasticEnergy::add_gradient_magnitude(const VectorX& x, const Conditions&, VectorX& magnitude) const {
  add_forces(x, true, magnitude);
}

void ElasticEnergy::add_pattern(BlockPatternBuilder& builder) const {
  builder.add_cells(pattern_nodes_, blocks_.num_nodes);
}

void ElasticEnergy::bind(const BlockPattern& pattern) {
  if (pattern.num_slots() > static_cast<Offset>(std::numeric_limits<std::uint32_t>::max()))
    throw InputError("mesh", "at most 4294967295 coupled pairs of nodes",
                     std::to_string(pattern.num_slots()));
  const auto n = static_cast<std::size_t>(blocks_.num_nodes),
             pairs = static_cast<std::size_t>(blocks_.num_pairs());
  slots_.resize(blocks_.num_blocks * pairs * block_size);
  parallel_for(blocks_.num_blocks, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block)
      for (std::size_t lane = 0; lane < block_size; ++lane) {
        const auto world = [&](std::size_t a) {
          return blocks_
              .world_nodes[static_cast<std::size_t>(blocks_.nodes[(block * n + a) * block_size + lane])];
        };
        for (std::size_t a = 0, pair = 0; a < n; ++a)
          for (std::size_t b = a; b < n; ++b, ++pair)
            slots_[(block * pairs + pair) * block_size + lane] =
                static_cast<std::uint32_t>(pattern.slot(world(a), world(b)));
      }
  });
}

void ElasticEnergy::add_hessian(const VectorX& x, const Conditions&, Projection projection,
                                BlockMatrix& hessian) const {
  add_hessian_to(x, projection, {}, hessian);
}

Index ElasticEnergy::add_hessian_selective(const VectorX& x, const Conditions&, Projection projection,
                                           std::span<const std::uint8_t> project_node,
                                           BlockMatrix& hessian) const {
  const auto n = static_cast<std::size_t>(blocks_.num_nodes);
  std::vector<std::uint8_t> project_lane(blocks_.cells.size(), 0);
  Index count = 0;
  for (std::size_t i = 0; i < project_lane.size(); ++i) {
    if (blocks_.cells[i] < 0) continue;
    for (std::size_t a = 0; a < n; ++a) {
      const Index local = blocks_.nodes[(i / block_size * n + a) * block_size + i % block_size];
      const Index node = blocks_.world_nodes[static_cast<std::size_t>(local)];
      if (project_node[static_cast<std::size_t>(node)] != 0) project_lane[i] = 1;
    }
    count += project_lane[i];
  }
  add_hessian_to(x, projection, project_lane, hessian);
  return projection == Projection::none ? 0 : count;
}

void ElasticEnergy::add_hessian_to(const VectorX& x, Projection projection,
                                   const std::vector<std::uint8_t>& project_lane,
                                   BlockMatrix& hessian) const {
  const std::vector<double> u = blocks_.local_displacements(x);
  const std::size_t rows = static_cast<std::size_t>(blocks_.num_pairs() * blocks_.dim * blocks_.dim);
  const auto shares = parts();
  parallel_tasks(shares->size(), [&](std::size_t p) {
    const OwnerPart& share = (*shares)[p];
    Scratch scratch;
    for_tiles(0, share.blocks.size(), [&](std::size_t first, std::size_t count) {
      const ElementTile part = tile(share.blocks.data() + first, count);
      const auto is_chosen = [&](std::size_t i, std::size_t lane) {
        return project_lane[static_cast<std::size_t>(part.blocks[i]) * block_size + lane] != 0;
      };
      bool some = project_lane.empty(), all = true;
      for (std::size_t i = 0; i < count * block_size && !project_lane.empty(); ++i) {
        some = some || is_chosen(i / block_size, i % block_size);
        all = all && is_chosen(i / block_size, i % block_size);
      }
      kernels_->prefetch(part, u.data(), slots_.data(), hessian.values.data());
      kernels_->measure(part, law_form(), u.data(), scratch.H.data(), scratch.variables.data(),
                        scratch.frames.data());
      call_law(law_kernels_->curvature, part, scratch, scratch.law.data());
      kernels_->hessians(part, form(some ? projection : Projection::none), scratch.H.data(),
                         scratch.frames.data(), scratch.law.data(), scratch.K.data());
      if (some && !all) {
        kernels_->hessians(part, form(Projection::none), scratch.H.data(), scratch.frames.data(),
                           scratch.law.data(), scratch.exact_K.data());
        for (std::size_t i = 0; i < count * rows * block_size; ++i)
          if (!is_chosen(i / (rows * block_size), i % block_size)) scratch.K[i] = scratch.exact_K[i];
      }
      kernels_->scatter(part, scratch.K.data(), slots_.data(), share.owned, hessian.values.data());
    });
  });
}

void ElasticEnergy::evaluate_hessians(const VectorX& x, Projection projection) const {
  const std::vector<double> u = blocks_.local_displacements(x);
  parallel_for(blocks_.num_blocks, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    Scratch scratch;
    for_tiles(begin, end, [&](std::size_t first, std::size_t count) {
      const ElementTile part = tile(first, count);
      kernels_->measure(part, law_form(), u.data(), scratch.H.data(), scratch.variables.data(),
                        scratch.frames.data());
      call_law(law_kernels_->curvature, part, scratch, scratch.law.data());
      kernels_->hessians(part, form(projection), scratch.H.data(), scratch.frames.data(), scratch.law.data(),
                         scratch.K.data());
    });
  });
}

double ElasticEnergy::max_step(const VectorX& x, const VectorX& p) const {
  if (!law_->needs_positive_J) return 1;
  const std::vector<double> u = blocks_.local_displacements(x), v = blocks_.local_values(p);
  struct Bound {
    double step = 1;
    Bound& operator+=(const Bound& other) {
      step = std::min(step, other.step);
      return *this;
    }
  };
  constexpr LawForm any_law = {LawKind::invariants, false};  // H alone is wanted
  double step =
      parallel_sum<Bound>(blocks_.num_blocks, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
        Bound bound;
        Scratch scratch;
        for_tiles(begin, end, [&](std::size_t first, std::size_t count) {
          const ElementTile part = tile(first, count);
          kernels_->measure(part, any_law, v.data(), scratch.G.data(), scratch.variables.data(), nullptr);
          kernels_->measure(part, any_law, u.data(), scratch.H.data(), scratch.variables.data(), nullptr);
          kernels_->volume_cubics(count, scratch.H.data(), scratch.G.data(), scratch.law.data());
          for (std::size_t i = 0; i < count * block_size; ++i) {
            const double* c = scratch.law.data() + i / block_size * 4 * block_size + i % block_size;
            bound.step =
                inversion_free_step({c[0], c[block_size], c[2 * block_size], c[3 * block_size]}, bound.step);
          }
        });
        return bound;
      }).step;
  if (!(min_volume_ratio(x).ratio > 0)) return step;
  while (step > 0 && !(min_volume_ratio(x + step * p).ratio > 0)) step *= 0.9;
  return step;
}

}  // namespace resilin
