#include "resilin/world/facet_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "resilin/mesh/box_tree.hpp"
#include "resilin/mesh/closest_point.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

constexpr double angle_of_faces = 35;  ///< [degrees], as sharp edges of the mesher

/// Positions in the node list of the parts that two facets share: ends of lines, edges of plane facets.
std::vector<std::array<std::size_t, 2>> rim_parts(CellKind kind) {
  if (dimension(kind) == 1) return {{0, 0}, {1, 1}};
  std::vector<std::array<std::size_t, 2>> parts;
  for (const auto& edge : cell_edges(kind))
    parts.push_back({static_cast<std::size_t>(edge[0]), static_cast<std::size_t>(edge[1])});
  return parts;
}

}  // namespace

FacetFaces::FacetFaces(int dim, CellBlock facets, const VectorX& positions)
    : dim_(dim), facets_(std::move(facets)), positions_(positions) {
  const auto parts = rim_parts(facets_.kind);
  struct Use {
    std::array<Index, 2> nodes;
    Index facet;
  };
  std::vector<Use> uses;
  for (Index facet = 0; facet < count(); ++facet) {
    const std::span<const Index> nodes = facets_.cell(facet);
    areas_.push_back(resilin::area_vector(dim_, facets_.kind, nodes, positions_));
    for (const auto& part : parts) {
      const auto [low, high] = std::minmax(nodes[part[0]], nodes[part[1]]);
      uses.push_back({{low, high}, facet});
    }
  }
  std::ranges::stable_sort(uses, {}, &Use::nodes);
  neighbours_.resize(static_cast<std::size_t>(count()));
  for (auto first = uses.begin(); first != uses.end();) {
    auto last = first;
    while (last != uses.end() && last->nodes == first->nodes) ++last;
    for (auto a = first; a != last; ++a)
      for (auto b = first; b != last; ++b)
        if (a != b) neighbours_[static_cast<std::size_t>(a->facet)].push_back(b->facet);
    first = last;
  }
}

Vector3 FacetFaces::centroid(Index facet) const {
  const auto corners = static_cast<std::size_t>(num_corners(facets_.kind));
  Vector3 sum = Vector3::Zero();
  for (const Index node : facets_.cell(facet).first(corners)) sum += node_position(dim_, node, positions_);
  return sum / static_cast<double>(corners);
}

double FacetFaces::squared_distance(Index facet, const Vector3& point) const {
  const std::span<const Index> nodes = facets_.cell(facet);
  const auto at = [&](std::size_t a) { return node_position(dim_, nodes[a], positions_); };
  if (dimension(facets_.kind) == 1) {
    const auto [s, t] = closest_on_segment(point, at(0), at(1));
    return (s * at(0) + t * at(1) - point).squaredNorm();
  }
  double least = std::numeric_limits<double>::infinity();
  const auto corners = static_cast<std::size_t>(num_corners(facets_.kind));
  for (std::size_t k = 2; k < corners; ++k) {
    const auto shares = closest_on_triangle(point, at(0), at(k - 1), at(k));
    least = std::min(least,
                     (shares[0] * at(0) + shares[1] * at(k - 1) + shares[2] * at(k) - point).squaredNorm());
  }
  return least;
}

std::vector<FacetFaces::Nearest> FacetFaces::nearest(std::span<const Vector3> points) const {
  std::vector<Box> boxes(static_cast<std::size_t>(count()));
  for (Index facet = 0; facet < count(); ++facet)
    for (const Index node : facets_.cell(facet))
      boxes[static_cast<std::size_t>(facet)].add(node_position(dim_, node, positions_));
  const BoxTree tree(boxes, points.size());
  std::vector<Nearest> found;
  for (const Vector3& point : points) {
    const Index facet = tree.nearest(point, [&](Index f) { return squared_distance(f, point); });
    found.push_back({facet, facet < 0 ? 0 : std::sqrt(squared_distance(facet, point))});
  }
  return found;
}

void FacetFaces::spread(Index facet, double degrees, const std::vector<bool>& among, Index number,
                        std::vector<Index>& numbers) const {
  const double least_cosine = std::cos(degrees * std::numbers::pi / 180);
  std::vector<Index> waiting = {facet};
  numbers[static_cast<std::size_t>(facet)] = number;
  while (!waiting.empty()) {
    const Index here = waiting.back();
    waiting.pop_back();
    for (const Index next : neighbours_[static_cast<std::size_t>(here)]) {
      const auto n = static_cast<std::size_t>(next);
      if (numbers[n] >= 0 || !among[n] || normal(here).dot(normal(next)) < least_cosine) continue;
      numbers[n] = number;
      waiting.push_back(next);
    }
  }
}

std::vector<bool> FacetFaces::face_of(Index facet, double degrees) const {
  const auto size = static_cast<std::size_t>(count());
  std::vector<Index> numbers(size, -1);
  spread(facet, degrees, std::vector<bool>(size, true), 0, numbers);
  std::vector<bool> is_reached(size);
  for (std::size_t i = 0; i < size; ++i) is_reached[i] = numbers[i] == 0;
  return is_reached;
}

std::vector<Index> FacetFaces::number_faces(const std::vector<bool>& among, double degrees) const {
  std::vector<Index> numbers(static_cast<std::size_t>(count()), -1);
  Index number = 0;
  for (Index facet = 0; facet < count(); ++facet)
    if (among[static_cast<std::size_t>(facet)] && numbers[static_cast<std::size_t>(facet)] < 0)
      spread(facet, degrees, among, number++, numbers);
  return numbers;
}

OppositeSides opposite_sides(const FacetFaces& surface) {
  constexpr double worth_telling = 0.05;
  constexpr std::size_t most_faces = 200;  // faces of a rough surface; the largest are looked at
  const std::vector<bool> all(static_cast<std::size_t>(surface.count()), true);
  const std::vector<Index> numbers = surface.number_faces(all, angle_of_faces);
  std::vector<Vector3> sums;
  double whole = 0;
  for (Index facet = 0; facet < surface.count(); ++facet) {
    const auto face = static_cast<std::size_t>(numbers[static_cast<std::size_t>(facet)]);
    if (face >= sums.size()) sums.resize(face + 1, Vector3::Zero());
    sums[face] += surface.area_vector(facet);
    whole += surface.area_vector(facet).norm();
  }
  std::ranges::stable_sort(sums, std::ranges::greater{}, [](const Vector3& sum) { return sum.norm(); });
  if (sums.size() > most_faces) sums.resize(most_faces);
  OppositeSides found;
  for (std::size_t a = 0; a < sums.size(); ++a)
    for (std::size_t b = a + 1; b < sums.size(); ++b) {
      const double area = std::min(sums[a].norm(), sums[b].norm());
      if (area < worth_telling * whole || area <= found.area) continue;
      if (sums[a].dot(sums[b]) < -0.9 * sums[a].norm() * sums[b].norm()) found = {area, sums[a].normalized()};
    }
  return found;
}

}  // namespace resilin
