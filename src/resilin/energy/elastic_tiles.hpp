#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "resilin/energy/kernels/element_blocks.hpp"
#include "resilin/energy/kernels/quadrature_kernels.hpp"
#include "resilin/energy/softening.hpp"
#include "resilin/material/kernels/law_kernels.hpp"
#include "resilin/material/kernels/point_kernels.hpp"
#include "resilin/material/law.hpp"

namespace resilin {

inline constexpr std::size_t blocks_per_chunk =
    256;  ///< blocks per chunk of a parallel loop over an elastic body

/// The arithmetic of an elastic body, one tile of cells at a time. Linear simplices have kernels in which
/// shape and law are one (element_kernels.hpp); all other elements go through the states at their quadrature
/// points. For ElasticEnergy, which cuts the loops and owns the data.
class ElasticTiles {
 public:
  /// Working memory of one tile. A tile is so small that it stays in the nearest caches.
  class Scratch;
  /// Some blocks of cells.
  struct Tile {
    const Index* blocks;
    std::size_t num_blocks;
  };

  /// Whether gradients of the shape functions of linear simplices are held, or made anew for each tile: a
  /// third of what such a cell takes, for some nanoseconds each time.
  enum class Gradients { held, held_by_small_bodies };

  ElasticTiles(ElementBlocks blocks, const LawInfo& law, bool has_mean_volume, InstructionSet set,
               Gradients gradients);

  std::size_t blocks_per_tile() const {
    return std::max<std::size_t>(1, entries_per_tile / blocks.num_points);
  }
  std::size_t num_entries(const Tile& tile) const { return tile.num_blocks * blocks.num_points; }
  bool has_mean_volume() const { return has_mean_volume_; }

  /// For kernels of other terms; that of linear simplices has their one point and no reference gradients.
  QuadratureTile quadrature_tile(const Tile& tile) const;

  /// H by rows, [entry][dim * dim][lane], into scratch.H.
  void gradients(const Tile& tile, const double* u, Scratch& scratch, double* H) const;
  /// J of each entry along H + t G: [entry][4][lane].
  void volume_cubics(const Tile& tile, const double* H, const double* G, double* cubics) const;

  /// Psi by entry; with a mean volume its share of the cell's energy.
  void energies(const Tile& tile, const double* u, Scratch& scratch, double* psi) const;
  /// Scale of the rounding of Psi, by entry: |Psi|, and the summands of the law's variables times the
  /// slopes of Psi by them. A body that has turned has invariants near zero which are sums of numbers that
  /// are not.
  void magnitudes(const Tile& tile, const double* u, Scratch& scratch, double* psi) const;
  void add_energies(const Tile& tile, const double* psi, const double* psi_from, EnergySum& sum) const;
  void add_forces(const Tile& tile, const double* u, bool is_magnitude, const OwnedNodes& owned,
                  Scratch& scratch, double* forces) const;

  /// Element Hessians into scratch.K; `pressures`, [block][lane] of all blocks, stands in for dU/dJ where it
  /// is not null (elements with a mean volume).
  void hessians(const Tile& tile, const double* u, Projection projection, const double* pressures,
                Scratch& scratch) const;
  void scatter(const Tile& tile, const MatrixPlaces& places, const OwnedNodes& owned, Scratch& scratch,
               double* values) const;
  /// Calls what `hessians` and `scatter` of this tile will touch into the cache.
  void prefetch(const Tile& tile, const double* u, const MatrixPlaces& places, const double* values) const;

  /// The volume energy and its two derivatives by J, [entry][3][lane] at the points into scratch.volume and
  /// [tile block][3][lane] at the cells' means into scratch.mean_volume.
  void volume_energies(const Tile& tile, const double* u, Scratch& scratch) const;

  /// dU/dJ of the mean volume, one row of lanes for each tile block; as `step` along `v` would change it to
  /// first order when `v` is not null.
  void mean_pressures(const Tile& tile, const double* u, const double* v, double step, Scratch& scratch,
                      double* pressures) const;

  // For derivatives by the law's constants and by the shape of the cells, of all elements alike: by rows,
  // [entry][dim * dim][lane].
  /// dP/dp into scratch.stress, p being the constant of this place.
  void constant_stresses(const Tile& tile, const double* u, std::size_t p, Scratch& scratch) const;
  /// dPsi/dp by entry, likewise; with a mean volume its share of the slope of the cell's energy.
  void constant_energies(const Tile& tile, const double* u, std::size_t p, Scratch& scratch,
                         double* psi) const;
  /// P into scratch.stress and dP/dF, [entry][dim^4][lane], into scratch.tangent; with a mean volume its
  /// pressure is held. Then the means of J - 1 are in scratch.mean_j and the second derivatives of the
  /// volume energy there in scratch.mean, one row of lanes for each tile block.
  void stresses_and_tangents(const Tile& tile, const double* u, Scratch& scratch) const;

