#include "resilin/energy/elastic.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/simd.hpp"
#include "resilin/core/text.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/energy/kernels/node_counts.hpp"
#include "resilin/energy/tile_sum.hpp"
#include "resilin/material/law_sum.hpp"
#include "resilin/material/material_axes.hpp"

namespace resilin {
namespace {

template <class Element>
constexpr bool has_kernels() {
  constexpr bool is_plane =
      Element::shape == CellShape::triangle || Element::shape == CellShape::quadrilateral;
  constexpr int dim = is_plane ? 2 : 3;
  // The kernels of linear simplices know one point.
  if constexpr (Element::num_nodes == dim + 1) return Element::quadrature == "1-point";
  return is_counted(Element::num_nodes, typename NodeCounts<dim>::type{});
}
template <class... Element>
constexpr bool all_have_kernels(ElementList<Element...>) {
  return (has_kernels<Element>() && ...);
}
static_assert(
    all_have_kernels(Elements{}),
    "an element's number of nodes belongs into kernels/node_counts.hpp; linear simplices have one point");

ElementBlocks with_thickness(ElementBlocks blocks, double thickness) {
  for (double& weight : blocks.weights) weight *= thickness;
  return blocks;
}

}  // namespace

ElasticEnergy::ElasticEnergy(int dim, const ElementChoice& choice, std::span<const Index> cells,
                             const VectorX& rest_positions, const LawInfo& law,
                             std::span<const double> constants, const FibreDirections& fibres,
                             InstructionSet instruction_set, ElasticTiles::Gradients gradients,
                             double thickness)
    : element_(&require_element(choice.element, dim, "element")),
      rule_(&element_->quadrature(choice.quadrature, "quadrature")),
      instruction_set_(instruction_set),
      tiles_(with_thickness(make_element_blocks(*element_, *rule_, cells, rest_positions), thickness), law,
             element_->has_mean_volume, instruction_set, gradients),
      num_world_unknowns_(rest_positions.size()),
      thickness_(thickness),
      all_blocks_(tiles_.blocks.num_blocks) {
  if (element_->has_mean_volume && !law.has_volume_energy)
    throw InputError("element", "a law with a separate volumetric energy for " + std::string(element_->name),
                     std::string(law.name),
                     "choose " + std::string(element_->name.substr(0, 2)) + " or another law (docs/laws.md)");
  const ElementBlocks& blocks = tiles_.blocks;
  std::iota(all_blocks_.begin(), all_blocks_.end(), 0);
  lane_of_cell_.resize(static_cast<std::size_t>(blocks.num_cells));
  for (std::size_t i = 0; i < blocks.cells.size(); ++i)
    if (blocks.cells[i] >= 0)
      lane_of_cell_[static_cast<std::size_t>(blocks.cells[i])] = static_cast<Index>(i);
  set_constants(constants);
  set_directions(fibres);
  parts_ = std::make_shared<std::vector<OwnerPart>>(split_by_owner(blocks, num_threads()));
}

void ElasticEnergy::set_constants(std::span<const double> constants) {
  const ElementBlocks& blocks = tiles_.blocks;
  const std::size_t count = law().constants.size();
  const bool is_uniform = constants.size() == count;
  if (!is_uniform && constants.size() != count * static_cast<std::size_t>(blocks.num_cells))
    throw InputError("constants", std::to_string(count) + " numbers, once or for every cell",
                     std::to_string(constants.size()));
  tiles_.constant_stride = is_uniform ? 0 : count * block_size;
  tiles_.constants.resize(count * block_size * (is_uniform ? 1 : blocks.num_blocks));
  for (std::size_t i = 0; i < tiles_.constants.size(); ++i) {
    const std::size_t lane = i % block_size, k = i / block_size % count, block = i / (block_size * count);
    const Index cell = is_uniform ? 0 : std::max(blocks.cells[block * block_size + lane], Index{0});
    tiles_.constants[i] = constants[static_cast<std::size_t>(cell) * count + k];
  }
}

ElasticEnergy ElasticEnergy::with_scaled_constants(std::span<const double> factors) const {
  ElasticEnergy scaled = *this;
  for (std::size_t i = 0; i < scaled.tiles_.constants.size(); ++i)
    scaled.tiles_.constants[i] *= factors[i / block_size % factors.size()];
  return scaled;
}

ElasticEnergy ElasticEnergy::with_softening(const Softening& softening, std::span<const double> most,
                                            const ElasticEnergy& isochoric) const {
  const ElementBlocks& blocks = tiles_.blocks;
  const auto softened = std::make_shared<ElasticTiles::Softened>();
  softened->law = softening;
  softened->constants = isochoric.tiles_.constants;
  softened->most.assign(blocks.cells.size() * blocks.num_points, 0.0);
  for (std::size_t i = 0; i < blocks.cells.size(); ++i) {
    if (blocks.cells[i] < 0) continue;
    const std::size_t block = i / block_size, lane = i % block_size;
    for (std::size_t q = 0; q < blocks.num_points; ++q)
      softened->most[(block * blocks.num_points + q) * block_size + lane] =
          most[place(static_cast<std::size_t>(blocks.cells[i]), q)];
  }
  ElasticEnergy copy = *this;
  copy.tiles_.softened = softened;
  return copy;
}

void ElasticEnergy::set_directions(const FibreDirections& fibres) {
  const ElementBlocks& blocks = tiles_.blocks;
  const auto num_cells = static_cast<std::size_t>(blocks.num_cells);
  const std::size_t count = fibres.directions.size();
  num_families_ = fibres.num_families;
  const bool is_uniform = count == num_families_;
  if (law().max_fibres == 0) {
    if (count == 0 && num_families_ == 0) return;
    throw InputError("fibres", "none: " + std::string(law().name) + " is isotropic", std::to_string(count));
  }
  if (num_families_ == 0 || num_families_ > static_cast<std::size_t>(law().max_fibres) ||
      (!is_uniform && count != num_families_ * num_cells))
    throw InputError("fibres",
                     "1 to " + std::to_string(law().max_fibres) + " families, once or for every cell",
                     std::to_string(num_families_) + " families and " + std::to_string(count) +
                         " directions for " + std::to_string(num_cells) + " cells");
  const bool has_absent_ones = is_sum(law());
  for (const Vector3& fibre : fibres.directions)
    if (!(std::abs(fibre.norm() - 1) < 1e-9) && !(has_absent_ones && fibre.isZero(0)))
      throw InputError("fibres", "vectors of length 1", "one of length " + format_number(fibre.norm()));
  for (std::size_t first = 0; first < count; first += num_families_)
    if (has_parallel_axes(law(), std::span(fibres.directions).subspan(first, num_families_)))
      throw InputError("fibres", axes_expected, "parallel ones", axes_cure);
  const std::size_t part_size = blocks.num_blocks * fibre_rows * block_size;
  std::size_t first_of_part = 0;  // in the array of directions
  tiles_.directions.clear();
  for (const LawPart& part : parts_of(law())) {
    if (part.law->max_fibres == 0) continue;
    tiles_.directions.resize(first_of_part + part_size, 0.0);
    const std::size_t own = num_own_families(part, num_families_);
    for (std::size_t i = 0; i < blocks.cells.size(); ++i) {
      const auto cell = static_cast<std::size_t>(std::max(blocks.cells[i], Index{0}));
      for (std::size_t family = 0; family < own; ++family)
        for (std::size_t k = 0; k < 3; ++k)
          tiles_.directions[first_of_part + (i / block_size * fibre_rows + 3 * family + k) * block_size +
                            i % block_size] =
              fibres.directions[(is_uniform ? 0 : cell * num_families_) + part.first_family + family]
                               [static_cast<Eigen::Index>(k)];
    }
    first_of_part += part_size;
  }
}

double ElasticEnergy::energy_sum(const double* displacements, const double* displacements_from) const {
  return sum_of_tiles(tiles_, all_blocks_,
                      [&](const ElasticTiles::Tile& tile, ElasticTiles::Scratch& scratch, EnergySum& sum) {
                        tiles_.energies(tile, displacements, scratch, scratch.energy);
                        const double* from = nullptr;
                        if (displacements_from != nullptr) {
                          tiles_.energies(tile, displacements_from, scratch, scratch.energy_from);
                          from = scratch.energy_from;
                        }
                        tiles_.add_energies(tile, scratch.energy, from, sum);
                      });
}

double ElasticEnergy::value(const VectorX& x, const Conditions&) const {
  return energy_sum(tiles_.blocks.local_displacements(x).data(), nullptr);
}

double ElasticEnergy::difference(const VectorX& from, const VectorX& to, const Conditions&) const {
  return energy_sum(tiles_.blocks.local_displacements(to).data(),
                    tiles_.blocks.local_displacements(from).data());
}

double ElasticEnergy::magnitude(const VectorX& x, const Conditions&) const {
  const std::vector<double> u = tiles_.blocks.local_displacements(x);
  return sum_of_tiles(tiles_, all_blocks_,
                      [&](const ElasticTiles::Tile& tile, ElasticTiles::Scratch& scratch, EnergySum& sum) {
                        tiles_.magnitudes(tile, u.data(), scratch, scratch.energy);
                        tiles_.add_energies(tile, scratch.energy, nullptr, sum);
                      });
}

std::shared_ptr<const std::vector<OwnerPart>> ElasticEnergy::parts() const {
  if (parts_->size() == static_cast<std::size_t>(num_threads())) return parts_;
  return std::make_shared<std::vector<OwnerPart>>(split_by_owner(tiles_.blocks, num_threads()));
}

void ElasticEnergy::add_by_owner(const AddForces& add, VectorX& forces) const {
  const ElementBlocks& blocks = tiles_.blocks;
  std::vector<double> local(blocks.world_nodes.size() * blocks.stride(), 0.0);
  const auto shares = parts();
  parallel_tasks(shares->size(), [&](std::size_t p) {
    const OwnerPart& share = (*shares)[p];
    ElasticTiles::Scratch scratch(tiles_);
    for_tiles(tiles_, share.blocks.data(), share.blocks.size(),
              [&](const ElasticTiles::Tile& tile) { add(tile, share.owned, scratch, local.data()); });
    for (auto node = static_cast<std::size_t>(share.owned.begin);
         node < static_cast<std::size_t>(share.owned.end); ++node)
      for (int i = 0; i < blocks.dim; ++i)
        forces[Eigen::Index{blocks.dim} * blocks.world_nodes[node] + i] +=
            local[node * blocks.stride() + static_cast<std::size_t>(i)];
  });
}

void ElasticEnergy::add_forces(const VectorX& x, bool is_magnitude, VectorX& forces) const {
  const std::vector<double> u = tiles_.blocks.local_displacements(x);
  add_by_owner([&](const ElasticTiles::Tile& tile, const OwnedNodes& owned, ElasticTiles::Scratch& scratch,
                   double* local) { tiles_.add_forces(tile, u.data(), is_magnitude, owned, scratch, local); },
               forces);
}

void ElasticEnergy::add_gradient(const VectorX& x, const Conditions&, VectorX& gradient) const {
  add_forces(x, false, gradient);
}

void ElasticEnergy::add_gradient_magnitude(const VectorX& x, const Conditions&, VectorX& magnitude) const {
  add_forces(x, true, magnitude);
}

Index ElasticEnergy::world_node(std::size_t cell, std::size_t node) const {
  const ElementBlocks& blocks = tiles_.blocks;
  const auto lane = static_cast<std::size_t>(lane_of_cell_[cell]);
  const std::size_t first_node = lane / block_size * static_cast<std::size_t>(blocks.num_nodes);
  return blocks.world_nodes[static_cast<std::size_t>(
      blocks.nodes[(first_node + node) * block_size + lane % block_size])];
}

void ElasticEnergy::add_pattern(BlockPatternBuilder& builder) const {
  const auto n = static_cast<std::size_t>(tiles_.blocks.num_nodes);
  std::vector<Index> nodes;
  nodes.reserve(lane_of_cell_.size() * n);
  for (std::size_t cell = 0; cell < lane_of_cell_.size(); ++cell)
    for (std::size_t a = 0; a < n; ++a) nodes.push_back(world_node(cell, a));
  builder.add_cells(std::move(nodes), tiles_.blocks.num_nodes);
}

void ElasticEnergy::bind(const BlockPattern& pattern) {
  const std::vector<Index>& nodes = tiles_.blocks.world_nodes;
  row_begin_.resize(nodes.size());
  Offset longest = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto row = static_cast<std::size_t>(nodes[i]);
    row_begin_[i] = static_cast<std::uint32_t>(pattern.row_begin[row]);
    longest = std::max(longest, pattern.row_begin[row + 1] - pattern.row_begin[row]);
  }
  narrow_places_ = {};
  wide_places_ = {};
  if (longest <= std::numeric_limits<std::uint8_t>::max() + 1)
    find_places(pattern, narrow_places_);
  else
    find_places(pattern, wide_places_);
}

