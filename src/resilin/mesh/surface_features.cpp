#include "resilin/mesh/surface_features.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "resilin/mesh/closest_point.hpp"
#include "resilin/mesh/quality.hpp"

namespace resilin {
namespace {

constexpr double sharp_cosine = 0.819;   // 35 degrees
constexpr double corner_cosine = 0.707;  // 45 degrees

using EdgeNodes = std::array<Index, 2>;

std::vector<EdgeNodes> sharp_edges(const SolidSurface& surface) {
  struct Side {
    EdgeNodes edge;
    Index triangle;
  };
  std::vector<Side> sides;
  const CellBlock& triangles = surface.triangles();
  for (Index t = 0; t < triangles.num_cells(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(triangles.cell(t)[i], triangles.cell(t)[(i + 1) % 3]);
      sides.push_back({{low, high}, t});
    }
  std::ranges::stable_sort(sides, {}, &Side::edge);
  const std::vector<Vector3> areas = triangle_area_vectors(surface.mesh, triangles);
  std::vector<EdgeNodes> sharp;
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].edge == sides[begin].edge) ++end;
    if (end - begin == 1) continue;
    if (end - begin == 2) {
      const Vector3& a = areas[static_cast<std::size_t>(sides[begin].triangle)];
      const Vector3& b = areas[static_cast<std::size_t>(sides[begin + 1].triangle)];
      if (!(a.dot(b) < sharp_cosine * a.norm() * b.norm())) continue;
    }
    sharp.push_back(sides[begin].edge);
  }
  return sharp;
}

/// The sharp edges as a graph.
class CreaseGraph {
 public:
  CreaseGraph(const SolidSurface& surface, double finest) : surface_(surface), edges_(sharp_edges(surface)) {
    at_.resize(surface.mesh.vertices.size());
    for (std::size_t e = 0; e < edges_.size(); ++e)
      for (const Index v : edges_[e]) at_[static_cast<std::size_t>(v)].push_back(static_cast<Index>(e));
    drop_noise(finest);
  }

  SurfaceFeatures trace() {
    SurfaceFeatures features;
    corner_numbers_.assign(at_.size(), -1);
    for (Index v = 0; v < static_cast<Index>(at_.size()); ++v)
      if (is_corner(v)) {
        corner_numbers_[static_cast<std::size_t>(v)] = static_cast<Index>(features.corners.size());
        features.corners.push_back(X(v));
      }
    is_used_.assign(edges_.size(), 0);
    for (Index v = 0; v < static_cast<Index>(at_.size()); ++v) {
      if (corner_numbers_[static_cast<std::size_t>(v)] < 0) continue;
      for (const Index e : at(v))
        if (is_used_[static_cast<std::size_t>(e)] == 0) features.lines.push_back(follow(v, e));
    }
    for (Index e = 0; e < static_cast<Index>(edges_.size()); ++e)
      if (is_used_[static_cast<std::size_t>(e)] == 0)
        features.lines.push_back(follow(edges_[static_cast<std::size_t>(e)][0], e));
    return features;
  }

 private:
  const Vector3& X(Index v) const { return surface_.mesh.vertices[static_cast<std::size_t>(v)]; }
  const std::vector<Index>& at(Index v) const { return at_[static_cast<std::size_t>(v)]; }
  Index other_end(Index e, Index v) const {
    const EdgeNodes& edge = edges_[static_cast<std::size_t>(e)];
    return edge[0] == v ? edge[1] : edge[0];
  }
  double length(Index e) const {
    const EdgeNodes& edge = edges_[static_cast<std::size_t>(e)];
    return (X(edge[1]) - X(edge[0])).norm();
  }

  /// Cosine between the edges that come to v and go from it.
  double straightness(Index v) const {
    const Vector3 a = X(v) - X(other_end(at(v)[0], v)), b = X(other_end(at(v)[1], v)) - X(v);
    const double divisor = a.norm() * b.norm();
    return divisor > 0 ? a.dot(b) / divisor : 1;
  }
  bool is_corner(Index v) const {
    if (at(v).empty()) return false;
    return at(v).size() != 2 || straightness(v) < corner_cosine;
  }

