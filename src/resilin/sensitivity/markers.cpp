#include "resilin/sensitivity/markers.hpp"

#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/cell_positions.hpp"
#include "resilin/mesh/embedding.hpp"
#include "resilin/mesh/shape_integrals.hpp"

namespace resilin {

const Body& body_named(const World& world, const std::string& name, const std::string& place) {
  return world.bodies[find_body(world, name, place)];
}

const Probe& probe_named(const World& world, const std::string& name, const std::string& place) {
  std::vector<std::string> names;
  for (const Probe& probe : world.probes) {
    if (probe.name == name) return probe;
    names.push_back(probe.name);
  }
  refuse_word(place, name, names);
}

std::vector<Marker> markers_at(const World& world, const Body& body, const std::vector<Vector3>& points,
                               const std::vector<std::string>& places, double tolerance) {
  std::vector<Vector3> centred = points;
  for (Vector3& point : centred) {
    point -= world.origin;
    if (world.dimension == 2) point[2] = 0;
  }
  const Embedding embedding(body.domains.element(), body.cells, world.rest_positions, centred);
  if (const Embedding::Outside& outside = embedding.outside();
      outside.count > 0 && outside.distance > tolerance) {
    const auto worst = static_cast<std::size_t>(outside.point);
    throw InputError(
        places[worst], "a point inside " + body.name + " in the reference configuration",
        format_point(points[worst], world.dimension) + ", " + format_short(outside.distance) + " m outside",
        "give markers by their reference positions");
  }
  std::vector<Marker> markers(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    embedding.append_weights(static_cast<Index>(i), markers[i].nodes, markers[i].weights);
  return markers;
}

double volume_of(const Body& body, int dim, const VectorX& x, VectorX& slopes) {
  const ElementInfo& element = body.domains.element();
  const auto n = static_cast<std::size_t>(element.num_nodes);
  ShapeIntegrals integrals(element);
  const std::vector<double> ones(n, 1.0);
  std::vector<double> positions, shares(n), by_x(n * static_cast<std::size_t>(dim));
  double volume = 0;
  for (std::size_t first = 0; first < body.cells.size(); first += n) {
    const std::span<const Index> nodes = std::span(body.cells).subspan(first, n);
    cell_positions(dim, nodes, x, positions);
    integrals.of_values(positions, shares);
    volume += std::accumulate(shares.begin(), shares.end(), 0.0);
    std::ranges::fill(by_x, 0.0);
    integrals.add_slopes_of_values(positions, ones, by_x);
    add_cell_values(dim, nodes, 1, by_x, slopes);
  }
  return volume;
}

}  // namespace resilin
