#include "resilin/world/joint.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "resilin/core/dense.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/second_moments.hpp"
#include "resilin/world/constraints.hpp"
#include "resilin/world/joint_maker.hpp"
#include "resilin/world/linear_constraints.hpp"
#include "resilin/world/rigid_shape.hpp"
#include "resilin/world/state.hpp"

namespace resilin {
namespace {

constexpr double agreement_of_velocities = 1e-6;  ///< relative to the velocities at a joint
/// Cosine of the angle between the axes of a universal joint, up to which they are orthogonal.
constexpr double orthogonality = 1e-6;

/// A point that a body carries: on a deformable one its nearest vertex. Null: the ground.
CarriedPoint carried(World& world, const Body* body, const Vector3& at, const std::string& place) {
  if (body == nullptr) return {.nodes = {}, .place = at};
  Probe probe = find_probe({.place = place, .name = "", .body = body->name, .at = at}, *body, world);
  if (probe.carriers.empty()) {
    for (const Body& region : world.bodies) {
      // A vertex of a rigid region follows its control nodes: they bear the force of the joint.
      if (!region.rigid || region.rigid->region_of != body->name) continue;
      if (!std::ranges::binary_search(followers_of(world, region), probe.node)) continue;
      const VectorX shares =
          region.rigid->weights(node_position(world.dimension, probe.node, world.rest_positions));
      CarriedPoint point;
      for (Eigen::Index a = 0; a < shares.size(); ++a)
        point.nodes.push_back({region.first_node + static_cast<Index>(a), shares[a]});
      return point;
    }
    return {.nodes = {{probe.node, 1}}};
  }
  return {.nodes = std::move(probe.carriers)};
}

double extent_of_joint(const World& world, const std::vector<const Body*>& bodies) {
  double extent = 0;
  for (const Body* body : bodies)
    if (body != nullptr && body->rigid)
      extent =
          std::max(extent, largest_extent(body->rigid->body, body->rigid->rest_positions, world.dimension));
  return extent > 0 ? extent : 1;
}

/// Stiffness of the energies that hold a point of a joint: E V / L^2, that of the stiffer body against being
/// stretched along its extent L [N/m].
double force_stiffness(const World& world, const std::vector<const Body*>& bodies) {
  double stiffness = 0;
  for (const Body* body : bodies) {
    if (body == nullptr || !body->rigid) continue;
    const RigidShape& shape = *body->rigid;
    const double extent = largest_extent(shape.body, shape.rest_positions, world.dimension);
    const double volume =
        second_moments(shape.body.cell_kind, shape.body.cells, shape.rest_positions, world.dimension).size();
    stiffness = std::max(stiffness, shape.modulus * world.thickness * volume / (extent * extent));
  }
  return stiffness;
}

/// Stiffness of stops and motors: of an angle [N m], of a way [N/m].
double stiffness_of_value(const Joint& joint, const World& world) {
  std::vector<const Body*> bodies;
  for (const std::size_t body : joint.bodies) bodies.push_back(&world.bodies[body]);
  return force_stiffness(world, bodies) * (joint.kind == JointKind::hinge ? joint.length * joint.length : 1);
}

/// The two bodies of a joint; the second one is null for the ground.
std::vector<const Body*> bodies_of(const JointDescription& joint, const World& world) {
  std::vector<const Body*> bodies;
  for (const std::string& name : joint.bodies)
    bodies.push_back(&world.bodies[find_body(world, name, joint.place + ".bodies")]);
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

/// Makes one joint and its energies.
class JointMaker {
 public:
  JointMaker(const JointDescription& description, World& world, std::vector<std::shared_ptr<Energy>>& terms)
      : description_(description),
        world_(world),
        terms_(terms),
        dim_(world.dimension),
        bodies_(bodies_of(description, world)),
        length_(extent_of_joint(world, bodies_)),
        force_stiffness_(force_stiffness(world, bodies_)) {}

  Joint make() {
    joint_ = {.name = description_.name, .kind = description_.kind, .length = length_};
    for (const Body* body : bodies_)
      if (body != nullptr) joint_.bodies.push_back(static_cast<std::size_t>(body - world_.bodies.data()));
    joint_.at = point(bodies_[0], Vector3::Zero());
    if (joint_.kind == JointKind::distance) {
      add_distance();
    } else {
      choose_axes();
      add_frames();
      add_equations();
      add_energies();
    }
    check_velocities();
    return std::move(joint_);
  }

 private:
  CarriedPoint point(const Body* body, const Vector3& arm) const {
    return carried(world_, body, description_.at + arm, description_.place + ".at");
  }

  void add(std::shared_ptr<Energy> term) {
    joint_.terms.push_back(term);
    terms_.push_back(std::move(term));
  }

  void add_distance() {
    const Vector3 to = description_.to.value_or(description_.at);
    joint_.rest_distance = (to - description_.at).norm();
    if (!(joint_.rest_distance > 0))
      throw InputError(description_.place + ".to", "another point than `at`", "the same",
                       "take kind = \"ball\" for points that stay together");
    const CarriedPoint second = carried(world_, bodies_[1], to, description_.place + ".to");
    auto term = std::make_shared<Cable>(
        joint_.name, dim_, std::vector<CarriedPoint>{joint_.at, second},
        Cable::Law{.stiffness = force_stiffness_, .rest_length = joint_.rest_distance});
    joint_.distance = term;
    add(std::move(term));
  }

  /// The axis, and directions across it, of which the first is the second axis of a universal joint.
  void choose_axes() {
    const bool has_axis = joint_.kind != JointKind::ball && joint_.kind != JointKind::fixed;
    if (has_axis && (dim_ == 3 || joint_.kind == JointKind::slider)) {
      if (!(description_.axis.norm() > 0))
        throw InputError(description_.place + ".axis", "a vector that is not zero", "[0, 0, 0]");
      axis_ = description_.axis.normalized();
    }
    if (dim_ == 2 && joint_.kind == JointKind::slider) {
      along_ = Vector3::UnitZ().cross(axis_);
      across_ = Vector3::UnitZ();
      return;
    }
    Vector3 side = std::abs(axis_.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
    if (joint_.kind == JointKind::universal) {
      side = description_.second_axis.value_or(side);
      if (!(std::abs(axis_.dot(side)) <= orthogonality * side.norm()) || side.isZero(0))
        throw InputError(description_.place + ".second_axis", "a direction across axis",
                         format_point(side, 3), "both axes of a universal joint are orthogonal");
    }
    along_ = (side - axis_ * axis_.dot(side)).normalized();
    across_ = axis_.cross(along_);
  }

  void add_frames() {
    const bool are_rigid = std::ranges::all_of(
        bodies_, [](const Body* body) { return body == nullptr || body->rigid != nullptr; });
    if (joint_.kind == JointKind::fixed || (joint_.kind == JointKind::ball && dim_ == 3) || !are_rigid)
      return;
    joint_.has_frames = true;
    const auto frame = [&](const Body* body) {
      const auto beside = [&](const Vector3& direction) {
        const bool is_out_of_plane = dim_ == 2 && direction.z() != 0;
        return point(body, is_out_of_plane ? Vector3(Vector3::Zero()) : Vector3(length_ * direction));
      };
      return Joint::Frame{.at = beside(Vector3::Zero()),
                          .axis = beside(axis_),
                          .along = beside(along_),
                          .across = beside(across_)};
    };
    joint_.moved = frame(bodies_[1] != nullptr ? bodies_[1] : bodies_[0]);
    joint_.fixed = frame(bodies_[1] != nullptr ? bodies_[0] : nullptr);
  }

  /// A point of both bodies stays one.
  void join_points(const Vector3& arm) {
    const CarriedPoint first = point(bodies_[0], arm), second = point(bodies_[1], arm);
    joint_.rows.push_back({.arms = {{first, 1}}, .nodes = vector_between(second, first).nodes});
  }
  /// A direction of both bodies stays one.
  void join_directions(const Vector3& direction) { joint_.rows.push_back(row_of_direction(direction)); }
  Joint::Row row_of_direction(const Vector3& direction) const {
    const auto arm = [&](const Body* body) {
      return vector_between(point(body, Vector3::Zero()), point(body, length_ * direction));
    };
    return {.arms = {{point(bodies_[0], length_ * direction), 1}, {point(bodies_[0], Vector3::Zero()), -1}},
            .nodes = vector_between(arm(bodies_[1]), arm(bodies_[0])).nodes};
  }

  void add_equations() {
    switch (joint_.kind) {
      case JointKind::ball:
        return join_points(Vector3::Zero());
      case JointKind::hinge:
        join_points(Vector3::Zero());
        if (dim_ == 3) join_points(length_ * axis_);
        return;
      case JointKind::fixed:
        join_points(Vector3::Zero());
        for (int k = 0; k < dim_; ++k) join_points(length_ * Vector3::Unit(k));
        return;
      case JointKind::slider:
        for (int k = 0; k < dim_; ++k) join_directions(Vector3::Unit(k));
        keep_beside(along_, joint_.fixed.along);
        if (dim_ == 3) keep_beside(across_, joint_.fixed.across);
        return;
      case JointKind::cylindrical:
        join_directions(axis_);
        keep_beside(along_, joint_.fixed.along);
        return keep_beside(across_, joint_.fixed.across);
      case JointKind::planar:
        join_directions(axis_);
        return keep_beside(axis_, joint_.fixed.axis);
      case JointKind::universal:
        join_points(Vector3::Zero());
        return keep_across();
      case JointKind::distance:
        return;
    }
  }

  /// The second body goes nowhere in a direction that the first one carries, or the ground: then this is
  /// linear.
  /// @param end  the joint's length away in that direction
  void keep_beside(const Vector3& direction, const CarriedPoint& end) {
    if (bodies_[1] == nullptr) {
      const CarriedPoint first = point(bodies_[0], Vector3::Zero());
      add_row({.arms = {{first, 1}}, .nodes = first.nodes, .direction = direction});
      return;
    }
    add_gap(JointCoordinate::travel(dim_, vector_between(joint_.fixed.at, joint_.moved.at),
                                    vector_between(joint_.fixed.at, end, length_)));
    joint_.held.push_back(
        {.nodes = vector_between(joint_.fixed.at, joint_.moved.at).nodes, .direction = direction});
  }
  /// The second axis of a universal joint stays across the first.
  void keep_across() {
    if (bodies_[1] == nullptr) {
      Joint::Row row = row_of_direction(along_);
      row.direction = axis_;
      add_row(std::move(row));
      return;
    }
    add_gap(JointCoordinate::travel(dim_, vector_between(joint_.fixed.at, joint_.fixed.axis),
                                    vector_between(joint_.moved.at, joint_.moved.along, length_)));
    joint_.held.push_back(
        {.nodes = vector_between(joint_.fixed.axis, joint_.moved.axis).nodes, .direction = along_});
  }
  void add_row(Joint::Row row) {
    joint_.held.push_back({.nodes = row.nodes, .direction = *row.direction});
    joint_.rows.push_back(std::move(row));
  }
  void add_gap(const JointCoordinate& coordinate) {
    joint_.gaps.push_back(coordinate);
    add(std::make_shared<JointSpring>(joint_.name, coordinate,
                                      JointSpring::Law{.stiffness = force_stiffness_}));
  }

  /// Springs, stops, dampers and motors of a hinge or a slider.
  void add_energies() {
    const bool is_hinge = joint_.kind == JointKind::hinge;
    if (!is_hinge && joint_.kind != JointKind::slider) return;
    const JointCoordinate coordinate = coordinate_of(joint_, dim_);
    const double stiffness = stiffness_of_value(joint_, world_);
    const auto add_law = [&](JointSpring::Law law) {
      add(std::make_shared<JointSpring>(joint_.name, coordinate, std::move(law)));
    };
    bool is_held = false;
    if (description_.stiffness > 0) {
      add_law({.stiffness = description_.stiffness, .rest = description_.rest});
      is_held = true;
    }
    if (!description_.limits.empty())
      add_law({.stiffness = stiffness, .limits = {{description_.limits[0], description_.limits[1]}}});
    if (description_.damping > 0) {
      auto damper = std::make_shared<JointDamper>(joint_.name, coordinate, description_.damping);
      joint_.damper = damper;
      add(std::move(damper));
    }
    if (description_.motor) {
      is_held = is_held || !description_.motor->effort;
      add(make_motor(*description_.motor, joint_, world_));
    }
    if (!is_held) return;
    if (is_hinge)
      joint_.held.push_back(
          {.nodes = vector_between(joint_.fixed.along, joint_.moved.along).nodes, .direction = across_});
    else
      joint_.held.push_back(
          {.nodes = vector_between(joint_.fixed.at, joint_.moved.at).nodes, .direction = axis_});
  }

  /// Where bodies start with velocities that the joint does not allow.
  void check_velocities() const {
    if (!world_.is_dynamic) return;
    const auto refuse = [&](double difference) {
      throw InputError(description_.place, "bodies that start with one velocity at the joint",
                       "velocities that differ by " + format_short(difference) + " m/s",
                       "give both bodies velocity and velocity_gradient of one motion");
    };
    for (const Joint::Row& row : joint_.rows) {
      Vector3 sum = Vector3::Zero();
      double size = 0;
      for (const auto& [node, weight] : row.nodes) {
        const Vector3 v = weight * node_position(dim_, node, world_.start_velocities);
        sum += v;
        size = std::max(size, v.norm());
      }
      const double difference = row.direction ? std::abs(sum.dot(*row.direction)) : sum.norm();
      if (difference > agreement_of_velocities * size) refuse(difference);
    }
    const double largest = world_.start_velocities.cwiseAbs().maxCoeff();
    for (const JointCoordinate& gap : joint_.gaps)
      if (const double rate = std::abs(gap.rate(world_.rest_positions, world_.start_velocities));
          rate > agreement_of_velocities * largest)
        refuse(rate);
  }

  const JointDescription& description_;
  World& world_;
  std::vector<std::shared_ptr<Energy>>& terms_;
  int dim_;
  std::vector<const Body*> bodies_;
  double length_;
  double force_stiffness_;  ///< [N/m]
  Vector3 axis_ = Vector3::UnitZ(), along_ = Vector3::UnitX(), across_ = Vector3::UnitY();
  Joint joint_{};
};

/// The angle about an axis from v on to w [rad].
double angle_between(const Vector3& along, const Vector3& across, const Vector3& w) {
  return std::atan2(w.dot(across), w.dot(along));
}

/// Value of a joint, and its second one.
void measure(const Joint& joint, int dim, const VectorX& x, JointForce& force) {
  if (joint.distance) {
    force.value = joint.distance->length(x);
    force.gap = std::abs(force.value - joint.rest_distance);
  }
  if (!joint.has_frames) return;
  struct Axes {
    Vector3 at, axis, along, across;
  };
  const auto axes = [&](const Joint::Frame& frame) {
    const Vector3 at = frame.at.at(dim, x);
    const auto direction = [&](const CarriedPoint& end) {
      return Vector3((end.at(dim, x) - at) / joint.length);
    };
    return Axes{at, direction(frame.axis), direction(frame.along), direction(frame.across)};
  };
  const Axes moved = axes(joint.moved), fixed = axes(joint.fixed);
  const double turn = angle_between(fixed.along, fixed.across, moved.along);
  const Vector3 way = moved.at - fixed.at;
  switch (joint.kind) {
    case JointKind::slider:
      force.value = way.dot(fixed.axis);
      return;
    case JointKind::cylindrical:
      force.value = way.dot(fixed.axis);
      force.angle = turn;
      return;
    case JointKind::planar:
      force.value = (way - fixed.axis * way.dot(fixed.axis)).norm();
      force.angle = turn;
      return;
    case JointKind::universal:
      force.value = turn;
      force.angle = angle_between(moved.axis, moved.across, fixed.axis);
      return;
    default:
      force.value = turn;
  }
}

/// By how much the equations and the stiff energies let a joint open [m].
double gap_of(const Joint& joint, int dim, const VectorX& rest_positions, const VectorX& x) {
  double gap = 0;
  for (const Joint::Row& row : joint.rows) {
    Vector3 sum = Vector3::Zero();
    for (const auto& [node, weight] : row.nodes)
      sum += weight * (node_position(dim, node, x) - node_position(dim, node, rest_positions));
    gap = std::max(gap, row.direction ? std::abs(sum.dot(*row.direction)) : sum.norm());
  }
  for (const JointCoordinate& each : joint.gaps) gap = std::max(gap, std::abs(each.value(x)));
  return gap;
}

/// The multipliers of all equations of joints: a sum over rows and components c lambda that is f at all
/// nodes, the shortest where several are.
std::vector<Vector3> multipliers(const World& world, const VectorX& forces) {
  std::vector<const Joint::Row*> rows;
  for (const Joint& joint : world.joints)
    for (const Joint::Row& row : joint.rows) rows.push_back(&row);
  std::map<Index, Eigen::Index> number_of;
  for (const Joint::Row* row : rows)
    for (const WeightedNode& each : row->nodes)
      number_of.emplace(each.node, static_cast<Eigen::Index>(number_of.size()));
  // Without rows in one direction all components have one and the same matrix.
  const bool is_mixed =
      std::ranges::any_of(rows, [](const Joint::Row* row) { return row->direction.has_value(); });
  const Eigen::Index width = is_mixed ? 3 : 1;
  const auto num_nodes = static_cast<Eigen::Index>(number_of.size());
  std::vector<Eigen::Index> begin = {0};
  for (const Joint::Row* row : rows) begin.push_back(begin.back() + (row->direction ? 1 : width));
  const Eigen::Index count = begin.back();
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(count, num_nodes * width);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const auto& [node, weight] : rows[i]->nodes) {
      const Eigen::Index column = number_of.at(node) * width;
      if (rows[i]->direction) {
        C.block<1, 3>(begin[i], column) += weight * rows[i]->direction->transpose();
      } else {
        C.block(begin[i], column, width, width).diagonal().array() += weight;
      }
    }
  Eigen::MatrixXd f = Eigen::MatrixXd::Zero(C.cols(), 3 / width);
  for (const auto& [node, number] : number_of) {
    const Vector3 force = node_position(world.dimension, node, forces);
    if (is_mixed)
      f.block<3, 1>(3 * number, 0) = force;
    else
      f.row(number) = force.transpose();
  }
  const dense::Eigenpairs eigen = dense::symmetric_eigenpairs(C * C.transpose());
  Eigen::MatrixXd lambda = Eigen::MatrixXd::Zero(count, f.cols());
  const Eigen::MatrixXd right = eigen.vectors.transpose() * (C * f);
  for (Eigen::Index k = 0; k < count; ++k)
    if (eigen.values[k] > 1e-12 * eigen.values[count - 1])
      lambda += eigen.vectors.col(k) * right.row(k) / eigen.values[k];
  std::vector<Vector3> found;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i]->direction)
      found.emplace_back(lambda(begin[i], 0) * *rows[i]->direction);
    else if (is_mixed)
      found.emplace_back(lambda.block<3, 1>(begin[i], 0));
    else
      found.emplace_back(lambda.row(begin[i]).transpose());
  }
  return found;
}

