#include "resilin/contact/contact_terms.hpp"

#include <algorithm>

#include "resilin/collision/collision_time.hpp"
#include "resilin/collision/edge_mollifier.hpp"

namespace resilin {
namespace {

/// Points feel surfaces from both sides, each for half.
constexpr double share_of_points = 0.5;
/// Edges keep each other apart where no point comes near; where points do, they add what is not meant to
/// bear, and bear little.
constexpr double share_of_edges = 0.05;

/// Whether candidates are near in one of the states.
std::vector<bool> are_near(const CandidateList& list, std::span<const std::vector<MovingPoint>> states,
                           double distance) {
  std::vector<bool> near(list.pairs.size(), false);
  std::vector<double> squares(list.pairs.size());
  for (const std::vector<MovingPoint>& state : states) {
    squared_distances(list, state, squares);
    for (std::size_t i = 0; i < near.size(); ++i)
      if (!(squares[i] >= distance * distance)) near[i] = true;
  }
  return near;
}

class TermList {
 public:
  TermList(const ContactSurface& surface, const SurfaceCandidates& candidates,
           std::span<const std::vector<MovingPoint>> states, double distance)
      : surface_(surface), candidates_(candidates), states_(states), distance_(distance) {}

  std::vector<ContactTerm> take() { return std::move(terms_); }

  void add_points(PairKind kind) {
    const CandidateList list = candidates_.list(kind, surface_.parts);
    const std::vector<bool> near = are_near(list, states_, distance_);
    for (std::size_t i = 0; i < list.pairs.size(); ++i) {
      if (near[i]) add_point(list, list.pairs[i]);
      const bool is_last = i + 1 == list.pairs.size() || list.pairs[i + 1][0] != list.pairs[i][0];
      if (is_last) add_corrections(surface_.parts.points[static_cast<std::size_t>(list.pairs[i][0])]);
    }
  }

  void add_edges() {
    const CandidateList list = candidates_.list(PairKind::edge_edge, surface_.parts);
    const std::vector<bool> near = are_near(list, states_, distance_);
    for (std::size_t i = 0; i < list.pairs.size(); ++i) {
      if (!near[i]) continue;
      const auto a = static_cast<std::size_t>(list.pairs[i][0]),
                 b = static_cast<std::size_t>(list.pairs[i][1]);
      const std::array<Index, most_pair_vertices> vertices = list.vertices(list.pairs[i]);
      const double area = 0.5 * (surface_.edge_areas[a] + surface_.edge_areas[b]);
      const double lengths = surface_.edge_lengths[a] * surface_.edge_lengths[b];
      terms_.push_back({list.kind, vertices, share_of_edges * stiffness(vertices[0], vertices[2]) * area,
                        EdgeMollifier::of_rest_lengths(lengths).threshold});
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
  double stiffness_of_point(Index p, Index q) const {
    return share_of_points * stiffness(p, q) * surface_.point_areas[static_cast<std::size_t>(p)];
  }

  void add_point(const CandidateList& list, const Candidate& pair) {
    const std::array<Index, most_pair_vertices> vertices = list.vertices(pair);
    terms_.push_back({list.kind, vertices, stiffness_of_point(vertices[0], vertices[1]), 0});
    for (const Index corner : terms_.back().used_vertices().subspan(1)) corners_.push_back(corner);
    if (list.kind != PairKind::point_triangle) return;
    for (int k = 0; k < 3; ++k)
      edges_.push_back(surface_.triangle_edges[static_cast<std::size_t>(3 * pair[1] + k)]);
  }

  /// What edges and vertices of the parts near a point count besides.
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
        terms_.push_back({PairKind::point_edge, {p, a, b, -1}, count * stiffness_of_point(p, a), 0});
    }
    for (const Index corner : corners_) {
      const int count = surface_.point_counts[static_cast<std::size_t>(corner)];
      if (count != 0)
        terms_.push_back(
            {PairKind::point_point, {p, corner, -1, -1}, count * stiffness_of_point(p, corner), 0});
    }
    edges_.clear();
    corners_.clear();
  }

  const ContactSurface& surface_;
  const SurfaceCandidates& candidates_;
  std::span<const std::vector<MovingPoint>> states_;
  double distance_;
  std::vector<ContactTerm> terms_;
  std::vector<Index> edges_, corners_;  ///< of the parts near the present point
};

}  // namespace

std::vector<ContactTerm> contact_terms(const ContactSurface& surface, const SurfaceCandidates& candidates,
                                       std::span<const VectorX* const> states, double activation_distance) {
  std::vector<std::vector<MovingPoint>> points;
  for (const VectorX* state : states)
    points.push_back(
        moving_points(surface.parts.dim, std::span(state->data(), static_cast<std::size_t>(state->size()))));
  TermList list(surface, candidates, points, activation_distance);
  list.add_points(surface.parts.dim == 3 ? PairKind::point_triangle : PairKind::point_edge);
  if (surface.parts.dim == 3) list.add_edges();
  return list.take();
}

}  // namespace resilin
