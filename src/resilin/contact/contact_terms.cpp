#include "resilin/contact/contact_terms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/collision/collision_time.hpp"
#include "resilin/collision/edge_mollifier.hpp"
#include "resilin/collision/moving_point.hpp"

namespace resilin {
namespace {

/// Points feel surfaces from both sides, each for half.
constexpr double share_of_points = 0.5;
/// Share of the areas beside two edges that their pair bears.
constexpr double share_of_edges = 0.05;
/// Part of the activation distance at which edges within flat faces feel each other: bodies that press each
/// other through points are farther apart, and only where bodies bend so that no point comes near do edges
/// bear. Those that stick out do so from farther away.
constexpr double reach_of_flat_edges = 0.25;
/// The sharpness of both edges from which that is the whole distance: that of a box.
constexpr double sharp = 0.25;
/// Weight of an obstacle's points by their own areas: a body's points bear it, each for its whole area.
constexpr double share_of_flat_points = 0.02;

/// Squared distances of candidates [m^2].
std::vector<double> squares_of(const CandidateList& list, const std::vector<MovingPoint>& points) {
  std::vector<double> squares(list.pairs.size());
  squared_distances(list, points, squares);
  return squares;
}

std::vector<MovingPoint> points_at(const ContactSurface& surface, const VectorX& places) {
  return moving_points(surface.parts.dim, std::span(places.data(), static_cast<std::size_t>(places.size())));
}

constexpr PairKind kind_of_points(int dim) {
  return dim == 3 ? PairKind::point_triangle : PairKind::point_edge;
}

/// Share of the activation distance from which a pair of edges feel each other.
double reach_of_edges(const ContactSurface& surface, const Candidate& pair) {
  const auto a = static_cast<std::size_t>(pair[0]), b = static_cast<std::size_t>(pair[1]);
  const auto is_obstacle = [&](std::size_t edge) {
    return surface.is_obstacle(surface.parts.edges[2 * edge]);
  };
  if (is_obstacle(a) || is_obstacle(b)) return 1;
  const double sharpness = std::sqrt(surface.sharpness.edges[a] * surface.sharpness.edges[b]);
  return reach_of_flat_edges + (1 - reach_of_flat_edges) * std::min(1.0, sharpness / sharp);
}

class TermList {
 public:
  TermList(const ContactSurface& surface, const SurfaceCandidates& candidates, const NearCandidates& near,
           double activation_distance)
      : surface_(surface), candidates_(candidates), near_(near), distance_(activation_distance) {}

  ContactTerms take() { return std::move(list_); }

  void add_points(PairKind kind) {
    const CandidateList list = candidates_.list(kind, surface_.parts);
    for (std::size_t i = 0; i < list.pairs.size(); ++i) {
      if (near_.points[i] != 0) add_point(list, list.pairs[i]);
      const bool is_last = i + 1 == list.pairs.size() || list.pairs[i + 1][0] != list.pairs[i][0];
      if (!is_last || terms_.size() == list_.point_begin.back()) continue;
      add_corrections(surface_.parts.points[static_cast<std::size_t>(list.pairs[i][0])]);
      list_.point_begin.push_back(terms_.size());
    }
  }

  void add_edges() {
    const CandidateList list = candidates_.list(PairKind::edge_edge, surface_.parts);
    for (std::size_t i = 0; i < list.pairs.size(); ++i) {
      if (near_.edges[i] == 0) continue;
      const auto a = static_cast<std::size_t>(list.pairs[i][0]),
                 b = static_cast<std::size_t>(list.pairs[i][1]);
      const std::array<Index, most_pair_vertices> vertices = list.vertices(list.pairs[i]);
      const double area = bearing_area_of_edges(a, b, vertices);
      if (area == 0) continue;
      const double lengths = surface_.edge_lengths[a] * surface_.edge_lengths[b];
      terms_.push_back({list.kind, vertices, stiffness(vertices[0], vertices[2]) * area,
                        EdgeMollifier::of_rest_lengths(lengths).threshold,
                        distance_ * reach_of_edges(surface_, list.pairs[i])});
    }
  }

