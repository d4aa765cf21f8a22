#include "resilin/contact/ball_facets.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/collision/pair_distance.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

/// Share of the activation distance that a ball may dip into a facet between nodes that it touches.
constexpr double harmless_dip = 0.05;
/// Conservative advancement ends when less than this share of a distance is still to go.
constexpr double advancement_tolerance = 0.05;
constexpr int most_advances = 100;

/// How far a ball dips into a facet whose corners it touches [m].
double dip(double radius, double longest_side, int dim) {
  const double to_corner = longest_side / (dim == 3 ? std::sqrt(3.0) : 2.0);
  if (!(to_corner < radius)) return std::numeric_limits<double>::infinity();
  return radius - std::sqrt((radius - to_corner) * (radius + to_corner));
}

struct Box {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;

  void add(const Vector3& x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  /// Whether they are no farther apart than a distance along each axis.
  bool is_near(const Box& other, double distance) const {
    return (low.array() <= other.high.array() + distance).all() &&
           (other.low.array() <= high.array() + distance).all();
  }
};

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
  const std::vector<Index>& all = parts.dim == 3 ? parts.triangles : parts.edges;
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

std::span<const Index> BallFacets::corners(Index facet) const {
  const CollisionSurface& parts = surface_.parts;
  const auto dim = static_cast<std::size_t>(parts.dim);
  return std::span(parts.dim == 3 ? parts.triangles : parts.edges)
      .subspan(dim * static_cast<std::size_t>(facet), dim);
}

VectorX BallFacets::places(const VectorX& x, const Ball& ball) const {
  return surface_.displacements(x) + only_center(ball.center);
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

void BallFacets::add_near(const VectorX& places, double reach, std::vector<Candidate>& near) const {
  const auto number = static_cast<Index>(surface_.parts.points.size()) - 1;
  Box around;
  around.add(at_center(places));
  for (const Index facet : facets_) {
    Box box;
    for (const Index corner : corners(facet)) box.add(node_position(surface_.parts.dim, corner, places));
    if (box.is_near(around, reach) && distance_of(facet, places) < reach) near.push_back({number, facet});
  }
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

double BallFacets::free_share(const VectorX& x, const VectorX& p, const Ball& ball,
                              const Vector3& way_of_ball, const std::function<double(double)>& left) const {
  const int dim = surface_.parts.dim;
  const VectorX start = places(x, ball), ways = surface_.displacements(p);
  Box around;
  around.add(Vector3::Zero());
  double share = 1;
  for (const Index number : facets_) {
    MovingFacet facet;
    Box box;
    for (const Index corner : corners(number)) {
      const Vector3 place = node_position(dim, corner, start) - ball.center;
      const Vector3 way = node_position(dim, corner, ways) - way_of_ball;
      box.add(place);
      box.add(place + way);
      facet.corners[facet.count] = place;
      facet.ways[facet.count++] = way;
    }
    if (!box.is_near(around, ball.radius + activation_distance_)) continue;
    const double gap = distance_of(number, start) - ball.radius, end = left(gap);
    share = std::min(share, dim == 3 ? time_to<3>(facet, ball.radius, gap, end)
                                     : time_to<2>(facet, ball.radius, gap, end));
  }
  return share;
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
