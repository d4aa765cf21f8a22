#include "resilin/contact/collider_barrier.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "resilin/contact/cross_matrix.hpp"
#include "resilin/contact/friction_slopes.hpp"
#include "resilin/contact/pressing_forces.hpp"
#include "resilin/core/dense.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

/// Share of the distance that a step may use up.
constexpr double largest_loss = 0.9;

/// Shares of the way of a collider that turns or follows a function of time: the least tried, and how much
/// less is tried each time.
constexpr double least_part = 1e-9, next_part = 0.7;

/// The symmetric matrix with its negative eigenvalues dealt with as asked.
Eigen::Matrix3d projected(const Eigen::Matrix3d& matrix, Projection projection) {
  if (projection == Projection::none || matrix.isZero(0)) return matrix;
  const dense::Eigenpairs3 eigen = dense::symmetric_eigenpairs3(matrix);
  Vector3 values = eigen.values;
  for (double& value : values)
    if (value < 0) value = projection == Projection::clamp ? 0 : -value;
  return eigen.vectors * values.asDiagonal() * eigen.vectors.transpose();
}

/// The nodes that the closest point of a body follows, each once; a ball's centre comes first in the pair.
std::vector<WeightedNode> nodes_of_body(const ContactSurface& surface, const PartForce& force) {
  std::vector<WeightedNode> nodes;
  for (std::size_t i = 1; i < static_cast<std::size_t>(num_vertices(force.kind)); ++i)
    if (force.weights[i] != 0)
      surface.vertices.for_each_node(force.vertices[i], [&](Index node, double share) {
        add_weight(node, -share * force.weights[i], nodes);
      });
  return nodes;
}

}  // namespace

ColliderBarrier::ColliderBarrier(std::string name, int dim, std::shared_ptr<const ColliderShape> shape,
                                 ContactPoints points, double activation_distance, ColliderMotion motion,
                                 double friction)
    : name_(std::move(name)),
      dim_(dim),
      shape_(std::move(shape)),
      points_(std::move(points)),
      barrier_{activation_distance},
      motion_(std::move(motion)),
      friction_(friction) {}

void ColliderBarrier::set_shape(std::shared_ptr<const ColliderShape> shape) {
  shape_ = std::move(shape);
  offset_.setZero();
}

RigidPlace ColliderBarrier::rigid_place(const Conditions& c) const {
  RigidPlace place = motion_.place(c.time - c.delay);
  place.shift += offset_;
  return place;
}

template <class Visit>
void ColliderBarrier::for_each_near(const VectorX& x, const Conditions& c, const Visit& visit) const {
  if (!is_active_) return;
  const RigidPlace place = rigid_place(c);
  for (Index point = 0; point < points_.size(); ++point) {
    const Vector3 y = place.inverse(at(point, x));
    const double d = shape_->distance(y);
    if (!(d >= barrier_.activation_distance)) visit(point, y, d);
  }
}

template <class Visit>
void ColliderBarrier::for_near_facets(const VectorX& x, const Conditions& c, const Visit& visit) const {
  if (!is_active_ || !facets_) return;
  const BallFacets::Contact contact = facets_->contact(x, ball(c));
  if (!contact.terms.empty()) visit(contact, facets_->set(contact));
}

double ColliderBarrier::value(const VectorX& x, const Conditions& c) const {
  double sum = 0;
  for_each_near(x, c,
                [&](Index point, const Vector3&, double d) { sum += stiffness(point) * barrier_.value(d); });
  for_near_facets(x, c, [&](const BallFacets::Contact& contact, const TermSet& set) {
    sum += sum_of_values(set, contact.places);
  });
  return c.weight * sum;
}

double ColliderBarrier::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  if (!is_active_) return 0;
  const RigidPlace place = rigid_place(c);
  double sum = 0;
  for (Index point = 0; point < points_.size(); ++point) {
    const Vector3 y = place.inverse(at(point, from));
    const Vector3 end = place.inverse(at(point, to));
    const double d = shape_->distance(y), change = shape_->distance_change(y, end);
    if (d >= activation_distance() && d + change >= activation_distance()) continue;
    sum += stiffness(point) * barrier_.difference(d, change);
  }
  if (facets_) sum += facets_->difference(from, to, ball(c));
  return c.weight * sum;
}

void ColliderBarrier::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  const RigidPlace place = rigid_place(c);
  for_each_near(x, c, [&](Index point, const Vector3& y, double d) {
    const Vector3 slope = c.weight * stiffness(point) * barrier_.slope(d) * place.turned(shape_->normal(y));
    points_.places.add_to_nodes(dim_, point, slope, gradient);
  });
  for_near_facets(x, c, [&](const BallFacets::Contact& contact, const TermSet& set) {
    facets_->surface().add_to_nodes(c.weight * sum_of_gradients(set, contact.places), gradient);
  });
}

