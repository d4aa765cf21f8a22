#include <numbers>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

Keys<MotorDescription> motor_keys() {
  using M = MotorDescription;
  return {
      number_key("position", &M::position, "rad, m", any_number,
                 "Angle or way by which the second body moves against the first about or along the axis."),
      key<M>({"velocity", "number", "rad/s, m/s", "none",
              "In place of position: its rate, by which it grows from 0 at t = 0."},
             [](const SceneNode& node, M& m) { m.velocity = read_number(node); }),
      key<M>({"torque", "number", "N m", "none", "Hinge, in place of position: torque on the second body."},
             [](const SceneNode& node, M& m) { m.effort = read_number(node); }),
      key<M>({"force", "number", "N", "none", "Slider, in place of position: force on the second body."},
             [](const SceneNode& node, M& m) { m.effort = read_number(node); }),
      key<M>({"stiffness", "number > 0", "N m, N/m", "from the rigid bodies",
              "Stiffness of a motor with a position or a velocity."},
             [](const SceneNode& node, M& m) { m.stiffness = read_number(node, positive); }),
      key<M>({"time_function", "[time_function](#time_function)", "", "none",
              "Factor on position, torque or force in place of the load factor, or on velocity."},
             [](const SceneNode& node, M& m) { read_time_function(node, m.time_function); }),
  };
}

Keys<AnchorDescription> anchor_keys() {
  using A = AnchorDescription;
  return {
      text_key("body", &A::body, "the ground", "Name of the body."),
      key<A>({"at", "vector", "m", "required", "The point as placed."},
             [](const SceneNode& node, A& a) { a.at = read_vector(node); }),
  };
}

Key<CableDescription> points_key(const char* text) {
  return key<CableDescription>({"points", "list of { body, at }", "", "required", text},
                               [](const SceneNode& node, CableDescription& c) {
                                 expect_list(node, "tables { body, at }");
                                 for (std::size_t i = 0; i < node.value->array().size(); ++i) {
                                   AnchorDescription& point = c.points.emplace_back();
                                   const SceneNode element = node.element(i);
                                   point.place = element.place();
                                   read_table(element, anchor_keys(), point);
                                 }
                               });
}

void expect_points(const SceneNode& node, const CableDescription& cable, bool are_two) {
  if (cable.points.size() < 2 || (are_two && cable.points.size() > 2))
    node.child("points").fail(are_two ? "two points { body, at }" : "at least two points { body, at }");
}

}  // namespace

TableDoc motor_doc() {
  return document("joint.motor", "Motor of a hinge or a slider; one of position, velocity, torque and force.",
                  motor_keys());
}

