#include "resilin/contact/ball_facets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "resilin/collision/pair_distance.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

/// Share of the activation distance that a ball may dip into a facet between nodes that it touches.
constexpr double harmless_dip = 0.05;
/// Conservative advancement ends when less than this share of a distance is still to go.
constexpr double advancement_tolerance = 0.05;
constexpr int most_advances = 100;

/// Depth of a ball in a facet, the corners of which it touches [m].
double dip(double radius, double longest_side, int dim) {
  const double to_corner = longest_side / (dim == 3 ? std::sqrt(3.0) : 2.0);
  if (!(to_corner < radius)) return std::numeric_limits<double>::infinity();
  return radius - std::sqrt((radius - to_corner) * (radius + to_corner));
}

/// Calls `visit(facet)` for the facets whose box is no farther from the centre than `reach` along each axis.
/// `bounds(vertex, axis)` is the least and the greatest coordinate of a vertex.
template <int dim, class Bounds, class Visit>
void for_near(std::span<const Index> facets, const std::vector<Index>& corners,
              const std::array<double, dim>& center, double reach, const Bounds& bounds, const Visit& visit) {
  for (const Index facet : facets) {
    const Index* const v = &corners[static_cast<std::size_t>(facet) * dim];
    bool is_near = true;
    for (int axis = 0; axis < dim && is_near; ++axis) {
      auto [low, high] = bounds(v[0], axis);
      for (int i = 1; i < dim; ++i) {
        const auto [least, greatest] = bounds(v[i], axis);
        low = std::min(low, least);
        high = std::max(high, greatest);
      }
      const double middle = center[static_cast<std::size_t>(axis)];
      is_near = low <= middle + reach && middle <= high + reach;
    }
    if (is_near) visit(facet);
  }
}

template <int dim>
double distance_to(std::span<const Index> corners, Index center, const VectorX& places) {
  std::array<Vector<dim>, most_pair_vertices> x;
  std::size_t count = 0;
  x[count++] = places.segment<dim>(Eigen::Index{center} * dim);
  for (const Index corner : corners) x[count++] = places.segment<dim>(Eigen::Index{corner} * dim);
  const PairKind kind = dim == 3 ? PairKind::point_triangle : PairKind::point_edge;
  return std::sqrt(squared_distance<dim>(kind, std::span<const Vector<dim>>(x).first(count)));
}

/// The corners of a facet as the centre sees them, and their ways.
struct MovingFacet {
  std::array<Vector3, 3> corners, ways;
  std::size_t count = 0;
};

template <int dim>
Vector3 nearest_point(const MovingFacet& facet, double t) {
  std::array<Vector<dim>, most_pair_vertices> x;
  x[0].setZero();
  for (std::size_t i = 0; i < facet.count; ++i)
    x[i + 1] = (facet.corners[i] + t * facet.ways[i]).template head<dim>();
  const PairKind kind = dim == 3 ? PairKind::point_triangle : PairKind::point_edge;
  const PairDistance<dim> pair =
      pair_distance<dim>(kind, std::span<const Vector<dim>>(x).first(facet.count + 1));
  Vector3 nearest = Vector3::Zero();
  nearest.template head<dim>() = -pair.distance * pair.normal;
  return nearest;
}

/// The time up to which a facet stays outside a ball around the origin with `end` [m] between them.
///
/// Conservative advancement as in collision_time.hpp: a plane across the shortest way parts the facet from
/// the ball until its first corner comes through.
template <int dim>
double time_to(const MovingFacet& facet, double radius, double start, double end) {
  double t = 0;
  for (int advance = 0; advance < most_advances; ++advance) {
    const Vector3 nearest = nearest_point<dim>(facet, t);
    const double distance = nearest.norm(), gap = distance - radius;
    if (!(gap > end + advancement_tolerance * (start - end))) return t;
    const Vector3 normal = nearest / distance;
    double free = 1 - t;
    for (std::size_t i = 0; i < facet.count; ++i) {
      const double speed = -normal.dot(facet.ways[i]);
      const double room = normal.dot(facet.corners[i] + t * facet.ways[i]) - radius - end;
      if (room < speed * free) free = room / speed;
    }
    if (!(free < 1 - t)) return 1;
    t += free;
  }
  return t;
}

}  // namespace