MatrixPlaces ElasticEnergy::places() const {
  const bool are_narrow = wide_places_.empty();
  return {.row_begin = row_begin_.data(),
          .narrow = are_narrow ? narrow_places_.data() : nullptr,
          .wide = are_narrow ? nullptr : wide_places_.data()};
}

template <class Place>
void ElasticEnergy::find_places(const BlockPattern& pattern, std::vector<Place>& places) {
  const ElementBlocks& blocks = tiles_.blocks;
  const auto n = static_cast<std::size_t>(blocks.num_nodes),
             pairs = static_cast<std::size_t>(blocks.num_pairs());
  places.resize(blocks.num_blocks * pairs * block_size);
  tiles_.transposed_lanes.assign(blocks.num_blocks * pairs, 0);
  parallel_for(blocks.num_blocks, blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block)
      for (std::size_t lane = 0; lane < block_size; ++lane) {
        const auto world = [&](std::size_t a) {
          return blocks
              .world_nodes[static_cast<std::size_t>(blocks.nodes[(block * n + a) * block_size + lane])];
        };
        for (std::size_t a = 0, pair = block * pairs; a < n; ++a)
          for (std::size_t b = a; b < n; ++b, ++pair) {
            const auto [row, column] = std::minmax({world(a), world(b)});
            places[pair * block_size + lane] = static_cast<Place>(
                pattern.slot(row, column) - pattern.row_begin[static_cast<std::size_t>(row)]);
            if (world(b) < world(a)) tiles_.transposed_lanes[pair] |= static_cast<std::uint8_t>(1U << lane);
          }
      }
  });
}