void ColliderBarrier::add_gradient_magnitude(const VectorX& x, const Conditions& c,
                                             VectorX& magnitude) const {
  const RigidPlace place = rigid_place(c);
  for_each_near(x, c, [&](Index point, const Vector3& y, double d) {
    const Vector3 slope = c.weight * stiffness(point) * barrier_.slope(d) * place.turned(shape_->normal(y));
    points_.places.add_magnitude_to_nodes(dim_, point, slope.cwiseAbs(), magnitude);
  });
  for_near_facets(x, c, [&](const BallFacets::Contact& contact, const TermSet& set) {
    const VectorX magnitudes = sum_of_gradients(set, contact.places, GradientParts::magnitudes);
    facets_->surface().add_magnitudes_to_nodes(c.weight * magnitudes, magnitude);
  });
}

// d2/dx2 kappa A b(d(x)) = kappa A (b'' n n^T + b' Hess d); the first term is never negative.
Eigen::Matrix3d ColliderBarrier::curvature_at(Index point, const Vector3& y, double d,
                                              const RigidPlace& place, Projection projection) const {
  const Vector3 n = shape_->normal(y);
  const Eigen::Matrix3d block =
      stiffness(point) * (barrier_.curvature(d) * n * n.transpose() +
                          projected(barrier_.slope(d) * shape_->curvature(y), projection));
  return place.turn ? Eigen::Matrix3d(*place.turn * block * place.turn->transpose()) : block;
}

void ColliderBarrier::add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                                  BlockMatrix& hessian) const {
  const RigidPlace place = rigid_place(c);
  for_each_near(x, c, [&](Index point, const Vector3& y, double d) {
    const Eigen::Matrix3d block = c.weight * curvature_at(point, y, d, place, projection);
    points_.places.for_each_pair_of_nodes(point, point, [&](Index a, Index b, double share) {
      if (a > b) return;  // the other half of the matrix
      std::array<double, 9> values{};
      for (int i = 0; i < dim_; ++i)
        for (int j = 0; j < dim_; ++j) values[static_cast<std::size_t>(i * dim_ + j)] = share * block(i, j);
      hessian.add_block(a, b, values.data());
    });
  });
  for_near_facets(x, c, [&](const BallFacets::Contact& contact, const TermSet& set) {
    add_node_hessian(set, contact.places, c.weight, projection, hessian);
  });
}

std::vector<EnergyParameter> ColliderBarrier::parameters() const {
  std::vector<EnergyParameter> all = {{"barrier_stiffness", num_stiffnesses()}};
  for (const std::string_view name : ColliderMotion::parameter_names) all.push_back({name, 3});
  return all;
}

// The energy is linear in the stiffness of each point; what the collider goes, points do not go towards it.
void ColliderBarrier::add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w,
                                           const Conditions& c, VectorX& slopes) const {
  const RigidPlace place = rigid_place(c);
  if (name == "barrier_stiffness") {
    for_each_near(x, c, [&](Index point, const Vector3& y, double d) {
      slopes[point] += c.weight * barrier_.slope(d) * place.turned(shape_->normal(y)).dot(at(point, w));
    });
    for_near_facets(x, c, [&](const BallFacets::Contact& contact, const TermSet& set) {
      const std::vector<double> along =
          slopes_along(set, contact.places, facets_->surface().displacements(w));
      for (std::size_t k = 0; k < along.size(); ++k) {
        const SofterBodies softer = softer_bodies(set.surface, set.terms[k]);
        for (std::size_t side = 0; side < 2; ++side)
          slopes[points_.size() + softer.bodies[side]] += c.weight * softer.shares[side] * along[k];
      }
    });
    return;
  }
  Vector3 by_shift = Vector3::Zero();
  for_each_near(x, c, [&](Index point, const Vector3& y, double d) {
    by_shift -= c.weight * curvature_at(point, y, d, place, Projection::none) * at(point, w);
  });
  for_near_facets(x, c, [&](const BallFacets::Contact& contact, const TermSet& set) {
    const VectorX ways = facets_->surface().displacements(w);
    by_shift += c.weight * facets_->at_center(hessian_times(set, contact.places, ways));
  });
  slopes += motion_.slopes_by(name, c.time - c.delay).shift.transpose() * by_shift;
}

