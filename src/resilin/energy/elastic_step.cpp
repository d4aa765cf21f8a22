// How far an elastic body may go along a step.
#include <algorithm>
#include <array>
#include <span>

#include "resilin/core/parallel.hpp"
#include "resilin/core/simd.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/element/jacobian_bound.hpp"
#include "resilin/energy/elastic.hpp"
#include "resilin/energy/inversion_bound.hpp"

namespace resilin {
namespace {

/// The least of the lengths of steps.
struct StepBound {
  double step = 1;
  StepBound& operator+=(const StepBound& other) {
    step = std::min(step, other.step);
    return *this;
  }
};

/// Shortens the step to what the points of a tile may go from u along v, by local node.
void bound_by(const ElasticTiles& tiles, const ElasticTiles::Tile& tile, const double* u, const double* v,
              ElasticTiles::Scratch& scratch, StepBound& bound) {
  tiles.gradients(tile, v, scratch, scratch.G);
  tiles.gradients(tile, u, scratch, scratch.H);
  tiles.volume_cubics(tile, scratch.H, scratch.G, scratch.law);
  for (std::size_t i = 0; i < tiles.num_entries(tile) * block_size; ++i) {
    const double* c = scratch.law + i / block_size * 4 * block_size + i % block_size;
    bound.step = inversion_free_step({c[0], c[block_size], c[2 * block_size], c[3 * block_size]}, bound.step);
  }
}

/// How far every quadrature point may go along p: see max_step.
double inversion_free_length(const ElasticTiles& tiles, std::span<const Index> blocks, const VectorX& x,
                             const VectorX& p) {
  const std::vector<double> u = tiles.blocks.local_displacements(x), v = tiles.blocks.local_values(p);
  return parallel_sum<StepBound>(blocks.size(), blocks_per_chunk,
                                 [&](std::size_t begin, std::size_t end) {
                                   StepBound bound;
                                   ElasticTiles::Scratch scratch(tiles);
                                   for_tiles(tiles, blocks.data() + begin, end - begin,
                                             [&](const ElasticTiles::Tile& tile) {
                                               bound_by(tiles, tile, u.data(), v.data(), scratch, bound);
                                             });
                                   return bound;
                                 })
      .step;
}

}  // namespace

double ElasticEnergy::max_step(const VectorX& x, const VectorX& p, const Conditions&) const {
  if (!law().needs_positive_J) return 1;
  double step = inversion_free_length(tiles_, all_blocks_, x, p);
  if (!(min_volume_ratio(x).ratio > 0)) return step;
  while (step > 0 && !(min_volume_ratio(x + step * p).ratio > 0)) step *= 0.9;
  while (step > 1e-12 && turns_a_cell_inside_out(x, x + step * p)) step *= 0.7;
  return step;
}

/// Whether a cell that is the right way round everywhere at `from` is not so somewhere at `to`. Linear
/// simplices have one volume ratio, and nothing is left to find.
bool ElasticEnergy::turns_a_cell_inside_out(const VectorX& from, const VectorX& to) const {
  if (tiles_.blocks.is_linear_simplex() || !bounds_everywhere_) return false;
  struct Found {
    bool some = false;
    Found& operator+=(const Found& other) {
      some = some || other.some;
      return *this;
    }
  };
  constexpr std::size_t cells_per_chunk = 64;
  const auto dim = static_cast<std::size_t>(element_->dim), n = static_cast<std::size_t>(element_->num_nodes);
  const auto is_right = [&](std::size_t cell, const VectorX& x) {
    std::array<double, 3 * max_element_nodes> positions{};
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t i = 0; i < dim; ++i)
        positions[a * dim + i] =
            x[static_cast<Eigen::Index>(static_cast<std::size_t>(world_node(cell, a)) * dim + i)];
    return jacobian_sign(*element_, std::span(positions).first(n * dim)).kind == JacobianSign::Kind::positive;
  };
  return parallel_sum<Found>(lane_of_cell_.size(), cells_per_chunk,
                             [&](std::size_t begin, std::size_t end) {
                               Found found;
                               for (std::size_t cell = begin; cell < end && !found.some; ++cell)
                                 found.some = !is_right(cell, to) && is_right(cell, from);
                               return found;
                             })
      .some;
}

}  // namespace resilin