void ElasticEnergy::add_hessian(const VectorX& x, const Conditions&, Projection projection,
                                BlockMatrix& hessian) const {
  add_hessian_to(x, projection, nullptr, {}, hessian);
}

void ElasticEnergy::add_hessian_at(const VectorX& internal, const VectorX& x, const Conditions&,
                                   Projection projection, BlockMatrix& hessian,
                                   std::span<const CellMatrices* const> along) const {
  add_hessian_to(x, projection, internal.size() > 0 ? internal.data() : nullptr, along, hessian);
}

void ElasticEnergy::add_blocks_by_owner(const double* displacements, const FillBlocks& fill,
                                        BlockMatrix& matrix) const {
  const auto shares = parts();
  const MatrixPlaces at = places();
  parallel_tasks(shares->size(), [&](std::size_t p) {
    const OwnerPart& share = (*shares)[p];
    ElasticTiles::Scratch scratch(tiles_);
    for_tiles(tiles_, share.blocks.data(), share.blocks.size(), [&](const ElasticTiles::Tile& tile) {
      tiles_.prefetch(tile, displacements, at, matrix.values.data());
      fill(tile, scratch);
      tiles_.scatter(tile, at, share.owned, scratch, matrix.values.data());
    });
  });
}

void ElasticEnergy::add_hessian_to(const VectorX& x, Projection projection, const double* pressures,
                                   std::span<const CellMatrices* const> along, BlockMatrix& hessian) const {
  const std::vector<double> u = tiles_.blocks.local_displacements(x);
  add_blocks_by_owner(
      u.data(),
      [&](const ElasticTiles::Tile& tile, ElasticTiles::Scratch& scratch) {
        tiles_.hessians(tile, u.data(), projection, pressures, scratch);
        for (const CellMatrices* more : along) more->add_to(tile, scratch.K);
      },
      hessian);
}