/// Adds what the energies of a joint exert on its first body.
/// @param gradient  zero at the nodes of the joint's bodies, before and after
void add_forces_of_energies(const World& world, const Joint& joint, const Conditions& conditions,
                            const State& state, VectorX& gradient, JointForce& force) {
  for (const auto& term : joint.terms) term->add_gradient(state.positions, conditions, gradient);
  if (joint.damper && world.is_dynamic)
    joint.damper->add_gradient_in_motion(state.positions, state.velocities, gradient);
  const int dim = world.dimension;
  const Vector3 at = joint.at.at(dim, state.positions);
  for (const std::size_t number : joint.bodies) {
    const Body& body = world.bodies[number];
    for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node) {
      const Vector3 pull = -node_position(dim, node, gradient);
      gradient.segment(Eigen::Index{node} * dim, dim).setZero();
      if (number != joint.bodies.front()) continue;
      force.force += pull;
      force.moment += (node_position(dim, node, state.positions) - at).cross(pull);
    }
  }
}

}  // namespace

JointCoordinate coordinate_of(const Joint& joint, int dim) {
  const Joint::Frame &moved = joint.moved, &fixed = joint.fixed;
  const double length = joint.length;
  if (joint.kind == JointKind::hinge)
    return JointCoordinate::angle(dim, vector_between(moved.at, moved.along, length),
                                  vector_between(fixed.at, fixed.along, length),
                                  vector_between(fixed.at, fixed.across, length));
  return JointCoordinate::travel(dim, vector_between(fixed.at, moved.at),
                                 vector_between(fixed.at, fixed.axis, length));
}

