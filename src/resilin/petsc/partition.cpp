#include "resilin/petsc/partition.hpp"

#include <metis.h>

#include <algorithm>
#include <new>
#include <span>
#include <string>

#include "resilin/core/error.hpp"

namespace resilin {
namespace {

/// Cells by their corners, in rows.
struct CornerLists {
  std::vector<idx_t> begin = {0}, corners;
};

CornerLists corner_lists(const Body& body) {
  const auto width = static_cast<std::size_t>(num_nodes(body.cell_kind));
  const auto count = static_cast<std::size_t>(num_corners(body.cell_kind));
  CornerLists lists;
  for (std::size_t first = 0; first < body.cells.size(); first += width) {
    for (const Index node : std::span(body.cells).subspan(first, count))
      lists.corners.push_back(node - body.first_node);
    lists.begin.push_back(static_cast<idx_t>(lists.corners.size()));
  }
  return lists;
}

/// Where METIS has left a process without cells, of very small bodies, runs of cells in a row.
std::vector<std::int32_t> rows_of_cells(std::size_t num_cells, int num_ranks) {
  std::vector<std::int32_t> ranks(num_cells);
  for (std::size_t cell = 0; cell < num_cells; ++cell)
    ranks[cell] = static_cast<std::int32_t>(cell * static_cast<std::size_t>(num_ranks) / num_cells);
  return ranks;
}

bool all_have_cells(std::span<const std::int32_t> ranks, int num_ranks) {
  std::vector<bool> has(static_cast<std::size_t>(num_ranks), false);
  for (const std::int32_t rank : ranks) has[static_cast<std::size_t>(rank)] = true;
  return std::ranges::find(has, false) == has.end();
}

std::vector<std::int32_t> partition_of(const Body& body, int num_ranks) {
  CornerLists lists = corner_lists(body);
  auto num_cells = static_cast<idx_t>(body.num_cells()), num_vertices = static_cast<idx_t>(body.num_nodes);
  auto parts = static_cast<idx_t>(num_ranks);
  idx_t common = num_corners(cell_sides(body.cell_kind)[0].kind), cut = 0;
  std::vector<idx_t> of_cells(static_cast<std::size_t>(num_cells), 0);
  std::vector<idx_t> of_vertices(static_cast<std::size_t>(num_vertices));
  const int status = METIS_PartMeshDual(&num_cells, &num_vertices, lists.begin.data(), lists.corners.data(),
                                        nullptr, nullptr, &common, &parts, nullptr, nullptr, &cut,
                                        of_cells.data(), of_vertices.data());
  if (status == METIS_ERROR_MEMORY) throw std::bad_alloc();
  std::vector<std::int32_t> ranks(of_cells.begin(), of_cells.end());
  if (status != METIS_OK || !all_have_cells(ranks, num_ranks)) return rows_of_cells(ranks.size(), num_ranks);
  return ranks;
}

}  // namespace

std::vector<std::vector<std::int32_t>> partition_cells(const World& world, int num_ranks) {
  std::vector<std::vector<std::int32_t>> ranks;
  for (const Body& body : world.bodies) {
    if (body.num_cells() < num_ranks)
      throw InputError(world.place, "no more processes than the cells of a body",
                       std::to_string(num_ranks) + " for the " + std::to_string(body.num_cells()) +
                           " cells of \"" + body.name + "\"",
                       "start fewer: mpirun -n " + std::to_string(std::max(1, body.num_cells() / 1000)));
    ranks.push_back(partition_of(body, num_ranks));
  }
  return ranks;
}

}  // namespace resilin
