#include "resilin/world/joint.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "resilin/core/dense.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/joint_maker.hpp"
#include "resilin/world/linear_constraints.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin {
namespace {

constexpr double agreement_of_velocities = 1e-6;  ///< relative to the velocities at a joint

const Body& body_of_joint(const World& world, const std::string& name, const std::string& place) {
  std::vector<std::string> names;
  for (const Body& body : world.bodies) {
    if (body.name == name) return body;
    names.push_back(body.name);
  }
  throw InputError(place, "one of " + join(names), '"' + name + '"');
}

/// A point that a body carries: on a deformable one its nearest vertex. Null: the ground.
CarriedPoint carried(World& world, const Body* body, const Vector3& at, const std::string& place) {
  if (body == nullptr) return {.nodes = {}, .place = at};
  Probe probe = find_probe({.place = place, .name = "", .body = body->name, .at = at}, *body, world);
  if (probe.carriers.empty()) return {.nodes = {{probe.node, 1}}};
  return {.nodes = std::move(probe.carriers)};
}

std::vector<WeightedNode> difference_of(const CarriedPoint& first, const CarriedPoint& second) {
  std::vector<WeightedNode> all = first.nodes;
  for (const auto& [node, weight] : second.nodes) all.push_back({node, -weight});
  return all;
}

double extent_of_joint(const World& world, const std::vector<const Body*>& bodies) {
  double extent = 0;
  for (const Body* body : bodies)
    if (body != nullptr && body->rigid)
      extent =
          std::max(extent, largest_extent(body->rigid->body, body->rigid->rest_positions, world.dimension));
  return extent > 0 ? extent : 1;
}

double modulus_of_joint(const std::vector<const Body*>& bodies) {
  double modulus = 0;
  for (const Body* body : bodies)
    if (body != nullptr && body->rigid) modulus = std::max(modulus, body->rigid->modulus);
  return modulus;
}

/// The two bodies of a joint; the second one is null for the ground.
std::vector<const Body*> bodies_of(const JointDescription& joint, const World& world) {
  std::vector<const Body*> bodies;
  for (const std::string& name : joint.bodies)
    bodies.push_back(&body_of_joint(world, name, joint.place + ".bodies"));
  if (bodies.size() == 1) bodies.push_back(nullptr);
  if (bodies[0] == bodies[1])
    throw InputError(joint.place + ".bodies", "two bodies, or one that is joined to the ground",
                     '"' + joint.bodies[0] + "\" twice", "name two bodies");
  for (const Body* body : bodies)
    if (body != nullptr && !body->rigid && joint.kind != JointKind::ball)
      throw InputError(joint.place + ".bodies",
                       "rigid bodies for a joint of kind \"" + std::string(spelling(joint.kind)) + '"',
                       "the deformable body \"" + body->name + '"', "take kind = \"ball\", or a [[tie]]");
  return bodies;
}

/// Where bodies start with velocities that the joint does not allow.
void check_velocities(const JointDescription& description, const World& world, const Joint& joint) {
  if (!world.is_dynamic) return;
  for (const Joint::Point& point : joint.points) {
    Vector3 sum = Vector3::Zero();
    double size = 0;
    for (const auto& [node, weight] : point.nodes) {
      const Vector3 v = weight * node_position(world.dimension, node, world.start_velocities);
      sum += v;
      size = std::max(size, v.norm());
    }
    if (sum.norm() > agreement_of_velocities * size)
      throw InputError(description.place, "bodies that start with one velocity at the joint",
                       "velocities that differ by " + format_short(sum.norm()) + " m/s",
                       "give both bodies velocity and velocity_gradient of one motion");
  }
}

/// The angle between both frames of a joint about its axis [rad].
double angle_of(const Joint& joint, int dim, const VectorX& x) {
  const auto direction = [&](const CarriedPoint& to, const CarriedPoint& from) {
    return Vector3(to.at(dim, x) - from.at(dim, x));
  };
  const Vector3 turned = direction(joint.turned.along, joint.turned.at);
  const Vector3 along = direction(joint.fixed.along, joint.fixed.at);
  const Vector3 across = direction(joint.fixed.across, joint.fixed.at);
  return std::atan2(turned.dot(across), turned.dot(along));
}

/// Force of a motor on the body that it turns [N]: it pulls at a point beside the axis.
Vector3 force_of_motor(const Joint& joint, int dim, const VectorX& x, const Conditions& conditions) {
  const Vector3 center = joint.fixed.at.at(dim, x);
  const Vector3 along = joint.fixed.along.at(dim, x) - center,
                across = joint.fixed.across.at(dim, x) - center;
  const double angle = joint.motor->angle(conditions);
  const Vector3 goal = center + std::cos(angle) * along + std::sin(angle) * across;
  return joint.motor->stiffness() / (joint.radius * joint.radius) * (goal - joint.turned.along.at(dim, x));
}

/// The multipliers of all equations of joints: a sum over points and components c lambda that is f at all
/// nodes, the shortest where several are.
std::vector<Vector3> multipliers(const World& world, const VectorX& forces) {
  std::vector<const Joint::Point*> points;
  for (const Joint& joint : world.joints)
    for (const Joint::Point& point : joint.points) points.push_back(&point);
  std::map<Index, Eigen::Index> column_of;
  for (const Joint::Point* point : points)
    for (const WeightedNode& each : point->nodes)
      column_of.emplace(each.node, static_cast<Eigen::Index>(column_of.size()));
  const auto count = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(column_of.size()));
  for (Eigen::Index i = 0; i < count; ++i)
    for (const auto& [node, weight] : points[static_cast<std::size_t>(i)]->nodes)
      C(i, column_of.at(node)) += weight;
  Eigen::MatrixXd f = Eigen::MatrixXd::Zero(C.cols(), 3);
  for (const auto& [node, column] : column_of)
    f.row(column) = node_position(world.dimension, node, forces).transpose();
  const dense::Eigenpairs eigen = dense::symmetric_eigenpairs(C * C.transpose());
  Eigen::MatrixXd lambda = Eigen::MatrixXd::Zero(count, 3);
  const Eigen::MatrixXd right = eigen.vectors.transpose() * (C * f);
  for (Eigen::Index k = 0; k < count; ++k)
    if (eigen.values[k] > 1e-12 * eigen.values[count - 1])
      lambda += eigen.vectors.col(k) * right.row(k) / eigen.values[k];
  std::vector<Vector3> found;
  for (Eigen::Index i = 0; i < count; ++i) found.emplace_back(lambda.row(i).transpose());
  return found;
}

}  // namespace