void ColliderBarrier::add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                                           const Conditions& c, VectorX& gradient) const {
  const RigidPlace place = rigid_place(c);
  if (name == "barrier_stiffness") {
    for_each_near(x, c, [&](Index point, const Vector3& y, double d) {
      const Vector3 slope = c.weight * change[point] * barrier_.slope(d) * place.turned(shape_->normal(y));
      points_.places.add_to_nodes(dim_, point, slope, gradient);
    });
    for_near_facets(x, c, [&](const BallFacets::Contact& contact, const TermSet& set) {
      std::vector<ContactTerm> changes = contact.terms;
      for (ContactTerm& term : changes) {
        const SofterBodies softer = softer_bodies(set.surface, term);
        term.stiffness *= softer.shares[0] * change[points_.size() + softer.bodies[0]] +
                          softer.shares[1] * change[points_.size() + softer.bodies[1]];
      }
      const VectorX forces = sum_of_gradients({set.surface, changes}, contact.places);
      facets_->surface().add_to_nodes(c.weight * forces, gradient);
    });
    return;
  }
  const Vector3 shift = motion_.slopes_by(name, c.time - c.delay).shift * change;
  for_each_near(x, c, [&](Index point, const Vector3& y, double d) {
    const Vector3 slope = -c.weight * (curvature_at(point, y, d, place, Projection::none) * shift);
    points_.places.add_to_nodes(dim_, point, slope, gradient);
  });
  for_near_facets(x, c, [&](const BallFacets::Contact& contact, const TermSet& set) {
    const VectorX forces = hessian_times(set, contact.places, facets_->only_center(shift));
    facets_->surface().add_to_nodes(c.weight * forces, gradient);
  });
}

double ColliderBarrier::max_step(const VectorX& x, const VectorX& p, const Conditions& c) const {
  if (!is_active_) return 1;
  const RigidPlace place = rigid_place(c);
  double step = 1;
  for (Index point = 0; point < points_.size(); ++point) {
    const Vector3 y = place.inverse(at(point, x));
    const Vector3 way = place.turned_back(at(point, p));
    const double left = (1 - largest_loss) * shape_->distance(y);
    step = std::min(step, shape_->time_of_approach(y, way, left));
  }
  if (!facets_) return step;
  const auto left = [](double distance) { return (1 - largest_loss) * distance; };
  return std::min(step, facets_->free_share(x, p, ball(c), Vector3::Zero(), left));
}

std::optional<Reaction> ColliderBarrier::reaction(const VectorX& x, const Conditions& c) const {
  const RigidPlace place = rigid_place(c);
  Reaction sum;
  for_each_near(x, c, [&](Index point, const Vector3& y, double d) {
    const Vector3 force = -stiffness(point) * barrier_.slope(d) * place.turned(shape_->normal(y));
    sum.force += force;
    sum.torque += at(point, x).cross(force);
  });
  for_near_facets(x, c, [&](const BallFacets::Contact& contact, const TermSet& set) {
    const Vector3 force = facets_->at_center(sum_of_gradients(set, contact.places));
    sum.force += force;
    sum.torque += ball(c).center.cross(force);  // all of it acts along lines through the centre
  });
  return sum;
}

void ColliderBarrier::add_friction_contacts(const VectorX& x, const VectorX& /*start*/, const Conditions& c,
                                            FrictionContacts& contacts) const {
  if (!(friction_ > 0)) return;
  const RigidPlace place = rigid_place(c);
  for_each_near(x, c, [&](Index point, const Vector3& y, double d) {
    if (d <= 0) return;
    contacts.add({.normal = place.turned(shape_->normal(y)),
                  .limit = -friction_ * stiffness(point) * barrier_.slope(d),
                  .velocity = motion_.velocity_at(at(point, x), c.time - c.delay)},
                 points_.places.weighted_nodes(point));
  });
  add_facet_friction(x, c, contacts);
}

void ColliderBarrier::add_facet_friction(const VectorX& x, const Conditions& c,
                                         FrictionContacts& contacts) const {
  for_near_facets(x, c, [&](const BallFacets::Contact& contact, const TermSet& set) {
    for (const PartForce& force : pressing_forces(part_forces(set, contact.places))) {
      const Vector3 touched = ball(c).center - force.distance * force.normal;
      contacts.add({.normal = -force.normal,
                    .limit = friction_ * force.force,
                    .velocity = motion_.velocity_at(touched, c.time - c.delay)},
                   nodes_of_body(set.surface, force));
    }
  });
}