Joint make_joint(const JointDescription& description, World& world,
                 std::vector<std::shared_ptr<Energy>>& terms) {
  return JointMaker(description, world, terms).make();
}

std::shared_ptr<Cable> make_cable(const CableDescription& description, World& world) {
  std::vector<CarriedPoint> points;
  for (const AnchorDescription& point : description.points) {
    const Body* body =
        point.body.empty() ? nullptr : &world.bodies[find_body(world, point.body, point.place + ".body")];
    points.push_back(carried(world, body, point.at, point.place));
  }
  if (std::ranges::all_of(points, [](const CarriedPoint& point) { return point.nodes.empty(); }))
    throw InputError(description.place + ".points", "a point of a body", "points of the ground alone");
  const CablePath path(world.dimension, points);
  const double length = path.length(world.rest_positions);
  const bool may_coincide = points.size() == 2 && !description.tension && description.forces.empty() &&
                            description.rest_length == 0.0;
  if (!(length > 0) && !may_coincide)
    throw InputError(description.place + ".points", "points apart", "points in one place",
                     "a spring between them needs rest_length = 0 and a stiffness");
  const auto cable = make_cable(description, world.dimension, std::move(points), length);
  if (!description.rest_length) cable->rest_at(world.rest_positions);
  return cable;
}