Joint make_joint(const JointDescription& description, World& world) {
  const int dim = world.dimension;
  const std::vector<const Body*> bodies = bodies_of(description, world);
  const std::string& place = description.place;
  const double extent = extent_of_joint(world, bodies);
  Joint joint{.name = description.name, .kind = description.kind};
  joint.at = carried(world, bodies[0], description.at, place + ".at");
  if (description.kind == JointKind::distance) return joint;
  const auto add_point = [&](const Vector3& arm) {
    const CarriedPoint first = carried(world, bodies[0], description.at + arm, place + ".at");
    const CarriedPoint second = carried(world, bodies[1], description.at + arm, place + ".at");
    joint.points.push_back({.place = first, .nodes = difference_of(first, second)});
  };
  add_point(Vector3::Zero());
  Vector3 axis = Vector3::UnitZ();
  if (description.kind == JointKind::hinge && dim == 3) {
    if (!(description.axis.norm() > 0))
      throw InputError(place + ".axis", "a vector that is not zero", "[0, 0, 0]");
    axis = description.axis.normalized();
    add_point(extent * axis);
  }
  if (description.kind == JointKind::fixed)
    for (int k = 0; k < dim; ++k) add_point(extent * Vector3::Unit(k));
  if (description.kind == JointKind::hinge || (dim == 2 && description.kind == JointKind::ball)) {
    const bool are_rigid = std::ranges::all_of(
        bodies, [](const Body* body) { return body == nullptr || body->rigid != nullptr; });
    if (are_rigid) {
      joint.has_angle = true;
      joint.radius = extent;
      const Vector3 side = std::abs(axis.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
      const Vector3 along = (side - axis * axis.dot(side)).normalized(), across = axis.cross(along);
      const auto frame = [&](const Body* body) {
        const auto point = [&](const Vector3& direction) {
          return carried(world, body, description.at + extent * direction, place + ".at");
        };
        return Joint::Frame{.at = point(Vector3::Zero()),
                            .axis = point(dim == 3 ? axis : Vector3(Vector3::Zero())),
                            .along = point(along),
                            .across = point(across)};
      };
      joint.turned = frame(bodies[1] != nullptr ? bodies[1] : bodies[0]);
      joint.fixed = frame(bodies[1] != nullptr ? bodies[0] : nullptr);
    }
  }
  check_velocities(description, world, joint);
  return joint;
}

std::shared_ptr<Energy> make_joint_term(const JointDescription& description, World& world, Joint& joint) {
  const int dim = world.dimension;
  const std::vector<const Body*> bodies = bodies_of(description, world);
  const double modulus = modulus_of_joint(bodies), extent = extent_of_joint(world, bodies);
  if (description.kind == JointKind::distance) {
    const Vector3 to = description.to.value_or(description.at);
    const double length = (to - description.at).norm();
    if (!(length > 0))
      throw InputError(description.place + ".to", "another point than `at`", "the same",
                       "take kind = \"ball\" for points that stay together");
    const CarriedPoint second = carried(world, bodies[1], to, description.place + ".to");
    const double stiffness = modulus * (dim == 3 ? extent : 1);
    auto term = std::make_shared<Cable>(description.name, dim, std::vector<CarriedPoint>{joint.at, second},
                                        Cable::Law{.stiffness = stiffness, .rest_length = length});
    joint.distance = term;
    return term;
  }
  if (!description.motor) return nullptr;
  const MotorDescription& motor = *description.motor;
  const double stiffness = motor.stiffness.value_or(modulus * (dim == 3 ? extent : 1) * extent * extent);
  auto term = std::make_shared<Motor>(description.name, dim,
                                      Motor::Arms{.turned = joint.turned.along,
                                                  .centre = joint.fixed.at,
                                                  .along = joint.fixed.along,
                                                  .across = joint.fixed.across},
                                      joint.radius, stiffness, motor.position, motor.time_function);
  joint.motor = term;
  return term;
}

std::shared_ptr<Cable> make_cable(const CableDescription& description, World& world) {
  std::vector<CarriedPoint> points;
  for (const AnchorDescription& point : description.points) {
    const Body* body =
        point.body.empty() ? nullptr : &body_of_joint(world, point.body, point.place + ".body");
    points.push_back(carried(world, body, point.at, point.place));
  }
  if (std::ranges::all_of(points, [](const CarriedPoint& point) { return point.nodes.empty(); }))
    throw InputError(description.place + ".points", "a point of a body", "points of the ground alone");
  Cable::Law law{.stiffness = description.stiffness,
                 .rest_length = 0,
                 .shortening = description.shortening,
                 .tension = description.tension,
                 .tension_only = description.tension_only,
                 .function = description.time_function};
  const Cable alone(description.name, world.dimension, points, law);
  const double length = alone.length(world.rest_positions);
  if (!(length > 0)) throw InputError(description.place + ".points", "points apart", "points in one place");
  law.rest_length = description.rest_length.value_or(length);
  return std::make_shared<Cable>(description.name, world.dimension, std::move(points), std::move(law));
}

std::vector<JointForce> joint_forces(const World& world, const Conditions& conditions,
                                     const VectorX& gradient, const VectorX& positions) {
  std::vector<JointForce> found;
  if (world.joints.empty()) return found;
  const int dim = world.dimension;
  std::vector<Vector3> lambda;
  if (world.constraints) lambda = multipliers(world, -world.constraints->forces(gradient));
  std::size_t next = 0;
  for (const Joint& joint : world.joints) {
    JointForce force{.name = joint.name};
    const Vector3 at = joint.at.at(dim, positions);
    for (const Joint::Point& point : joint.points) {
      const Vector3 pull = next < lambda.size() ? lambda[next] : Vector3(Vector3::Zero());
      ++next;
      force.force += pull;
      force.moment += (point.place.at(dim, positions) - at).cross(pull);
    }
    if (joint.distance) {
      force.value = joint.distance->length(positions);
      force.force = joint.distance->force(positions, conditions) * joint.distance->first_direction(positions);
    }
    if (joint.has_angle) force.value = angle_of(joint, dim, positions);
    if (joint.motor) {
      const Vector3 axis =
          dim == 2
              ? Vector3(Vector3::UnitZ())
              : Vector3(joint.fixed.axis.at(dim, positions) - joint.fixed.at.at(dim, positions)).normalized();
      const double torque = joint.motor->stiffness() * std::sin(joint.motor->angle(conditions) - force.value);
      const double sign = joint.fixed.at.nodes.empty() ? 1 : -1;  // the first body turns, or the second one
      force.moment += sign * torque * axis;
      force.force += sign * force_of_motor(joint, dim, positions, conditions);
    }
    found.push_back(std::move(force));
  }
  return found;
}

}  // namespace resilin
