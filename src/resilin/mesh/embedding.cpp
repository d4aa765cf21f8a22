#include "resilin/mesh/embedding.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/mesh/cell_surface.hpp"

namespace resilin {
namespace {

constexpr std::size_t searches_per_chunk = 1024;
constexpr double weight_rounding = 1e-12;  // rounding relative to a point's largest weight
constexpr double inside_tolerance = 1e-9;  // tolerance of a reference coordinate: a point on a side is inside

BoxTree tree_of(const CellMap& map, double margin, std::size_t num_searches) {
  std::vector<Box> boxes;
  boxes.reserve(static_cast<std::size_t>(map.num_cells()));
  for (Index cell = 0; cell < map.num_cells(); ++cell) {
    boxes.push_back(map.box(cell));
    boxes.back().min.array() -= margin;
    boxes.back().max.array() += margin;
  }
  return BoxTree(boxes, num_searches);
}

double extent_of(const VectorX& X, std::span<const Index> cells, int dim) {
  Box box;
  for (const Index node : cells) {
    Vector3 place = Vector3::Zero();
    place.head(dim) = X.segment(Eigen::Index{node} * dim, dim);
    box.add(place);
  }
  return (box.max - box.min).maxCoeff();
}

/// Where a point is in the cells, or on their surface.
struct Found {
  Index cell = -1;
  Vector3 xi = Vector3::Zero();
  double depth = -1;
  double distance = 0;  ///< from the cells; zero inside
};

Found find_inside(const CellMap& map, const BoxTree& tree, const Vector3& X) {
  Found found;
  tree.visit_containing(X, [&](Index cell) {
    const std::optional<Vector3> xi = map.invert(cell, X);
    if (!xi) return;
    const double depth = map.depth(*xi);
    if (depth < -inside_tolerance) return;
    if (found.cell < 0 || depth > found.depth || (depth == found.depth && cell < found.cell))
      found = {cell, *xi, depth, 0};
  });
  return found;
}

Found find_outside(const CellSurface& surface, const Vector3& X) {
  const CellSurface::Nearest nearest = surface.nearest(X);
  return {nearest.cell, nearest.xi, -1, nearest.distance};
}

}  // namespace

Embedding::Embedding(const ElementInfo& element, std::span<const Index> cells, const VectorX& rest_positions,
                     std::span<const Vector3> points, bool is_smooth)
    : dim_(element.dim),
      nodes_per_point_(element.num_nodes),
      cell_(points.size()),
      nodes_(points.size() * width()),
      weights_(points.size() * width()) {
  if (cells.empty()) throw InputError("embedding", "at least one cell", "none");
  const auto bad = std::ranges::find_if(points, [](const Vector3& X) { return !X.allFinite(); });
  if (bad != points.end())
    throw InputError("embedding: point " + std::to_string(bad - points.begin()), "finite coordinates",
                     "inf or nan");
  find_cells(element, cells, rest_positions, points);
  number_used_nodes(static_cast<Index>(rest_positions.size() / dim_));
  if (is_smooth && element.degree == 1) add_smoothing(element, cells, rest_positions, points);
}

void Embedding::find_cells(const ElementInfo& element, std::span<const Index> cells,
                           const VectorX& rest_positions, std::span<const Vector3> points) {
  const CellMap map(element, cells, rest_positions);
  const double extent = extent_of(rest_positions, cells, dim_);
  const BoxTree tree = tree_of(map, inside_tolerance * extent, points.size());
  const auto place = [&](std::size_t p) {
    return dim_ == 2 ? Vector3(points[p].x(), points[p].y(), 0) : points[p];
  };
  std::vector<Found> found(points.size());
  const auto for_points = [&](const auto& body) {
    parallel_for(points.size(), searches_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) body(p);
    });
  };
  for_points([&](std::size_t p) { found[p] = find_inside(map, tree, place(p)); });
  if (std::ranges::any_of(found, [](const Found& f) { return f.cell < 0; })) {
    const CellSurface surface(map);
    for_points([&](std::size_t p) {
      if (found[p].cell < 0) found[p] = find_outside(surface, place(p));
    });
  }
  for_points([&](std::size_t p) {
    cell_[p] = found[p].cell;
    std::ranges::copy(map.nodes(cell_[p]), nodes_.begin() + static_cast<std::ptrdiff_t>(p * width()));
    map.weights_at(cell_[p], found[p].xi, place(p), std::span(weights_).subspan(p * width(), width()));
  });
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (!(found[p].distance > inside_tolerance * extent)) continue;
    ++outside_.count;
    if (found[p].distance > outside_.distance)
      outside_ = {outside_.count, static_cast<Index>(p), found[p].distance,
                  found[p].distance / map.mean_edge(cell_[p])};
  }
}

void Embedding::number_used_nodes(Index num_nodes) {
  std::vector<Index> number(static_cast<std::size_t>(num_nodes), -1);
  for (const Index node : nodes_) number[static_cast<std::size_t>(node)] = 0;
  for (Index node = 0; node < num_nodes; ++node) {
    if (number[static_cast<std::size_t>(node)] < 0) continue;
    number[static_cast<std::size_t>(node)] = static_cast<Index>(used_nodes_.size());
    used_nodes_.push_back(node);
  }
  local_.reserve(nodes_.size());
  for (const Index node : nodes_)
    local_.push_back(static_cast<std::uint32_t>(number[static_cast<std::size_t>(node)]));
}

void Embedding::append_weights(Index point, std::vector<Index>& nodes, std::vector<double>& weights) const {
  std::map<Index, double> of_nodes;
  for (std::size_t i = first(point); i < first(point) + width(); ++i) {
    of_nodes[nodes_[i]] += weights_[i];
    if (gradients_)  // F_a arm = sum_b x_b (g_ab . arm)
      gradients_->for_each_neighbor(
          local_[i], [&](Index b, const Vector3& gradient) { of_nodes[b] += gradient.dot(arms_[i]); });
  }
  double largest = 0, sum = 0;
  for (const auto& [node, weight] : of_nodes) largest = std::max(largest, std::abs(weight));
  std::erase_if(of_nodes,
                [&](const auto& entry) { return std::abs(entry.second) <= weight_rounding * largest; });
  for (const auto& [node, weight] : of_nodes) sum += weight;
  for (const auto& [node, weight] : of_nodes) {
    nodes.push_back(node);
    weights.push_back(weight / sum);
  }
}

void Embedding::add_smoothing(const ElementInfo& element, std::span<const Index> cells,
                              const VectorX& rest_positions, std::span<const Vector3> points) {
  gradients_.emplace(element, cells, rest_positions, used_nodes_);
  arms_.reserve(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Vector3 arm = Vector3::Zero();
    arm.head(dim_) =
        points[i / width()].head(dim_) - rest_positions.segment(Eigen::Index{nodes_[i]} * dim_, dim_);
    arms_.emplace_back(0.5 * weights_[i] * arm);
  }
}

}  // namespace resilin