std::shared_ptr<Cable> make_cable(const CableDescription& description, int dim,
                                  std::vector<CarriedPoint> points, double rest_length) {
  return std::make_shared<Cable>(description.name, dim, std::move(points),
                                 Cable::Law{.stiffness = description.stiffness,
                                            .elongations = description.elongations,
                                            .forces = description.forces,
                                            .rest_length = description.rest_length.value_or(rest_length),
                                            .shortening = description.shortening,
                                            .tension = description.tension,
                                            .tension_only = description.tension_only,
                                            .function = description.time_function});
}

std::shared_ptr<Energy> make_motor(const MotorDescription& description, const Joint& joint,
                                   const World& world) {
  const JointCoordinate coordinate = coordinate_of(joint, world.dimension);
  MotorGoal goal{description.position, description.velocity.value_or(0), description.time_function};
  if (description.effort)
    return std::make_shared<JointSpring>(
        joint.name, coordinate,
        JointSpring::Law{.effort = description.effort, .goal = std::move(goal), .is_motor = true});
  const double stiffness = description.stiffness.value_or(stiffness_of_value(joint, world));
  if (joint.kind != JointKind::hinge)
    return std::make_shared<JointSpring>(
        joint.name, coordinate,
        JointSpring::Law{.stiffness = stiffness, .goal = std::move(goal), .is_motor = true});
  return std::make_shared<Motor>(joint.name, world.dimension,
                                 Motor::Arms{.turned = joint.moved.along,
                                             .centre = joint.fixed.at,
                                             .along = joint.fixed.along,
                                             .across = joint.fixed.across},
                                 joint.length, stiffness, std::move(goal));
}

