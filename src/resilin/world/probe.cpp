#include "resilin/world/probe.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "resilin/core/text.hpp"
#include "resilin/world/rigid_shape.hpp"
#include "resilin/world/world.hpp"

namespace resilin {
namespace {

/// A probe watches the nearest vertex, which is a place of its own when it is half a cell away or a tenth of
/// the body.
void warn_of_distance(World& world, const Body& body, const ProbeDescription& probe, Index node,
                      double distance) {
  const int dim = world.dimension;
  const Vector3 place = node_position(dim, node, world.rest_positions);
  const auto width = static_cast<std::size_t>(resilin::num_nodes(body.cell_kind));
  double cell_size = 0;
  Vector3 low = place, high = place;
  for (std::size_t first = 0; first < body.cells.size(); first += width) {
    const auto cell = std::span(body.cells).subspan(first, width);
    const bool is_here = std::ranges::find(cell, node) != cell.end();
    for (const Index other : cell) {
      const Vector3 X = node_position(dim, other, world.rest_positions);
      if (is_here) cell_size = std::max(cell_size, (X - place).norm());
      low = low.cwiseMin(X);
      high = high.cwiseMax(X);
    }
  }
  if (distance <= std::min(0.5 * cell_size, 0.1 * (high - low).maxCoeff())) return;
  world.warnings.push_back(probe.place + ": the nearest vertex is " + format_short(distance) + " m from " +
                           world.place_text(world.origin + probe.at) + ", at " +
                           world.place_text(world.origin + place) + "; place it there, or refine the mesh");
}

}  // namespace

Vector3 Probe::value(int dim, const VectorX& of_nodes) const {
  if (carriers.empty()) return node < 0 ? Vector3(Vector3::Zero()) : node_position(dim, node, of_nodes);
  Vector3 sum = Vector3::Zero();
  for (const auto& [carrier, weight] : carriers) sum += weight * node_position(dim, carrier, of_nodes);
  return sum;
}

Probe find_probe(const ProbeDescription& probe, const Body& body, World& world) {
  Probe found{.name = probe.name, .node = body.first_node};
  if (body.rigid) {
    const VectorX weights = body.rigid->weights(probe.at);
    for (Index a = 0; a < static_cast<Index>(weights.size()); ++a)
      found.carriers.push_back({body.first_node + a, weights[a]});
    return found;
  }
  double nearest = std::numeric_limits<double>::infinity();
  const auto num_corners = static_cast<std::size_t>(resilin::num_corners(body.cell_kind));
  const auto width = static_cast<std::size_t>(resilin::num_nodes(body.cell_kind));
  for (std::size_t i = 0; i < body.cells.size(); ++i) {
    if (i % width >= num_corners) continue;
    const Index node = body.cells[i];
    const double distance =
        (node_position(world.dimension, node, world.rest_positions) - probe.at).squaredNorm();
    if (distance < nearest || (distance == nearest && node < found.node)) {
      nearest = distance;
      found.node = node;
    }
  }
  warn_of_distance(world, body, probe, found.node, std::sqrt(nearest));
  return found;
}

}  // namespace resilin
