#include "resilin/mesh/surface_lattice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/bcc_grid.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/solid_surface.hpp"
#include "resilin/mesh/surface_places.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr double near_enough = 0.1;  // tolerance relative to the wanted number: no further attempt
constexpr int most_attempts = 8;
constexpr std::size_t tests_per_chunk = 256;
constexpr double tetrahedra_per_cube = 12;
constexpr double layer = 0.9;  // spacings that cells stand out of a surface, as a mean: a first guess

class LatticeMaker {
 public:
  LatticeMaker(const Mesh& surface, const std::string& name)
      : name_(name),
        surface_(make_solid_surface(surface, name)),
        box_(bounding_box(surface_.mesh)),
        places_(surface_) {}

  SurfaceLattice make(int wanted) const {
    require_volume(surface_, name_);
    double spacing = first_spacing(wanted), best_spacing = 0, best_miss = 0;
    double too_small = 0, too_large = std::numeric_limits<double>::infinity();
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
      const double count = count_cells(fill(spacing));
      const double miss = std::abs(std::log(count / wanted));
      if (attempt == 0 || miss < best_miss) {
        best_spacing = spacing;
        best_miss = miss;
      }
      if (miss < near_enough) break;
      (count > wanted ? too_small : too_large) = spacing;
      spacing *= std::pow(count / wanted, 0.4);  // between that of a sheet, 1/2, and of a solid, 1/3
      if (spacing <= too_small || spacing >= too_large) spacing = std::sqrt(too_small * too_large);
    }
    return finish(fill(best_spacing), best_spacing);
  }

 private:
  /// From wanted = 12 (V + layer spacing A) / spacing^3, by bisection.
  double first_spacing(int wanted) const {
    const double extent = (box_.max - box_.min).norm();
    double low = 0, high = 4 * extent;
    for (int i = 0; i < 60; ++i) {
      const double spacing = 0.5 * (low + high);
      const double count = tetrahedra_per_cube * (surface_.volume + layer * spacing * surface_.area) /
                           (spacing * spacing * spacing);
      (count > wanted ? low : high) = spacing;
    }
    return 0.5 * (low + high);
  }

  static double count_cells(const BccGrid& grid) {
    std::size_t count = 0;
    for (std::size_t t = 0; t < grid.num_tetrahedra(); ++t)
      count += static_cast<std::size_t>(grid.is_chosen(t));
    return static_cast<double>(count);
  }

  BccGrid fill(double spacing) const {
    if (BccGrid::count_cubes(box_.min, box_.max, spacing) > BccGrid::most_cubes)
      throw InputError(
          name_, "a surface that a lattice of " + std::to_string(BccGrid::most_cubes) + " cubes can resolve",
          "one that is too thin for its extent, or too many cells", "ask for fewer cells");
    BccGrid grid(box_.min, box_.max, spacing);
    const CellBlock& triangles = surface_.triangles();
    const auto X = [&](Index v) -> const Vector3& {
      return surface_.mesh.vertices[static_cast<std::size_t>(v)];
    };
    for (Index t = 0; t < triangles.num_cells(); ++t) {
      const auto nodes = triangles.cell(t);
      grid.choose_met_by({X(nodes[0]), X(nodes[1]), X(nodes[2])});
    }
    // Each cell is written by one chunk alone.
    parallel_for(grid.num_tetrahedra(), tests_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t)
        if (!grid.is_chosen(t) && is_inside(grid.middle(t))) grid.choose(t);
    });
    return grid;
  }

  bool is_inside(const Vector3& X) const {
    const bool is_in_box = (X.array() > box_.min.array()).all() && (X.array() < box_.max.array()).all();
    return is_in_box && places_.is_inside(X);
  }

  SurfaceLattice finish(BccGrid grid, double spacing) const {
    SurfaceLattice lattice;
    lattice.mesh = without_pinches(grid);
    lattice.spacing = spacing;
    const double num_cells = lattice.mesh.blocks[0].num_cells();
    const double cell_volume = spacing * spacing * spacing / tetrahedra_per_cube;
    if (places_.volume() > 0) lattice.volume_ratio = num_cells * cell_volume / places_.volume();
    lattice.remarks = remarks_on(surface_, name_);
    return lattice;
  }

  /// Adds the cells around vertices and edges by which alone cells hang together until there are none.
  static Mesh without_pinches(BccGrid& grid) {
    while (true) {
      BccGrid::Chosen chosen = grid.chosen();
      const Pinches pinches =
          find_pinches(chosen.mesh.blocks[0], static_cast<Index>(chosen.mesh.vertices.size()));
      if (pinches.vertices.empty() && pinches.edges.empty()) return std::move(chosen.mesh);
      const auto node = [&](Index v) { return chosen.nodes[static_cast<std::size_t>(v)]; };
      Index num_new = 0;
      for (const Index v : pinches.vertices) {
        const std::array<BccGrid::Node, 1> around = {node(v)};
        num_new += grid.choose_around(around);
      }
      for (const auto& [a, b] : pinches.edges) {
        const std::array<BccGrid::Node, 2> around = {node(a), node(b)};
        num_new += grid.choose_around(around);
      }
      if (num_new == 0) return std::move(chosen.mesh);  // at the rim of the lattice
    }
  }

  const std::string& name_;
  SolidSurface surface_;
  BoundingBox box_;
  SurfacePlaces places_;
};

}  // namespace

SurfaceLattice make_surface_lattice(const Mesh& surface, const std::string& name,
                                    const LatticeOptions& options) {
  if (options.cells < 1 || options.cells > LatticeOptions::most_cells)
    throw InputError(name, "a number of cells from 1 to " + std::to_string(LatticeOptions::most_cells),
                     std::to_string(options.cells));
  return LatticeMaker(surface, name).make(options.cells);
}

}  // namespace resilin