Keys<JointDescription> joint_keys() {
  using J = JointDescription;
  return {
      text_key("name", &J::name, "joint[0] ...", "Name of the joint in the report."),
      choice_key("kind", &J::kind,
                 "ball: the point `at` of both bodies stays one. hinge: all points of the axis through `at` "
                 "do. slider: the second body moves along the axis alone. cylindrical: along and about it. "
                 "planar: in the plane across the axis, and about it. universal: about both axes through "
                 "`at`. fixed: the bodies move as one. distance: that between `at` and `to` stays."),
      key<J>(
          {"bodies", "list of names", "", "required",
           "Two rigid bodies, or one that is joined to the ground. A ball joins deformable bodies, too, at "
           "the vertex nearest to `at`."},
          [](const SceneNode& node, J& j) {
            expect_list(node, "one or two names of bodies");
            const std::size_t count = node.value->array().size();
            if (count < 1 || count > 2) node.fail("one or two names of bodies");
            for (std::size_t i = 0; i < count; ++i) j.bodies.push_back(read_text(node.element(i)));
          }),
      key<J>({"at", "vector", "m", "required", "Where the joint is, as the bodies are placed."},
             [](const SceneNode& node, J& j) { j.at = read_vector(node); }),
      key<J>({"axis", "vector", "", "required for kinds with an axis",
              "Axis that the first body or the ground carries; of a hinge not in 2D; planar: the normal."},
             [](const SceneNode& node, J& j) { j.axis = read_vector(node); }),
      key<J>({"second_axis", "vector", "", "required for universal",
              "Universal: the axis across `axis` that the second body carries, or the only one."},
             [](const SceneNode& node, J& j) { j.second_axis = read_vector(node); }),
      key<J>({"to", "vector", "m", "required for distance",
              "Distance: the point of the second body, or of the ground."},
             [](const SceneNode& node, J& j) { j.to = read_vector(node); }),
      number_key("stiffness", &J::stiffness, "N m/rad, N/m", not_negative,
                 "Hinge and slider: of a spring on the angle or the way."),
      number_key("rest", &J::rest, "rad, m", any_number,
                 "Angle or way without force of the spring. It is 0 as the bodies are placed."),
      number_key("damping", &J::damping, "N m s, N s/m", not_negative,
                 "Hinge and slider: torque or force for a unit of velocity."),
      key<J>({"limits", "[lowest, highest]", "rad, m", "none",
              "Hinge and slider: stiff stops of the angle or the way."},
             [](const SceneNode& node, J& j) {
               expect_list(node, "[lowest, highest]");
               const std::size_t count = node.value->array().size();
               std::vector<std::string> numbers;
               for (std::size_t i = 0; i < count; ++i) {
                 j.limits.push_back(read_number(node.element(i)));
                 numbers.push_back(format_number(j.limits.back()));
               }
               if (count != 2 || !(j.limits[0] <= 0 && j.limits[1] >= 0 && j.limits[0] < j.limits[1]))
                 throw InputError(node.place(), "two numbers, lowest < highest, with 0 among them",
                                  "[" + join(numbers) + "]", "the value is 0 as the bodies are placed");
             }),
      key<J>({"motor", "[joint.motor](#jointmotor)", "", "none",
              "Hinge and slider: moves it by a position, a velocity, a torque or a force."},
             [](const SceneNode& node, J& j) {
               j.motor.emplace();
               read_table(node, motor_keys(), *j.motor);
               int count = 0;
               for (const char* name : {"position", "velocity", "torque", "force"})
                 count += node.has(name) ? 1 : 0;
               if (count != 1) node.fail_with("a motor has one of position, velocity, torque and force");
               if (j.motor->effort && j.motor->stiffness)
                 node.child("stiffness").fail_with("a motor with a torque or a force has no stiffness");
             }),
  };
}

void read_joint(const SceneNode& node, JointDescription& joint) {
  joint.place = node.place();
  joint.name = node.path;
  read_table(node, joint_keys(), joint);
  const auto needs = [&](const char* name) {
    if (!node.has(name)) node.fail_with(std::string("the joint needs the key \"") + name + "\"");
  };
  const auto is_for = [&](const char* name, bool is_right, const char* kind) {
    if (node.has(name) && !is_right)
      node.child(name).fail_with(std::string("only a ") + kind + " has this key");
  };
  using enum JointKind;
  const bool is_3d = node.context->dimension == 3;
  const bool is_spatial = joint.kind == cylindrical || joint.kind == planar || joint.kind == universal;
  if (is_spatial && !is_3d)
    node.child("kind").fail_with(
        "joints of this kind are for 3D; in 2D there are ball, hinge, slider, fixed "
        "and distance");
  const bool has_axis = (joint.kind == hinge && is_3d) || joint.kind == slider || is_spatial;
  const bool has_value = joint.kind == hinge || joint.kind == slider;
  if (has_axis) needs("axis");
  if (joint.kind == universal) needs("second_axis");
  if (joint.kind == distance) needs("to");
  is_for("axis", has_axis, "joint with an axis (hinge in 3D, slider, cylindrical, planar or universal)");
  is_for("second_axis", joint.kind == universal, "joint of kind \"universal\"");
  is_for("to", joint.kind == distance, "joint of kind \"distance\"");
  for (const char* name : {"stiffness", "rest", "damping", "limits", "motor"})
    is_for(name, has_value, "hinge or a slider");
  if (node.has("rest") && !node.has("stiffness"))
    node.child("rest").fail_with("rest is that of a spring: give stiffness, too");
  if (joint.motor && joint.motor->effort)
    for (const auto& [name, kind] : {std::pair{"torque", hinge}, std::pair{"force", slider}})
      if (node.child("motor").has(name) && joint.kind != kind)
        node.child("motor").child(name).fail_with(joint.kind == hinge ? "the motor of a hinge has a torque"
                                                                      : "the motor of a slider has a force");
  if (joint.kind == hinge && !joint.limits.empty() &&
      !(joint.limits[1] - joint.limits[0] < 2 * std::numbers::pi))
    node.child("limits").fail("limits of a hinge that are less than a turn apart");
}

