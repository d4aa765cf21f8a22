#pragma once

// The points of two parts of surfaces that are nearest to each other, without branches, for a double or for
// lanes. Corner cases are exact: a vertex that has no share in its closest point has weight zero.
//
// Source: Ericson 2005, "Real-Time Collision Detection", 5.1 (regions of points, edges and triangles). The
// parameters inside two edges or a triangle follow from triple products with the normal N of both, whose
// round-off grows as 1 / sin(angle) and not, as that of the normal equations does, with its square.

#include <limits>

#include "resilin/collision/pair_kind.hpp"
#include "resilin/collision/triple.hpp"

namespace resilin {

/// Closest points of two features of surfaces, as weights of their vertices.
template <class Real>
struct ClosestPoints {
  /// Weights of the vertices: from 0 to 1 and adding up to 1 for the first part, from -1 to 0 and adding
  /// up to -1 for the second.
  Real weights[most_pair_vertices];
  Triple<Real> gap;       ///< sum_i weights_i x_i: from the second closest point to the first
  Real squared_distance;  ///< |gap|^2
};

/// The second where that is said, otherwise the first.
template <class Real, class Mask>
RESILIN_INLINE ClosestPoints<Real> select_second(const Mask& says, const ClosestPoints<Real>& a,
                                                 const ClosestPoints<Real>& b) {
  ClosestPoints<Real> selected;
  for (int i = 0; i < most_pair_vertices; ++i) selected.weights[i] = select(says, b.weights[i], a.weights[i]);
  selected.gap = select(says, b.gap, a.gap);
  selected.squared_distance = select(says, b.squared_distance, a.squared_distance);
  return selected;
}

/// Whether the lines along two edges with the cross product N are far enough from parallel for their triple
/// products to tell what is inside: beside the sines 1e-4 of digits lost.
template <class Real>
RESILIN_INLINE auto are_skew(const Triple<Real>& a, const Triple<Real>& b, const Triple<Real>& N) {
  return dot(N, N) > 1e-8 * (dot(a, a) * dot(b, b));
}

/// s in [0, 1] of the point a + s e nearest to one that is `from_a` away from a; 0 for an edge of no length.
template <class Real>
RESILIN_INLINE Real edge_parameter(const Triple<Real>& from_a, const Triple<Real>& e) {
  const Real along = dot(from_a, e), squared_length = dot(e, e);
  const Real s = select(along < squared_length, along / squared_length, Real(1.0));
  return select(along > Real(0.0), s, Real(0.0));
}

/// Closest points of two points: the points themselves.
template <class Real>
RESILIN_INLINE ClosestPoints<Real> closest_point_point(const Triple<Real>& p, const Triple<Real>& q) {
  const Triple<Real> gap = p - q;
  return {{Real(1.0), Real(-1.0), Real(0.0), Real(0.0)}, gap, dot(gap, gap)};
}

/// Closest points of the point p and the edge from a to b.
template <class Real>
RESILIN_INLINE ClosestPoints<Real> closest_point_edge(const Triple<Real>& p, const Triple<Real>& a,
                                                      const Triple<Real>& b) {
  const Triple<Real> from_a = p - a, from_b = p - b;
  const Real s = edge_parameter(from_a, b - a), rest = 1.0 - s;
  const Triple<Real> gap = rest * from_a + s * from_b;
  return {{Real(1.0), -rest, -s, Real(0.0)}, gap, dot(gap, gap)};
}

/// The same with its weights at the places of the vertices in a larger pair.
template <class Real>
RESILIN_INLINE ClosestPoints<Real> closest_point_edge_at(const Triple<Real> x[], int p, int a, int b,
                                                         double sign) {
  const ClosestPoints<Real> edge = closest_point_edge(x[p], x[a], x[b]);
  ClosestPoints<Real> placed;
  for (Real& weight : placed.weights) weight = 0.0;
  placed.weights[p] = sign * edge.weights[0];
  placed.weights[a] = sign * edge.weights[1];
  placed.weights[b] = sign * edge.weights[2];
  placed.gap = Real(sign) * edge.gap;
  placed.squared_distance = edge.squared_distance;
  return placed;
}

/// Whether a vertex of the second part, whose weights are not above zero, has no share.
template <class Real>
RESILIN_INLINE auto has_no_share(const Real& weight) {
  return weight > Real(-std::numeric_limits<double>::min());
}

/// For the point x[0] and the edges of the triangle x[1], x[2], x[3]. The foot on an edge is as near as its
/// vertices or nearer: it wins over the same vertex as the end of another edge without a look at distances,
/// whose round-off would hide a foot that is closer to the vertex than the root of that round-off.
template <class Real>
RESILIN_INLINE ClosestPoints<Real> closest_point_rim(const Triple<Real> x[]) {
  const Real zero(0.0);
  const ClosestPoints<Real> first = closest_point_edge_at(x, 0, 1, 2, 1.0);
  const ClosestPoints<Real> second = closest_point_edge_at(x, 0, 2, 3, 1.0);
  const ClosestPoints<Real> third = closest_point_edge_at(x, 0, 3, 1, 1.0);
  const auto is_second = (second.weights[3] < zero) & (has_no_share(first.weights[1]) |
                                                       (second.squared_distance < first.squared_distance));
  const ClosestPoints<Real> nearer = select_second(is_second, first, second);
  const Real shared = select(is_second, third.weights[1], third.weights[3]);
  const auto is_third = has_no_share(nearer.weights[2]) |
                        ((shared < zero) & (third.squared_distance < nearer.squared_distance));
  return select_second(is_third, nearer, third);
}

/// For the point x[0] and the triangle x[1], x[2], x[3]: the plane's own foot where it lies inside; the edges
/// decide otherwise, and for a triangle without area.
template <class Real>
RESILIN_INLINE ClosestPoints<Real> closest_point_triangle(const Triple<Real> x[]) {
  ClosestPoints<Real> nearest = closest_point_rim(x);
  const Triple<Real> from[3] = {x[0] - x[1], x[0] - x[2], x[0] - x[3]};
  const Triple<Real> e1 = x[2] - x[1], e2 = x[3] - x[1], N = cross(e1, e2);
  const Real inverse = 1.0 / dot(N, N);
  Real u = dot(cross(from[0], e2), N) * inverse, v = dot(cross(e1, from[0]), N) * inverse;
  // Once more from the gap itself, which is short where digits count: round-off then grows with the distance.
  Triple<Real> gap = (1.0 - u - v) * from[0] + u * from[1] + v * from[2];
  u += dot(cross(gap, e2), N) * inverse;
  v += dot(cross(e1, gap), N) * inverse;
  const Real w = 1.0 - u - v;
  gap = w * from[0] + u * from[1] + v * from[2];
  const Real squared_distance = dot(gap, gap);
  const auto is_inside = (u > Real(0.0)) & (v > Real(0.0)) & (w > Real(0.0)) &
                         (are_skew(e1, e2, N) | (squared_distance < nearest.squared_distance));
  const Real weights[4] = {Real(1.0), -w, -u, -v};
  for (int i = 0; i < 4; ++i) nearest.weights[i] = select(is_inside, weights[i], nearest.weights[i]);
  nearest.gap = select(is_inside, gap, nearest.gap);
  nearest.squared_distance = select(is_inside, squared_distance, nearest.squared_distance);
  return nearest;
}

/// For the edges x[0] x[1] and x[2] x[3], at an end of one of them: again what has its foot inside an edge
/// wins over the ends of that edge.
template <class Real>
RESILIN_INLINE ClosestPoints<Real> closest_end_edge(const Triple<Real> x[]) {
  const Real zero(0.0);
  const auto nearer = [](const ClosestPoints<Real>& a, const ClosestPoints<Real>& b) {
    return b.squared_distance < a.squared_distance;
  };
  const ClosestPoints<Real> of_first[2] = {closest_point_edge_at(x, 0, 2, 3, 1.0),
                                           closest_point_edge_at(x, 1, 2, 3, 1.0)};
  const ClosestPoints<Real> first = select_second(nearer(of_first[0], of_first[1]), of_first[0], of_first[1]);
  const ClosestPoints<Real> of_second[2] = {closest_point_edge_at(x, 2, 0, 1, -1.0),
                                            closest_point_edge_at(x, 3, 0, 1, -1.0)};
  ClosestPoints<Real> nearest = first;
  for (int k = 0; k < 2; ++k) {
    const ClosestPoints<Real>& end = of_second[k];
    const auto is_inside = (end.weights[0] > zero) & (end.weights[1] > zero);
    const auto is_end_of_nearest = has_no_share(nearest.weights[3 - k]);
    nearest = select_second(is_inside & (is_end_of_nearest | nearer(nearest, end)), nearest, end);
  }
  return nearest;
}

/// For the edges x[0] x[1] and x[2] x[3]: inside both where their lines are nearest there; the ends decide
/// otherwise, and for parallel edges and edges of no length.
template <class Real>
RESILIN_INLINE ClosestPoints<Real> closest_edge_edge(const Triple<Real> x[]) {
  ClosestPoints<Real> nearest = closest_end_edge(x);
  const Triple<Real> a = x[1] - x[0], b = x[3] - x[2], N = cross(a, b);
  const Triple<Real> from[2][2] = {{x[0] - x[2], x[0] - x[3]}, {x[1] - x[2], x[1] - x[3]}};
  const Real inverse = 1.0 / dot(N, N);
  const auto gap_at = [&](const Real& s, const Real& t) {
    return (1.0 - s) * ((1.0 - t) * from[0][0] + t * from[0][1]) +
           s * ((1.0 - t) * from[1][0] + t * from[1][1]);
  };
  Real s = -(dot(cross(from[0][0], b), N) * inverse), t = -(dot(cross(from[0][0], a), N) * inverse);
  Triple<Real> gap = gap_at(s, t);
  s -= dot(cross(gap, b), N) * inverse;  // as for the triangle
  t -= dot(cross(gap, a), N) * inverse;
  gap = gap_at(s, t);
  const Real squared_distance = dot(gap, gap);
  const auto is_inside = (s > Real(0.0)) & (s < Real(1.0)) & (t > Real(0.0)) & (t < Real(1.0)) &
                         (are_skew(a, b, N) | (squared_distance < nearest.squared_distance));
  const Real weights[4] = {1.0 - s, s, t - 1.0, -t};
  for (int i = 0; i < 4; ++i) nearest.weights[i] = select(is_inside, weights[i], nearest.weights[i]);
  nearest.gap = select(is_inside, gap, nearest.gap);
  nearest.squared_distance = select(is_inside, squared_distance, nearest.squared_distance);
  return nearest;
}

/// For a pair of any kind, its vertices in their order.
template <PairKind kind, class Real>
RESILIN_INLINE ClosestPoints<Real> closest_points(const Triple<Real> x[]) {
  if constexpr (kind == PairKind::point_point)
    return closest_point_point(x[0], x[1]);
  else if constexpr (kind == PairKind::point_edge)
    return closest_point_edge(x[0], x[1], x[2]);
  else if constexpr (kind == PairKind::point_triangle)
    return closest_point_triangle(x);
  else
    return closest_edge_edge(x);
}

}  // namespace resilin