void ColliderBarrier::add_friction_slopes(const VectorX& x, const VectorX& start, const Conditions& c,
                                          std::vector<FrictionContactSlopes>& slopes) const {
  FrictionContacts contacts;
  add_friction_contacts(x, start, c, contacts);
  const RigidPlace place = rigid_place(c);
  const Eigen::Matrix3d turning = cross_matrix(motion_.spin(c.time - c.delay));
  std::size_t next = 0;
  for_each_near(x, c, [&](Index point, const Vector3& y, double d) {
    if (next == contacts.size() || d <= 0) return;
    const FrictionContact& contact = contacts[next++].contact;
    FrictionContactSlopes of{.contact = contact,
                             .coefficient = 0,
                             .mu = friction_,
                             .share_of_rate = 1,
                             .vertices = {{1, points_.places.weighted_nodes(point)}},
                             .places = {},
                             .stiffness = {{point, -friction_ * barrier_.slope(d)}}};
    FrictionContactSlopes::Place here{.nodes = of.vertices[0].nodes};
    here.limit = -friction_ * stiffness(point) * barrier_.curvature(d) * contact.normal;
    here.normal = shape_->curvature(y);
    if (place.turn) here.normal = *place.turn * here.normal * place.turn->transpose();
    FrictionContactSlopes::Place there{.limit = -here.limit, .normal = -here.normal};
    here.velocity = turning;
    of.places = {std::move(here), std::move(there)};
    slopes.push_back(std::move(of));
  });
  if (facets_) add_facet_friction_slopes(x, c, slopes);
}

// Forces of parts are those on the centre: the body's vertices have the weights s_i = -w_i, its normal is -n,
// and its touched point sum_i s_i x_i.
void ColliderBarrier::add_facet_friction_slopes(const VectorX& x, const Conditions& c,
                                                std::vector<FrictionContactSlopes>& slopes) const {
  FrictionContacts contacts;
  add_facet_friction(x, c, contacts);
  const Eigen::Matrix3d turning = cross_matrix(motion_.spin(c.time - c.delay));
  for_near_facets(x, c, [&](const BallFacets::Contact& contact, const TermSet& set) {
    const std::vector<PartForce> forces = part_forces(set, contact.places);
    const std::vector<PartForceSlopes> of_forces = part_force_slopes(set, contact.places);
    std::size_t next = 0;
    for (const PressingForce& pressing : pressing_slopes(forces)) {
      if (!(friction_ * pressing.force > 0)) continue;
      const PartForce& part = forces[pressing.part];
      const PartForceSlopes& of_part = of_forces[pressing.part];
      const auto count = static_cast<std::size_t>(num_vertices(part.kind));
      FrictionContactSlopes of{.contact = contacts[next++].contact,
                               .coefficient = 0,
                               .mu = friction_,
                               .share_of_rate = 1,
                               .vertices = {},
                               .places = {},
                               .stiffness = {}};
      for (std::size_t i = 1; i < count; ++i)
        of.vertices.push_back({-part.weights[i], set.surface.vertices.weighted_nodes(part.vertices[i])});
      std::map<Index, std::size_t> numbers;  // places, each once
      const auto place_of = [&](Index vertex) -> FrictionContactSlopes::Place& {
        const auto [found, is_new] = numbers.try_emplace(vertex, of.places.size());
        if (is_new) of.places.push_back({.nodes = set.surface.vertices.weighted_nodes(vertex)});
        return of.places[found->second];
      };
      for (std::size_t k = 0; k < count; ++k) {
        FrictionContactSlopes::Place& place = place_of(part.vertices[k]);
        place.normal = -of_part.normal[k];
        const double own = k == 0 ? 0 : -part.weights[k];
        Eigen::Matrix3d of_touched = own * Eigen::Matrix3d::Identity();
        for (std::size_t i = 1; i < count; ++i) {
          place.weights.emplace_back(-of_part.weights[i][k]);
          of_touched -=
              node_position(dim_, part.vertices[i], contact.places) * of_part.weights[i][k].transpose();
        }
        place.velocity = turning * of_touched;
      }
      for (const auto& [number, slope] : pressing.slopes) {
        const PartForceSlopes& other = of_forces[number];
        const auto corners = static_cast<std::size_t>(num_vertices(forces[number].kind));
        for (std::size_t k = 0; k < corners; ++k)
          place_of(forces[number].vertices[k]).limit += friction_ * slope * other.force[k];
        const SofterBodies softer = softer_bodies(set.surface, set.terms[other.term]);
        for (std::size_t side = 0; side < 2; ++side)
          of.stiffness.emplace_back(points_.size() + softer.bodies[side],
                                    friction_ * slope * forces[number].force * softer.shares[side]);
      }
      slopes.push_back(std::move(of));
    }
  });
}

