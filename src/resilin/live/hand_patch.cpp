#include "resilin/live/hand_patch.hpp"

#include <algorithm>
#include <span>

namespace resilin {
namespace {

/// Mean distance between the nodes of the cells that have a touched one, at rest [m].
double mean_edge(const World& world, const Body& body, const MaterialPoint& touched) {
  const int dim = world.dimension;
  const auto width = static_cast<std::size_t>(num_nodes(body.cell_kind));
  double sum = 0, count = 0;
  for (std::size_t first = 0; first < body.cells.size(); first += width) {
    const auto nodes = std::span(body.cells).subspan(first, width);
    const auto is_touched = [&](Index node) {
      return std::ranges::find(touched.nodes, node) != touched.nodes.end();
    };
    if (std::ranges::none_of(nodes, is_touched)) continue;
    for (std::size_t a = 0; a < width; ++a)
      for (std::size_t b = a + 1; b < width; ++b, ++count)
        sum += (node_position(dim, nodes[a], world.rest_positions) -
                node_position(dim, nodes[b], world.rest_positions))
                   .norm();
  }
  return count > 0 ? sum / count : 0;
}

/// The same point with each node once, and none without a weight.
MaterialPoint with_nodes_once(const MaterialPoint& point) {
  MaterialPoint once;
  for (std::size_t a = 0; a < point.nodes.size(); ++a) {
    const auto known = std::ranges::find(once.nodes, point.nodes[a]);
    if (known != once.nodes.end()) {
      once.weights[static_cast<std::size_t>(known - once.nodes.begin())] += point.weights[a];
    } else if (point.weights[a] != 0) {
      once.nodes.push_back(point.nodes[a]);
      once.weights.push_back(point.weights[a]);
    }
  }
  return once;
}

/// A place on a facet of a skin that is larger than the cells is carried by nodes far away: then the node
/// nearest to it.
MaterialPoint without_far_nodes(const World& world, const Body& body, const MaterialPoint& touched,
                                double reach) {
  const int dim = world.dimension;
  const VectorX& X = world.rest_positions;
  const Vector3 place = touched.position(dim, X);
  const auto distance = [&](Index node) { return (node_position(dim, node, X) - place).norm(); };
  if (std::ranges::all_of(touched.nodes, [&](Index node) { return distance(node) <= 2 * reach; }))
    return touched;
  Index nearest = body.cells.front();
  for (const Index node : body.cells)
    if (distance(node) < distance(nearest)) nearest = node;
  return {{nearest}, {1.0}};
}

}  // namespace

MaterialPoint hand_patch(const World& world, const MaterialPoint& at) {
  const int dim = world.dimension;
  const VectorX& X = world.rest_positions;
  const Body& body = world.body_of(at.nodes.front());
  if (body.rigid) return with_nodes_once(at);  // it keeps its shape however small the place
  const double usual = std::max(1.25 * mean_edge(world, body, at), 0.05 * largest_extent(body, X, dim));
  const MaterialPoint touched = without_far_nodes(world, body, at, usual);
  const Vector3 middle = touched.position(dim, X);
  const auto distance = [&](Index node) { return (node_position(dim, node, X) - middle).norm(); };
  double reach = usual;
  for (std::size_t a = 0; a < touched.nodes.size(); ++a)
    if (touched.weights[a] > 0) reach = std::max(reach, 1.2 * distance(touched.nodes[a]));

  std::vector<bool> is_taken(static_cast<std::size_t>(body.num_nodes), false);
  const auto place_of = [&](Index node) { return static_cast<std::size_t>(node - body.first_node); };
  for (const Index node : touched.nodes) is_taken[place_of(node)] = distance(node) < reach;
  const auto width = static_cast<std::size_t>(num_nodes(body.cell_kind));
  for (bool grows = true; grows;) {  // as often as the patch is cells wide
    grows = false;
    for (std::size_t first = 0; first < body.cells.size(); first += width) {
      const auto nodes = std::span(body.cells).subspan(first, width);
      if (std::ranges::none_of(nodes, [&](Index node) { return is_taken[place_of(node)]; })) continue;
      for (const Index node : nodes) {
        if (is_taken[place_of(node)] || distance(node) >= reach) continue;
        is_taken[place_of(node)] = grows = true;
      }
    }
  }
  MaterialPoint patch;
  double sum = 0;
  for (Index i = 0; i < body.num_nodes; ++i) {
    if (!is_taken[static_cast<std::size_t>(i)]) continue;
    const double share = distance(body.first_node + i) / reach;
    patch.nodes.push_back(body.first_node + i);
    patch.weights.push_back((1 - share * share) * (1 - share * share));
    sum += patch.weights.back();
  }
  for (double& weight : patch.weights) weight /= sum;
  return patch;
}

}  // namespace resilin
