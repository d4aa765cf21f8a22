#pragma once

namespace resilin {

/// Two simple convex parts of surfaces that may come near each other.
enum class PairKind { point_point, point_edge, point_triangle, edge_edge };

/// Number of vertices of the first feature; they come first in every list of a pair.
constexpr int num_first(PairKind kind) { return kind == PairKind::edge_edge ? 2 : 1; }

/// Number of vertices of the second feature.
constexpr int num_second(PairKind kind) {
  switch (kind) {
    case PairKind::point_point:
      return 1;
    case PairKind::point_triangle:
      return 3;
    case PairKind::point_edge:
    case PairKind::edge_edge:
      break;
  }
  return 2;
}

/// Number of vertices of both features.
constexpr int num_vertices(PairKind kind) { return num_first(kind) + num_second(kind); }

/// No pair has more vertices.
constexpr int most_pair_vertices = 4;

}  // namespace resilin
