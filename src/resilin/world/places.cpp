// Where bodies are and how far they reach.

#include <algorithm>

#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

Reach reach_along(int axis, const Body& body, const VectorX& positions, int dim) {
  const auto coordinates =
      positions(Eigen::seqN(Eigen::Index{body.first_node} * dim + axis, body.num_nodes, dim));
  return {coordinates.minCoeff(), coordinates.maxCoeff()};
}

double largest_extent(const Body& body, const VectorX& positions, int dim) {
  double extent = 0;
  for (int k = 0; k < dim; ++k) extent = std::max(extent, reach_along(k, body, positions, dim).length());
  return extent;
}

double World::largest_extent() const {
  double extent = 0;
  for (int k = 0; k < dimension; ++k) {
    const auto coordinates = rest_positions(Eigen::seq(k, Eigen::last, dimension));
    extent = std::max(extent, share.largest(coordinates.maxCoeff()) - share.smallest(coordinates.minCoeff()));
  }
  return extent;
}

double World::largest_extent(const Body& body) const {
  double extent = 0;
  for (int k = 0; k < dimension; ++k) {
    const Reach reach = reach_along(k, body, rest_positions, dimension);
    extent = std::max(extent, share.largest(reach.high) - share.smallest(reach.low));
  }
  return extent;
}

Vector3 World::place_of(Index node, const VectorX& positions) const {
  return origin + node_position(dimension, node, positions);
}

std::string World::place_text(const Vector3& point) const { return format_point(point, dimension); }

std::string World::place_text(Index vertex, const VectorX& places) const {
  return place_text(place_of(vertex, places));
}

}  // namespace resilin
