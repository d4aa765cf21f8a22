#include "resilin/contact/obstacle_contact.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

/// Share of its distance that a pair keeps while the obstacle goes on by itself.
constexpr double share_of_way = 0.5;
/// Share of the activation distance: an obstacle that is nearer waits until bodies have given way.
constexpr double share_to_wait_at = 0.2;
/// Ways that are tried between two times, each shorter, where chords are not parts of one another.
constexpr double next_part = 0.8, least_part = 1e-3;
constexpr int most_ways = 40;

BodyMeetings only_with_the_last(Index num_bodies) {
  BodyMeetings meetings(num_bodies);
  for (Index a = 0; a + 1 < num_bodies; ++a)
    for (Index b = 0; b <= a; ++b) meetings.set(a, b, false);
  return meetings;
}

}  // namespace

ObstacleContact::ObstacleContact(std::string name, const ContactSurface& surface, double activation_distance,
                                 const VectorX& positions)
    : SurfaceContact(std::move(name), surface,
                     only_with_the_last(static_cast<Index>(surface.stiffness.size())), activation_distance,
                     positions) {}

std::unique_ptr<Energy> ObstacleContact::begin_stage(const Stage&) const {
  auto own = std::make_unique<ObstacleContact>(*this);
  own->begin_memory();
  return own;
}

double ObstacleContact::free_way(const VectorX& x, double from, double to) const {
  const VectorX start = surface().places(x, {.time = from});
  return free_share(start, surface().places(x, {.time = to}) - start, share_of_way);
}

double ObstacleContact::least_delay(const VectorX& x, const Conditions& c) const {
  const ColliderMotion& motion = obstacle().motion;
  if (motion.keeps_place() || !(c.delay > 0)) return 0;
  const double last = motion.is_straight() ? motion.until : std::numeric_limits<double>::infinity();
  const double wanted = std::min(c.time, last);
  double reached = std::min(c.time - c.delay, last);
  for (int way = 0; way < most_ways; ++way) {
    double part = free_way(x, reached, wanted);
    if (part == 1) return 0;
    if (!motion.is_straight())
      while (part > least_part && free_way(x, reached, reached + part * (wanted - reached)) < 1)
        part *= next_part;
    if (!(part > least_part)) break;
    reached += part * (wanted - reached);
    if (!(smallest_gap(x, {.time = reached}).distance > share_to_wait_at * activation_distance())) break;
  }
  return c.time - reached;
}

std::optional<double> ObstacleContact::driven_work(const VectorX& from, const Conditions& before,
                                                   const VectorX& to, const Conditions& after) const {
  if (obstacle().motion.keeps_place()) return std::nullopt;
  const Eigen::Index first = Eigen::Index{surface().num_body_vertices()} * surface().parts.dim;
  const VectorX start = surface().places(from, before), end = surface().places(to, after);
  const VectorX way = (end - start).tail(end.size() - first);
  if (way.isZero(0)) return std::nullopt;
  const auto work = [&](const VectorX& x, const Conditions& c) {
    return vertex_gradient(x, c).tail(way.size()).dot(way);
  };
  return std::max({work(from, before), work(to, after), value(to, after) - value(to, before)});
}

std::vector<EnergyParameter> ObstacleContact::parameters() const {
  std::vector<EnergyParameter> all = SurfaceContact::parameters();
  for (const std::string_view name : ColliderMotion::parameter_names) all.push_back({name, 3});
  return all;
}

void ObstacleContact::add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w,
                                           const Conditions& c, VectorX& slopes) const {
  if (name == "barrier_stiffness") return SurfaceContact::add_parameter_slopes(name, x, w, c, slopes);
  const VectorX forces = vertex_hessian_times(x, c, surface().displacements(w));
  const int dim = surface().parts.dim;
  Vector3 by_shift = Vector3::Zero();
  for (auto v = surface().num_body_vertices(); v < static_cast<Index>(surface().parts.num_vertices()); ++v)
    by_shift += node_position(dim, v, forces);
  slopes += obstacle().motion.slopes_by(name, c.time - c.delay).shift.transpose() * by_shift;
}

void ObstacleContact::add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                                           const Conditions& c, VectorX& gradient) const {
  if (name == "barrier_stiffness") return SurfaceContact::add_parameter_forces(name, x, change, c, gradient);
  const int dim = surface().parts.dim;
  const Vector3 shift = obstacle().motion.slopes_by(name, c.time - c.delay).shift * change;
  VectorX ways = VectorX::Zero(static_cast<Eigen::Index>(surface().parts.num_vertices()) * dim);
  for (auto v = surface().num_body_vertices(); v < static_cast<Index>(surface().parts.num_vertices()); ++v)
    ways.segment(Eigen::Index{v} * dim, dim) = shift.head(dim);
  surface().add_to_nodes(vertex_hessian_times(x, c, ways), gradient);
}

std::optional<Reaction> ObstacleContact::reaction(const VectorX& x, const Conditions& c) const {
  const VectorX gradient = vertex_gradient(x, c), places = surface().places(x, c);
  const int dim = surface().parts.dim;
  Reaction sum;
  for (auto v = surface().num_body_vertices(); v < static_cast<Index>(surface().parts.num_vertices()); ++v) {
    const Vector3 force = node_position(dim, v, gradient);
    sum.force += force;
    sum.torque += node_position(dim, v, places).cross(force);
  }
  return sum;
}

void ObstacleContact::add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const {
  const VectorX gradient = vertex_gradient(x, {});
  for (Index v = 0; v < surface().num_body_vertices(); ++v) {
    const Vector3 force = node_position(surface().parts.dim, v, gradient);
    if (force.isZero(0)) continue;
    held.push_back({surface().vertices.weighted_nodes(v), force.normalized()});
  }
}

}  // namespace resilin