void ColliderBarrier::add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const {
  const RigidPlace place = rigid_place({});
  for_each_near(x, {}, [&](Index point, const Vector3& y, double) {
    held.push_back({points_.places.weighted_nodes(point), place.turned(shape_->normal(y))});
  });
  for_near_facets(x, {}, [&](const BallFacets::Contact& contact, const TermSet& set) {
    for (const PartForce& force : part_forces(set, contact.places))
      held.push_back({nodes_of_body(set.surface, force), force.normal});
  });
}

ColliderBarrier::Nearest ColliderBarrier::nearest(const VectorX& x, const Conditions& c) const {
  const RigidPlace place = rigid_place(c);
  Nearest nearest;
  for (Index point = 0; point < points_.size(); ++point) {
    const double d = shape_->distance(place.inverse(at(point, x)));
    if (d < nearest.distance) nearest = {d, point};
  }
  return nearest;
}

double ColliderBarrier::gap(const VectorX& x, const Conditions& c) const {
  const double of_points = nearest(x, c).distance;
  return facets_ ? std::min(of_points, facets_->nearest(x, ball(c)).distance) : of_points;
}

double ColliderBarrier::distance_left(double distance, double share) const {
  return std::min(share * activation_distance(), 0.5 * distance);
}

double ColliderBarrier::largest_motion(const VectorX& x, const Vector3& motion, const Conditions& c,
                                       double share) const {
  if (!is_active_) return 1;
  const RigidPlace place = rigid_place(c);
  const Vector3 way = -place.turned_back(motion);
  double part = 1;
  for (Index point = 0; point < points_.size(); ++point) {
    const Vector3 y = place.inverse(at(point, x));
    part = std::min(part, shape_->time_of_approach(y, way, distance_left(shape_->distance(y), share)));
  }
  return std::min(part, free_share_of_facets(x, motion, c, share));
}

double ColliderBarrier::free_share_of_facets(const VectorX& x, const Vector3& motion, const Conditions& c,
                                             double share) const {
  if (!facets_) return 1;
  const auto left = [&](double distance) { return distance_left(distance, share); };
  return facets_->free_share(x, VectorX::Zero(x.size()), ball(c), motion, left);
}

// Each point's force times the way of what it touches.
std::optional<double> ColliderBarrier::driven_work(const VectorX& from, const Conditions& before,
                                                   const VectorX& to, const Conditions& after) const {
  const RigidPlace start = rigid_place(before), end = rigid_place(after);
  if (start.shift == end.shift && start.turn == end.turn) return std::nullopt;
  const auto work = [&](const VectorX& x, const Conditions& c) {
    const RigidPlace place = rigid_place(c);
    double sum = 0;
    for_each_near(x, c, [&](Index point, const Vector3& y, double d) {
      const Vector3 force = -stiffness(point) * barrier_.slope(d) * place.turned(shape_->normal(y));
      sum += force.dot(end(y) - start(y));
    });
    for_near_facets(x, c, [&](const BallFacets::Contact& contact, const TermSet& set) {
      const Vector3 on_center = facets_->at_center(sum_of_gradients(set, contact.places));
      sum += on_center.dot(ball(after).center - ball(before).center);
    });
    return sum;
  };
  return std::max({work(from, before), work(to, after), value(to, after) - value(to, before)});
}

// Seen from the collider the points go on chords.
bool ColliderBarrier::may_go(const VectorX& x, double from, double to) const {
  const RigidPlace start = rigid_place({.time = from}), end = rigid_place({.time = to});
  for (Index point = 0; point < points_.size(); ++point) {
    const Vector3 place = at(point, x), y = start.inverse(place);
    const double left = distance_left(shape_->distance(y), share_left);
    if (!(shape_->time_of_approach(y, end.inverse(place) - y, left) >= 1)) return false;
  }
  const Vector3 way = ball({.time = to}).center - ball({.time = from}).center;
  return free_share_of_facets(x, way, {.time = from}, share_left) >= 1;
}

double ColliderBarrier::least_delay(const VectorX& x, const Conditions& c) const {
  if (motion_.keeps_place() || !is_active_) return 0;
  if (motion_.is_straight()) {
    const double reached = std::min(c.time - c.delay, motion_.until);
    const double wanted = std::min(c.time, motion_.until);
    const double part = largest_motion(x, (wanted - reached) * motion_.velocity, c);
    return part == 1 ? 0 : c.time - (reached + part * (wanted - reached));
  }
  for (double part = 1; part > least_part; part *= next_part)
    if (may_go(x, c.time - c.delay, c.time - (1 - part) * c.delay)) return (1 - part) * c.delay;
  return c.delay;
}

}  // namespace resilin