 private:
  /// [Pa]: two layers upon each other yield where the softer does.
  double stiffness(Index a, Index b) const {
    const auto kappa = [&](Index v) {
      return surface_.stiffness[static_cast<std::size_t>(surface_.parts.bodies[static_cast<std::size_t>(v)])];
    };
    return std::min(kappa(a), kappa(b));
  }
  double stiffness_of_point(Index p, Index q) const { return stiffness(p, q) * bearing_area(p, q); }

  /// Area that point p bears of the part of q. How an obstacle is cut into parts says nothing of a body that
  /// meets it: the body's points bear, and the obstacle's own as far as they stick out.
  double bearing_area(Index p, Index q) const {
    const auto point = static_cast<std::size_t>(p);
    const double own = surface_.point_areas[point];
    if (surface_.is_obstacle(q)) return own;
    if (!surface_.is_obstacle(p)) return share_of_points * own;
    const double mean = surface_.mean_area_beside(p, surface_.parts.bodies[static_cast<std::size_t>(q)]);
    return share_of_flat_points * std::min(own, mean) + surface_.sharpness.points[point] * mean;
  }
  double bearing_area_of_edges(std::size_t a, std::size_t b,
                               const std::array<Index, most_pair_vertices>& vertices) const {
    if (surface_.is_obstacle(vertices[0])) return surface_.sharpness.edges[a] * surface_.edge_areas[b];
    if (surface_.is_obstacle(vertices[2])) return surface_.sharpness.edges[b] * surface_.edge_areas[a];
    return share_of_edges * 0.5 * (surface_.edge_areas[a] + surface_.edge_areas[b]);
  }

  void add_point(const CandidateList& list, const Candidate& pair) {
    const std::array<Index, most_pair_vertices> vertices = list.vertices(pair);
    const double bearing = stiffness_of_point(vertices[0], vertices[1]);
    if (bearing == 0) return;
    terms_.push_back({list.kind, vertices, bearing, 0, distance_});
    for (const Index corner : terms_.back().used_vertices().subspan(1)) corners_.push_back(corner);
    if (list.kind != PairKind::point_triangle) return;
    for (int k = 0; k < 3; ++k) {
      const Index edge = surface_.triangle_edges[static_cast<std::size_t>(3 * pair[1] + k)];
      if (edge >= 0) edges_.push_back(edge);
    }
  }

  /// Adds the corrections of edges and vertices of the parts near a point.
  void add_corrections(Index p) {
    for (std::vector<Index>* list : {&edges_, &corners_}) {
      std::ranges::sort(*list);
      const auto repeated = std::ranges::unique(*list);
      list->erase(repeated.begin(), repeated.end());
    }
    for (const Index edge : edges_) {
      const int count = surface_.edge_counts[static_cast<std::size_t>(edge)];
      const Index a = surface_.parts.edges[static_cast<std::size_t>(2 * edge)];
      const Index b = surface_.parts.edges[static_cast<std::size_t>(2 * edge + 1)];
      if (count != 0)
        terms_.push_back(
            {PairKind::point_edge, {p, a, b, -1}, count * stiffness_of_point(p, a), 0, distance_});
    }
    for (const Index corner : corners_) {
      const int count = surface_.point_counts[static_cast<std::size_t>(corner)];
      if (count != 0)
        terms_.push_back({PairKind::point_point,
                          {p, corner, -1, -1},
                          count * stiffness_of_point(p, corner),
                          0,
                          distance_});
    }
    edges_.clear();
    corners_.clear();
  }

