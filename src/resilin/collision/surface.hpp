#pragma once

#include <span>
#include <vector>

#include "resilin/collision/candidates.hpp"

namespace resilin {

/// The contact surfaces of all bodies and obstacles: in 3D points against triangles and edges against edges,
/// in 2D points against edges. Its vertices have numbers of their own, 0 to `bodies.size()`: they may be
/// nodes, or points that follow from nodes by a fixed linear map.
struct CollisionSurface {
  int dim = 3;
  std::vector<Index> points;     ///< the vertices that meet triangles, in 2D edges
  std::vector<Index> edges;      ///< two vertices each, every edge once
  std::vector<Index> triangles;  ///< three vertices each; none in 2D
  std::vector<Index> bodies;     ///< bodies of each vertex; a part belongs to the body of its first vertex

  std::size_t num_vertices() const { return bodies.size(); }
};

/// Adds a body, the next after the last, with all its vertices as points and each edge of its facets once.
/// @param facets  triangles, in 2D edges, by the body's own vertices from 0 on; one that repeats a vertex is
///                an edge or a point by itself
/// @return        the number of its first vertex in the surface
Index add_body(CollisionSurface& surface, Index num_vertices, std::span<const Index> facets);

/// Contact pairs of bodies, self-contact included.
class BodyMeetings {
 public:
  /// At first every body meets every other, and itself as told.
  explicit BodyMeetings(Index num_bodies, bool with_themselves = false)
      : num_bodies_(num_bodies),
        meet_(static_cast<std::size_t>(num_bodies) * static_cast<std::size_t>(num_bodies), 1) {
    for (Index body = 0; body < num_bodies; ++body) set(body, body, with_themselves);
  }
  void set(Index a, Index b, bool meet) { meet_[at(a, b)] = meet_[at(b, a)] = meet ? 1 : 0; }
  bool meet(Index a, Index b) const { return meet_[at(a, b)] != 0; }

  Index num_bodies() const { return num_bodies_; }
  const unsigned char* table() const { return meet_.data(); }  ///< row by row, 0 or 1

 private:
  std::size_t at(Index a, Index b) const {
    return static_cast<std::size_t>(a) * static_cast<std::size_t>(num_bodies_) + static_cast<std::size_t>(b);
  }
  Index num_bodies_;
  std::vector<unsigned char> meet_;
};

/// Pairs of parts of a surface, in rising order.
struct SurfaceCandidates {
  std::vector<Candidate> point_edge;      ///< in 2D: number in `points`, number of the edge
  std::vector<Candidate> point_triangle;  ///< number in `points`, number of the triangle
  std::vector<Candidate> edge_edge;       ///< the lower number first

  /// Those of one kind, with the vertices of their parts.
  CandidateList list(PairKind kind, const CollisionSurface& surface) const {
    switch (kind) {
      case PairKind::edge_edge:
        return {kind, edge_edge, surface.edges, surface.edges};
      case PairKind::point_triangle:
        return {kind, point_triangle, surface.points, surface.triangles};
      case PairKind::point_edge:
        return {kind, point_edge, surface.points, surface.edges};
      case PairKind::point_point:
        break;
    }
    return {kind, {}, {}, {}};
  }
};

}  // namespace resilin