  void drop_noise(double finest) {
    std::vector<std::uint8_t> is_seen(edges_.size(), 0), is_dropped(edges_.size(), 0);
    for (Index start = 0; start < static_cast<Index>(edges_.size()); ++start) {
      if (is_seen[static_cast<std::size_t>(start)] != 0) continue;
      std::vector<Index> group = {start};
      is_seen[static_cast<std::size_t>(start)] = 1;
      double total = 0, ends = 0;
      for (std::size_t i = 0; i < group.size(); ++i) {
        total += length(group[i]);
        for (const Index v : edges_[static_cast<std::size_t>(group[i])]) {
          // Each corner ends as many lines as edges meet there; every edge at it adds one end.
          ends += is_corner(v) ? 1 : 0;
          for (const Index e : at(v))
            if (is_seen[static_cast<std::size_t>(e)] == 0) {
              is_seen[static_cast<std::size_t>(e)] = 1;
              group.push_back(e);
            }
        }
      }
      const double lines = std::max(1.0, 0.5 * ends);
      if (total >= finest && (lines < 1.5 || total / lines >= 0.5 * finest)) continue;
      for (const Index e : group) is_dropped[static_cast<std::size_t>(e)] = 1;
    }
    std::vector<EdgeNodes> kept;
    for (std::size_t e = 0; e < edges_.size(); ++e)
      if (is_dropped[e] == 0) kept.push_back(edges_[e]);
    edges_ = std::move(kept);
    for (auto& list : at_) list.clear();
    for (std::size_t e = 0; e < edges_.size(); ++e)
      for (const Index v : edges_[e]) at_[static_cast<std::size_t>(v)].push_back(static_cast<Index>(e));
  }

  CreaseLine follow(Index from, Index e) {
    CreaseLine line;
    line.points = {X(from)};
    line.lengths = {0};
    line.first = corner_numbers_[static_cast<std::size_t>(from)];
    Index v = from;
    while (true) {
      is_used_[static_cast<std::size_t>(e)] = 1;
      v = other_end(e, v);
      line.lengths.push_back(line.lengths.back() + (X(v) - line.points.back()).norm());
      line.points.push_back(X(v));
      line.last = corner_numbers_[static_cast<std::size_t>(v)];
      if (line.last >= 0 || v == from) break;
      line.turning += std::acos(std::clamp(straightness(v), -1.0, 1.0));
      e = at(v)[0] == e ? at(v)[1] : at(v)[0];
    }
    if (line.first < 0) line.turning = 2 * std::numbers::pi;
    return line;
  }

  const SolidSurface& surface_;
  std::vector<EdgeNodes> edges_;
  std::vector<std::vector<Index>> at_;  ///< edges of each vertex
  std::vector<Index> corner_numbers_;
  std::vector<std::uint8_t> is_used_;
};

}  // namespace

Vector3 CreaseLine::at(double s) const {
  const auto next = std::ranges::upper_bound(lengths, s);
  if (next == lengths.begin()) return points.front();
  if (next == lengths.end()) return points.back();
  const auto i = static_cast<std::size_t>(next - lengths.begin());
  const double share = (s - lengths[i - 1]) / (lengths[i] - lengths[i - 1]);
  return points[i - 1] + share * (points[i] - points[i - 1]);
}

double CreaseLine::nearest(const Vector3& p) const {
  double best = 0, least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double share = closest_on_segment(p, points[i], points[i + 1])[1];
    const double distance = (points[i] + share * (points[i + 1] - points[i]) - p).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best = lengths[i] + share * (lengths[i + 1] - lengths[i]);
  }
  return best;
}

SurfaceFeatures find_features(const SolidSurface& surface, double finest) {
  return CreaseGraph(surface, finest).trace();
}

}  // namespace resilin