std::vector<JointForce> joint_forces(const World& world, const Conditions& conditions,
                                     const VectorX& gradient, const State& state) {
  std::vector<JointForce> found;
  if (world.joints.empty()) return found;
  const int dim = world.dimension;
  std::vector<Vector3> lambda;
  if (world.constraints) lambda = multipliers(world, -world.constraints->forces_of_joints(gradient));
  VectorX of_energies = VectorX::Zero(gradient.size());
  std::size_t next = 0;
  for (const Joint& joint : world.joints) {
    JointForce force{.name = joint.name};
    const Vector3 at = joint.at.at(dim, state.positions);
    for (const Joint::Row& row : joint.rows) {
      const Vector3 pull = next < lambda.size() ? lambda[next] : Vector3(Vector3::Zero());
      ++next;
      for (const auto& [place, weight] : row.arms) {
        force.force += weight * pull;
        force.moment += weight * (place.at(dim, state.positions) - at).cross(pull);
      }
    }
    if (!joint.terms.empty()) add_forces_of_energies(world, joint, conditions, state, of_energies, force);
    measure(joint, dim, state.positions, force);
    force.gap = std::max(force.gap, gap_of(joint, dim, world.rest_positions, state.positions));
    found.push_back(std::move(force));
  }
  return found;
}

}  // namespace resilin