BallFacets::BallFacets(ContactSurface surface, const VectorX& rest_positions, double radius,
                       double activation_distance)
    : surface_(std::move(surface)), activation_distance_(activation_distance) {
  const CollisionSurface& parts = surface_.parts;
  const auto dim = static_cast<std::size_t>(parts.dim);
  const std::vector<Index>& all = all_corners();
  const VectorX rest = surface_.displacements(rest_positions);
  const auto body_of = [&](Index facet) {
    return static_cast<std::size_t>(parts.bodies[static_cast<std::size_t>(corners(facet)[0])]);
  };
  std::vector<double> longest(surface_.stiffness.size(), 0);
  const auto num_facets = static_cast<Index>(all.size() / dim);
  for (Index facet = 0; facet < num_facets; ++facet) {
    const std::span<const Index> v = corners(facet);
    for (std::size_t i = 0; i < dim && !surface_.is_obstacle(v[0]); ++i) {
      const Vector3 side =
          node_position(parts.dim, v[i], rest) - node_position(parts.dim, v[(i + 1) % dim], rest);
      longest[body_of(facet)] = std::max(longest[body_of(facet)], side.norm());
    }
  }
  for (Index facet = 0; facet < num_facets; ++facet)
    if (!surface_.is_obstacle(corners(facet)[0]) &&
        dip(radius, longest[body_of(facet)], parts.dim) > harmless_dip * activation_distance)
      facets_.push_back(facet);
}

const std::vector<Index>& BallFacets::all_corners() const {
  return surface_.parts.dim == 3 ? surface_.parts.triangles : surface_.parts.edges;
}

std::span<const Index> BallFacets::corners(Index facet) const {
  const auto dim = static_cast<std::size_t>(surface_.parts.dim);
  return std::span(all_corners()).subspan(dim * static_cast<std::size_t>(facet), dim);
}

VectorX BallFacets::places(const VectorX& x, const Ball& ball) const {
  VectorX all = surface_.displacements(x);
  all.tail(surface_.parts.dim) = ball.center.head(surface_.parts.dim);
  return all;
}

Vector3 BallFacets::at_center(const VectorX& of_vertices) const {
  return node_position(surface_.parts.dim, center(), of_vertices);
}

VectorX BallFacets::only_center(const Vector3& value) const {
  const int dim = surface_.parts.dim;
  VectorX all = VectorX::Zero(static_cast<Eigen::Index>(surface_.parts.num_vertices()) * dim);
  all.tail(dim) = value.head(dim);
  return all;
}

double BallFacets::distance_of(Index facet, const VectorX& places) const {
  return surface_.parts.dim == 3 ? distance_to<3>(corners(facet), center(), places)
                                 : distance_to<2>(corners(facet), center(), places);
}

template <int dim>
void BallFacets::add_near_in(const VectorX& places, double reach, std::vector<Candidate>& near) const {
  const auto number = static_cast<Index>(surface_.parts.points.size()) - 1;
  std::array<double, dim> middle;
  for (int axis = 0; axis < dim; ++axis) middle[static_cast<std::size_t>(axis)] = at_center(places)[axis];
  const auto bounds = [&](Index vertex, int axis) {
    const double place = places[Eigen::Index{vertex} * dim + axis];
    return std::pair(place, place);
  };
  for_near<dim>(facets_, all_corners(), middle, reach, bounds, [&](Index facet) {
    if (distance_of(facet, places) < reach) near.push_back({number, facet});
  });
}