void ElasticEnergy::evaluate_hessians(const VectorX& x, Projection projection) const {
  const std::vector<double> u = tiles_.blocks.local_displacements(x);
  parallel_for(all_blocks_.size(), blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    ElasticTiles::Scratch scratch(tiles_);
    for_tiles(tiles_, all_blocks_.data() + begin, end - begin, [&](const ElasticTiles::Tile& tile) {
      tiles_.hessians(tile, u.data(), projection, nullptr, scratch);
    });
  });
}

VectorX ElasticEnergy::mean_pressures(const VectorX& x, const VectorX* p, double t) const {
  if (!tiles_.has_mean_volume()) return {};
  const std::vector<double> u = tiles_.blocks.local_displacements(x);
  const std::vector<double> v = p == nullptr ? std::vector<double>() : tiles_.blocks.local_values(*p);
  VectorX pressures(static_cast<Eigen::Index>(all_blocks_.size() * block_size));
  parallel_for(all_blocks_.size(), blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
    ElasticTiles::Scratch scratch(tiles_);
    for_tiles(tiles_, all_blocks_.data() + begin, end - begin, [&](const ElasticTiles::Tile& tile) {
      tiles_.mean_pressures(tile, u.data(), p == nullptr ? nullptr : v.data(), t, scratch,
                            pressures.data() + Eigen::Index{tile.blocks[0]} * block_size);
    });
  });
  return pressures;
}

VectorX ElasticEnergy::internal_values(const VectorX& x) const { return mean_pressures(x, nullptr, 0); }

Eigen::Index ElasticEnergy::num_internal_values() const {
  return tiles_.has_mean_volume() ? static_cast<Eigen::Index>(all_blocks_.size()) * block_size : 0;
}

VectorX ElasticEnergy::predicted_internal_values(const VectorX& x, const VectorX& p, double t) const {
  return mean_pressures(x, &p, t);
}

}  // namespace resilin