  ElementBlocks blocks;
  const LawInfo* law;
  std::vector<double> constants;    ///< rows of lanes: one set, or one for each block
  std::size_t constant_stride = 0;  ///< numbers from block to block in `constants`; 0 when there is one set
  /// Mullins softening of the isochoric energy, in energies, forces and Hessians. Not of a sum.
  struct Softened {
    Softening law;
    std::vector<double> constants;  ///< as those of the law, without its volume energy
    std::vector<double> most;       ///< largest isochoric energy, [block][point][lane]
  };
  std::shared_ptr<const Softened> softened;  ///< null: none
  /// Directions of the fibres of one part of the law after another that has some:
  /// [part][block][fibre_rows][lane]; empty without. Zero where there is no such family.
  std::vector<double> directions;
  std::vector<std::uint8_t> transposed_lanes;  ///< see QuadratureTile; set once the pattern is known

 private:
  static constexpr std::size_t entries_per_tile = 8;

  /// A summand of the law; a law that is no sum has one.
  struct Part {
    const LawInfo* law;
    const LawKernels* kernels;
    std::size_t first_constant;  ///< its constants among those of the law
    std::size_t fibre_part;      ///< its place in `directions`

    LawForm form() const { return {law->kind, law->uses_second_invariant}; }
  };

  bool is_sum() const { return parts_.size() > 1; }
  const Part& part_of_constant(std::size_t p) const;
  const double* directions_of(const Part& part) const;
  ElementTile simplex_tile(const Tile& tile) const;
  /// With its gradients and the fibres of a part.
  ElementTile simplex_tile(const Tile& tile, const Part& part, Scratch& scratch) const;
  void hold_gradients();
  StateTile state_tile(const Tile& tile, const Part& part, Scratch& scratch) const;
  void measure(const Tile& tile, const Part& part, const double* u, bool keeps_frames,
               Scratch& scratch) const;
  LawBatch law_batch(const Tile& tile, const Part& part, const double* variables, bool is_per_entry,
                     Scratch& scratch, double* results) const;
  /// The isochoric energy W of each entry into scratch.isochoric_energy.
  void isochoric_energies(const Tile& tile, const Part& part, Scratch& scratch) const;
  const double* isochoric_constants(const Tile& tile, Scratch& scratch) const;
  double most_energy(const Tile& tile, std::size_t entry, std::size_t lane) const;
  void soften_energies(const Tile& tile, const Part& part, Scratch& scratch, double* psi) const;
  /// Softens the rows of the law's gradient or curvature.
  void soften_slopes(void (*kernel)(const LawBatch&), const Tile& tile, const Part& part,
                     Scratch& scratch) const;
  void call_law(void (*kernel)(const LawBatch&), const Tile& tile, const Part& part, const double* variables,
                bool is_per_entry, Scratch& scratch, double* results) const {
    kernel(law_batch(tile, part, variables, is_per_entry, scratch, results));
  }
  void energies_of(const Part& part, const Tile& tile, const double* u, Scratch& scratch, double* psi) const;
  void magnitudes_of(const Part& part, const Tile& tile, const double* u, Scratch& scratch,
                     double* psi) const;
  void add_forces_of(const Part& part, const Tile& tile, const double* u, bool is_magnitude,
                     const OwnedNodes& owned, Scratch& scratch, double* forces) const;
  /// @param pressures  see `hessians`; those of all parts together, and the first one has them
  void hessians_of(const Part& part, const Tile& tile, const double* u, Projection projection,
                   const double* pressures, Scratch& scratch, double* K) const;
  void stresses_and_tangents_of(const Part& part, const Tile& tile, const double* u, Scratch& scratch,
                                double* stress, double* tangent) const;
  void volume_slopes(const Tile& tile, const Part& part, const double* j, bool is_per_entry, std::size_t p,
                     std::size_t derivative, Scratch& scratch, std::vector<double>& slopes) const;
  void call_volume(const Tile& tile, const Part& part, Scratch& scratch) const;
  void replace_pressure(const Tile& tile, const Part& part, bool has_curvature, Scratch& scratch) const;

  const ElementKernels* simplex_kernels_;
  const QuadratureKernels* quadrature_kernels_;
  const PointKernels* point_kernels_;
  std::vector<Part> parts_;
  bool has_mean_volume_;
};

/// Arrays of one tile: on the stack for the usual quadrature rules, on the heap for those of many points.
class ElasticTiles::Scratch {
 public:
  explicit Scratch(const ElasticTiles& tiles);

  double* shape_gradients;
  std::vector<Index> gradients_of;  ///< the blocks whose gradients these are
  double *H, *G, *variables, *frames, *law, *constants, *directions, *energy, *energy_from;
  double *stress, *tangent;
  double *j, *volume, *mean_j, *mean_volume, *mean;           ///< scratch of elements with a mean volume
  double *isochoric_energy, *isochoric;                       ///< scratch of softened bodies
  double *part_energy, *part_stress, *part_tangent, *part_K;  ///< addends: further parts of a sum
  double* K;

 private:
  static constexpr std::size_t inline_size = 24 * 1024;
  alignas(64) std::array<double, inline_size> inline_;
  std::vector<double> heap_;
};

/// Calls `body(tile)` for the blocks of a list, tile by tile.
template <class Body>
void for_tiles(const ElasticTiles& tiles, const Index* blocks, std::size_t count, const Body& body) {
  const std::size_t step = tiles.blocks_per_tile();
  for (std::size_t i = 0; i < count; i += step)
    body(ElasticTiles::Tile{blocks + i, std::min(step, count - i)});
}

}  // namespace resilin