namespace {

/// Elongations, rising, and forces there.
void read_forces(const SceneNode& node, CableDescription& spring) {
  const NumberTable rows = read_pairs(node, "rows [elongation, force]", "elongation");
  if (rows.num_columns != 2 || rows.num_rows() < 2)
    node.fail("rows [elongation, force], two at least", "such as [[-0.1, -20], [0.1, 5]]");
  for (std::size_t i = 0; i < rows.num_rows(); ++i) {
    if (i > 0 && !(rows.values[2 * i] > rows.values[2 * i - 2]))
      node.fail_with("expected rising elongations, got " + format_number(rows.values[2 * i]) + " after " +
                     format_number(rows.values[2 * i - 2]) + " in row " + std::to_string(i) + " (from 0)");
    spring.elongations.push_back(rows.values[2 * i]);
    spring.forces.push_back(rows.values[2 * i + 1]);
  }
}

}  // namespace

Keys<CableDescription> spring_keys() {
  using C = CableDescription;
  return {
      text_key("name", &C::name, "spring[0] ...", "Name in the report."),
      points_key("Its two ends. On a deformable body the vertex nearest to `at`."),
      key<C>(
          {"stiffness", "number > 0", "N/m", "required without forces", "Force for each metre of stretch."},
          [](const SceneNode& node, C& c) { c.stiffness = read_number(node, positive); }),
      key<C>({"forces", "rows", "m, N", "none",
              "Rows of an elongation and the force there, in place of a stiffness: a CSV file or a list with "
              "rising elongations. Linear between them and beyond."},
             read_forces),
      key<C>({"rest_length", "number >= 0", "m", "its length at rest", "Length without force."},
             [](const SceneNode& node, C& c) { c.rest_length = read_number(node, not_negative); }),
      key<C>({"tension_only", "true or false", "", "false", "Whether it goes slack instead of pushing."},
             [](const SceneNode& node, C& c) { c.tension_only = read_flag(node); }),
  };
}

Keys<CableDescription> cable_keys() {
  using C = CableDescription;
  return {
      text_key("name", &C::name, "cable[0] ...", "Name in the report."),
      points_key("Its ends and the guides between them in order, through which it slides. "
                 "On a deformable body the vertex nearest to `at`."),
      key<C>({"tension", "number >= 0", "N", "none",
              "Force in the cable at its first point, in place of a length."},
             [](const SceneNode& node, C& c) { c.tension = read_number(node, not_negative); }),
      number_key("shortening", &C::shortening, "m", any_number,
                 "By how much it is shorter than at rest, without force."),
      key<C>({"stiffness", "number > 0", "N/m", "required without tension",
              "Force for each metre of stretch. A cable never pushes."},
             [](const SceneNode& node, C& c) { c.stiffness = read_number(node, positive); }),
      number_key("friction", &C::friction, "", not_negative,
                 "Coulomb friction coefficient at the guides ([friction](rigid.md#springs-and-cables))."),
      key<C>({"time_function", "[time_function](#time_function)", "", "none",
              "Factor on tension or shortening in place of the load factor."},
             [](const SceneNode& node, C& c) { read_time_function(node, c.time_function); }),
  };
}

void read_spring(const SceneNode& node, CableDescription& spring) {
  spring.place = node.place();
  spring.name = node.path;
  read_table(node, spring_keys(), spring);
  if (node.has("stiffness") == node.has("forces"))
    node.fail_with("a spring has either a stiffness or a table of forces");
  if (node.has("forces") && spring.tension_only)
    node.child("tension_only")
        .fail_with("is for a stiffness; a table of forces has rows with the force 0 where it is slack");
  expect_points(node, spring, true);
}

void read_cable(const SceneNode& node, CableDescription& cable) {
  cable.place = node.place();
  cable.name = node.path;
  cable.tension_only = true;
  read_table(node, cable_keys(), cable);
  expect_points(node, cable, false);
  if (node.has("tension") == node.has("stiffness"))
    node.fail_with("a cable has either a tension or a stiffness, with a shortening");
  if (node.has("tension") && node.has("shortening"))
    node.child("shortening").fail_with("a cable with a tension has no shortening");
}

}  // namespace resilin