void BallFacets::add_near(const VectorX& places, double reach, std::vector<Candidate>& near) const {
  surface_.parts.dim == 3 ? add_near_in<3>(places, reach, near) : add_near_in<2>(places, reach, near);
}

ContactTerms BallFacets::terms(std::vector<Candidate> near, double radius) const {
  const NearCandidates all{.points = std::vector<std::uint8_t>(near.size(), 1), .edges = {}};
  SurfaceCandidates candidates;
  (surface_.parts.dim == 3 ? candidates.point_triangle : candidates.point_edge) = std::move(near);
  ContactTerms list = contact_terms(surface_, candidates, all, activation_distance_);
  for (ContactTerm& term : list.terms) term.radius = radius;
  return list;
}

BallFacets::Contact BallFacets::contact(const VectorX& x, const Ball& ball) const {
  Contact found{.places = places(x, ball), .terms = {}};
  std::vector<Candidate> near;
  add_near(found.places, ball.radius + activation_distance_, near);
  if (!near.empty())
    found.terms = merged_terms(surface_, terms(std::move(near), ball.radius), found.places).terms;
  return found;
}

std::vector<PartForce> BallFacets::part_forces(const VectorX& x, const Ball& ball) const {
  const Contact near = contact(x, ball);
  std::vector<PartForce> forces = resilin::part_forces(set(near), near.places);
  for (PartForce& force : forces) force.distance -= ball.radius;
  return forces;
}

double BallFacets::difference(const VectorX& from, const VectorX& to, const Ball& ball) const {
  const VectorX start = places(from, ball), end = places(to, ball);
  const double reach = ball.radius + activation_distance_;
  std::vector<Candidate> near;
  add_near(start, reach, near);
  add_near(end, reach, near);
  std::ranges::sort(near);
  const auto repeated = std::ranges::unique(near);
  near.erase(repeated.begin(), repeated.end());
  if (near.empty()) return 0;
  return sum_of_differences({surface_, terms(std::move(near), ball.radius).terms}, start, end);
}

template <int dim>
double BallFacets::free_share_in(const VectorX& x, const VectorX& p, const Ball& ball,
                                 const Vector3& way_of_ball,
                                 const std::function<double(double)>& left) const {
  const VectorX start = places(x, ball), ways = surface_.displacements(p);
  const auto bounds = [&](Index vertex, int axis) {
    const Eigen::Index at = Eigen::Index{vertex} * dim + axis;
    const double from = start[at] - ball.center[axis], to = from + (ways[at] - way_of_ball[axis]);
    return std::pair(std::min(from, to), std::max(from, to));
  };
  double share = 1;
  const double reach = ball.radius + activation_distance_;
  for_near<dim>(facets_, all_corners(), {}, reach, bounds, [&](Index number) {
    MovingFacet facet;
    for (const Index corner : corners(number)) {
      facet.corners[facet.count] = node_position(dim, corner, start) - ball.center;
      facet.ways[facet.count++] = node_position(dim, corner, ways) - way_of_ball;
    }
    const double gap = distance_of(number, start) - ball.radius;
    share = std::min(share, time_to<dim>(facet, ball.radius, gap, left(gap)));
  });
  return share;
}

double BallFacets::free_share(const VectorX& x, const VectorX& p, const Ball& ball,
                              const Vector3& way_of_ball, const std::function<double(double)>& left) const {
  return surface_.parts.dim == 3 ? free_share_in<3>(x, p, ball, way_of_ball, left)
                                 : free_share_in<2>(x, p, ball, way_of_ball, left);
}

BallFacets::Nearest BallFacets::nearest(const VectorX& x, const Ball& ball) const {
  const VectorX here = places(x, ball);
  Nearest nearest;
  for (const Index facet : facets_) {
    const double distance = distance_of(facet, here) - ball.radius;
    if (!(distance < nearest.distance)) continue;
    nearest.distance = distance;
    std::ranges::copy(corners(facet), nearest.vertices.begin());
  }
  return nearest;
}

}  // namespace resilin