  const ContactSurface& surface_;
  const SurfaceCandidates& candidates_;
  const NearCandidates& near_;
  double distance_;
  ContactTerms list_;
  std::vector<ContactTerm>& terms_ = list_.terms;
  std::vector<Index> edges_, corners_;  ///< edges and corners of the parts near the present point
};

}  // namespace

NearCandidates& NearCandidates::operator|=(const NearCandidates& others) {
  for (std::size_t i = 0; i < points.size(); ++i) points[i] |= others.points[i];
  for (std::size_t i = 0; i < edges.size(); ++i) edges[i] |= others.edges[i];
  return *this;
}

NearCandidates near_candidates(const ContactSurface& surface, const SurfaceCandidates& candidates,
                               const VectorX& places, double activation_distance) {
  const CandidateList points = candidates.list(kind_of_points(surface.parts.dim), surface.parts),
                      edges = candidates.list(PairKind::edge_edge, surface.parts);
  NearCandidates near{.points = std::vector<std::uint8_t>(points.pairs.size()),
                      .edges = std::vector<std::uint8_t>(edges.pairs.size())};
  if (points.pairs.empty() && edges.pairs.empty()) return near;
  const std::vector<MovingPoint> at = points_at(surface, places);
  const double square = activation_distance * activation_distance;
  const std::vector<double> of_points = squares_of(points, at), of_edges = squares_of(edges, at);
  for (std::size_t i = 0; i < of_points.size(); ++i) near.points[i] = !(of_points[i] >= square);
  for (std::size_t i = 0; i < of_edges.size(); ++i) {
    if (of_edges[i] >= square) continue;
    const double reach = reach_of_edges(surface, edges.pairs[i]);
    near.edges[i] = !(of_edges[i] >= reach * reach * square);
  }
  return near;
}

ContactTerms contact_terms(const ContactSurface& surface, const SurfaceCandidates& candidates,
                           const NearCandidates& near, double activation_distance) {
  TermList list(surface, candidates, near, activation_distance);
  list.add_points(kind_of_points(surface.parts.dim));
  if (surface.parts.dim == 3) list.add_edges();
  return list.take();
}

// A term is linear in min(kappa_a, kappa_b).
SofterBodies softer_bodies(const ContactSurface& surface, const ContactTerm& term) {
  const auto body_of = [&](std::size_t k) {
    return surface.parts.bodies[static_cast<std::size_t>(term.vertices[k])];
  };
  const Index a = body_of(0), b = body_of(static_cast<std::size_t>(num_first(term.kind)));
  const double kappa_a = surface.stiffness[static_cast<std::size_t>(a)],
               kappa_b = surface.stiffness[static_cast<std::size_t>(b)];
  if (kappa_a < kappa_b) return {{a, b}, {1 / kappa_a, 0}};
  if (kappa_b < kappa_a) return {{a, b}, {0, 1 / kappa_b}};
  return {{a, b}, {0.5 / kappa_a, 0.5 / kappa_b}};
}

std::vector<ContactTerm> terms_of_change(const ContactTerms& all, const ContactTerms& merged_before,
                                         const ContactTerms& merged_after) {
  std::vector<ContactTerm> terms;
  for (std::size_t point = 0; point < all.num_points(); ++point) {
    const auto before = merged_before.of_point(point), after = merged_after.of_point(point);
    const auto some = std::ranges::equal(before, after) ? before : all.of_point(point);
    terms.insert(terms.end(), some.begin(), some.end());
  }
  const auto edges = all.of_edges();
  terms.insert(terms.end(), edges.begin(), edges.end());
  return terms;
}

NearestCandidate nearest_candidate(const ContactSurface& surface, const SurfaceCandidates& candidates,
                                   const VectorX& places) {
  NearestCandidate nearest{.distance = std::numeric_limits<double>::infinity()};
  const std::vector<MovingPoint> at = points_at(surface, places);
  for (const PairKind kind : {kind_of_points(surface.parts.dim), PairKind::edge_edge}) {
    const CandidateList list = candidates.list(kind, surface.parts);
    const std::vector<double> squares = squares_of(list, at);
    for (std::size_t i = 0; i < squares.size(); ++i)
      if (std::sqrt(squares[i]) < nearest.distance)
        nearest = {std::sqrt(squares[i]), kind, list.vertices(list.pairs[i])};
  }
  return nearest;
}

}  // namespace resilin
