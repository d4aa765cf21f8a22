#include "resilin/mesh/curved_cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "resilin/element/catalog.hpp"
#include "resilin/element/jacobian_bound.hpp"
#include "resilin/mesh/quality.hpp"
#include "resilin/mesh/shape_integrals.hpp"

namespace resilin {
namespace {

constexpr double least_jacobian = 0.2;  // by the determinant of the straight cell
constexpr double reduction = 0.7;       // factor of displacements that are too large
constexpr int most_reductions = 8;

void gather(const Mesh& mesh, const CellBlock& cells, Index cell, std::vector<double>& positions) {
  positions.clear();
  for (const Index node : cells.cell(cell)) {
    const Vector3& X = mesh.vertices[static_cast<std::size_t>(node)];
    positions.insert(positions.end(), X.begin(), X.end());
  }
}

}  // namespace

Index bend_edges(Mesh& mesh, std::span<const BentEdge> bent) {
  const CellBlock& cells = mesh.blocks[0];
  const ElementInfo& element = *find_element("P2", 3);
  const std::vector<double> volumes = signed_volumes(mesh, cells);
  std::vector<Index> bend_of(mesh.vertices.size(), -1);
  std::vector<Vector3> straight;
  for (const BentEdge& edge : bent) {
    bend_of[static_cast<std::size_t>(edge.middle)] = static_cast<Index>(straight.size());
    straight.push_back(mesh.vertices[static_cast<std::size_t>(edge.middle)]);
  }
  std::vector<int> reductions(bent.size(), 0);
  std::vector<std::uint8_t> is_new(bent.size(), 1), is_too_far(bent.size(), 0);
  std::vector<double> positions;
  for (bool has_changed = !bent.empty(); has_changed;) {
    for (std::size_t i = 0; i < bent.size(); ++i) {
      const double share = reductions[i] > most_reductions ? 0 : std::pow(reduction, reductions[i]);
      mesh.vertices[static_cast<std::size_t>(bent[i].middle)] =
          straight[i] + share * (bent[i].wanted - straight[i]);
    }
    std::ranges::fill(is_too_far, 0);
    for (Index cell = 0; cell < cells.num_cells(); ++cell) {
      const auto visit_bends = [&](const auto& visit) {
        for (const Index node : cells.cell(cell))
          if (const Index i = bend_of[static_cast<std::size_t>(node)]; i >= 0)
            visit(static_cast<std::size_t>(i));
      };
      bool is_to_check = false;
      visit_bends([&](std::size_t i) { is_to_check = is_to_check || is_new[i] != 0; });
      if (!is_to_check) continue;
      gather(mesh, cells, cell, positions);
      const JacobianSign sign = jacobian_sign(element, positions);
      if (sign.kind == JacobianSign::Kind::positive &&
          sign.value >= least_jacobian * 6 * volumes[static_cast<std::size_t>(cell)])
        continue;
      visit_bends([&](std::size_t i) { is_too_far[i] = 1; });
    }
    has_changed = false;
    for (std::size_t i = 0; i < bent.size(); ++i) {
      is_new[i] = static_cast<std::uint8_t>(is_too_far[i] != 0 && reductions[i] <= most_reductions);
      if (is_new[i] == 0) continue;
      ++reductions[i];
      has_changed = true;
    }
  }
  return static_cast<Index>(std::ranges::count_if(reductions, [](int count) { return count > 0; }));
}

double exact_volume(const Mesh& mesh, const CellBlock& cells) {
  ShapeIntegrals integrals(*element_of_cells(cells.kind));
  std::vector<double> positions, of_nodes(static_cast<std::size_t>(num_nodes(cells.kind)));
  double volume = 0;
  for (Index cell = 0; cell < cells.num_cells(); ++cell) {
    gather(mesh, cells, cell, positions);
    integrals.of_values(positions, of_nodes);
    volume += std::accumulate(of_nodes.begin(), of_nodes.end(), 0.0);
  }
  return volume;
}

}  // namespace resilin
