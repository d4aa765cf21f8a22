#include "resilin/world/region_cells.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/cell_kind.hpp"
#include "resilin/world/body_mesh.hpp"
#include "resilin/world/selection.hpp"

namespace resilin {
namespace {

void check_names(const std::vector<RegionDescription>& regions) {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const RegionDescription& region = regions[i];
    if (region.name.empty()) throw InputError(region.place + ".name", "a text that is not empty", "\"\"");
    for (std::size_t k = 0; k < i; ++k)
      if (regions[k].name == region.name)
        throw InputError(region.place + ".name", "a name of its own for each region of a body",
                         "\"" + region.name + "\" twice");
  }
}

/// The corners of the cells, placed.
class CellCorners {
 public:
  CellCorners(const BodyDescription& body, int dim) : cells_(solid_cells(body, dim)) {
    const Placement placement(body);
    for (const Vector3& vertex : body.mesh.vertices) {
      vertices_.push_back(placement(vertex));
      if (dim == 2) vertices_.back().z() = 0;
    }
  }
  Index count() const { return cells_.num_cells(); }
  std::span<const Index> corners(Index cell) const {
    return cells_.cell(cell).first(static_cast<std::size_t>(num_corners(cells_.kind)));
  }
  Vector3 centroid(Index cell) const {
    Vector3 sum = Vector3::Zero();
    for (const Index corner : corners(cell)) sum += vertices_[static_cast<std::size_t>(corner)];
    return sum / num_corners(cells_.kind);
  }
  /// The longest extent along the axes [m].
  double extent() const {
    Vector3 low = vertices_.front(), high = low;
    for (const Vector3& vertex : vertices_) {
      low = low.cwiseMin(vertex);
      high = high.cwiseMax(vertex);
    }
    return (high - low).maxCoeff();
  }

 private:
  const CellBlock& cells_;
  std::vector<Vector3> vertices_;
};

std::vector<Index> cells_of_group(const BodyDescription& body, int dim, const RegionDescription& region) {
  const std::string place = region.place + ".where";
  const Group& group = find_group(body.mesh, region.where.group, place);
  const auto block = static_cast<std::size_t>(&solid_cells(body, dim) - body.mesh.blocks.data());
  if (block >= group.cells.size() || group.cells[block].empty())
    throw InputError(place, "a group of the body's cells",
                     "\"" + group.name + "\", which has none of them, but " +
                         std::to_string(group.vertices.size()) + " vertices",
                     "name a group of cells, or select them by box or sphere");
  return group.cells[block];
}

/// The cells that a region means, whoever else does.
std::vector<Index> cells_of_region(const BodyDescription& body, int dim, const RegionDescription& region,
                                   const CellCorners& cells) {
  if (region.cells) {
    for (const Index cell : *region.cells)
      if (cell < 0 || cell >= cells.count())
        throw InputError(region.place + ".cells",
                         "cell numbers from 0 to " + std::to_string(cells.count() - 1), std::to_string(cell));
    return *region.cells;
  }
  if (region.where.means_facets())
    throw InputError(region.place + ".where", "a selection of cells",
                     "facets of the surface (face_at, normal)", "use group, box, sphere or plane");
  if (region.where.kind == Where::Kind::group) return cells_of_group(body, dim, region);
  std::vector<Index> found;
  if (region.where.kind == Where::Kind::vertices) {
    const auto num_vertices = static_cast<Index>(body.mesh.vertices.size());
    std::vector<bool> is_listed(static_cast<std::size_t>(num_vertices), false);
    for (const Index vertex : region.where.vertices) {
      if (vertex < 0 || vertex >= num_vertices)
        throw InputError(region.place + ".where",
                         "vertex numbers from 0 to " + std::to_string(num_vertices - 1),
                         std::to_string(vertex));
      is_listed[static_cast<std::size_t>(vertex)] = true;
    }
    for (Index cell = 0; cell < cells.count(); ++cell)
      if (std::ranges::all_of(cells.corners(cell),
                              [&](Index corner) { return is_listed[static_cast<std::size_t>(corner)]; }))
        found.push_back(cell);
    return found;
  }
  const auto holds = place_test(region.where, dim, cells.extent(), region.place + ".where");
  for (Index cell = 0; cell < cells.count(); ++cell)
    if (holds(cells.centroid(cell))) found.push_back(cell);
  return found;
}

}  // namespace

std::vector<std::vector<Index>> cells_of_domains(const BodyDescription& body, int dim, bool is_part) {
  check_names(body.regions);
  const CellCorners cells(body, dim);
  std::vector<int> region_of(static_cast<std::size_t>(cells.count()), -1);
  for (std::size_t k = 0; k < body.regions.size(); ++k) {
    const RegionDescription& region = body.regions[k];
    const std::vector<Index> meant = cells_of_region(body, dim, region, cells);
    std::size_t num_free = 0;
    for (const Index cell : meant) {
      int& owner = region_of[static_cast<std::size_t>(cell)];
      if (owner >= 0) continue;
      owner = static_cast<int>(k);
      ++num_free;
    }
    if (num_free > 0 || is_part) continue;
    if (meant.empty())
      throw InputError(region.place + ".where", "a region with at least one cell", "none",
                       "a cell belongs to it if its centroid does");
    const int first = region_of[static_cast<std::size_t>(meant.front())];
    throw InputError(region.place + ".where", "a region with at least one cell of its own",
                     "cells that regions before it have, such as \"" +
                         body.regions[static_cast<std::size_t>(first)].name + "\"",
                     "a cell belongs to the first region that contains it: put this one first");
  }
  std::vector<std::vector<Index>> numbers(body.regions.size() + 1);
  for (std::size_t cell = 0; cell < region_of.size(); ++cell)
    numbers[static_cast<std::size_t>(region_of[cell] + 1)].push_back(static_cast<Index>(cell));
  return numbers;
}

}  // namespace resilin
