#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

Keys<MotorDescription> motor_keys() {
  using M = MotorDescription;
  return {
      number_key("position", &M::position, "rad", any_number,
                 "Angle by which the second body turns against the first about the axis."),
      key<M>({"stiffness", "number > 0", "N m", "from the rigid bodies", "Stiffness of the motor."},
             [](const SceneNode& node, M& m) { m.stiffness = read_number(node, positive); }),
      key<M>({"time_function", "[time_function](#time_function)", "", "none",
              "Factor on position in place of the load factor."},
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

Keys<JointDescription> joint_keys() {
  using J = JointDescription;
  return {
      text_key("name", &J::name, "joint[0] ...", "Name of the joint in the report."),
      choice_key("kind", &J::kind,
                 "ball: the point `at` of both bodies stays one. hinge: all points of the axis through `at` "
                 "do. fixed: the bodies move as one. distance: that between `at` and `to` stays."),
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
      key<J>({"axis", "vector", "", "required for a hinge in 3D", "Hinge: its axis."},
             [](const SceneNode& node, J& j) { j.axis = read_vector(node); }),
      key<J>({"to", "vector", "m", "required for distance",
              "Distance: the point of the second body, or of the ground."},
             [](const SceneNode& node, J& j) { j.to = read_vector(node); }),
      key<J>({"motor", "{ position, stiffness, time_function }", "", "none",
              "Hinge: turns it to an angle `position` [rad], with a `stiffness` [N m]."},
             [](const SceneNode& node, J& j) {
               j.motor.emplace();
               read_table(node, motor_keys(), *j.motor);
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
  const bool is_hinge = joint.kind == JointKind::hinge, is_3d = node.context->dimension == 3;
  if (is_hinge && is_3d) needs("axis");
  if (joint.kind == JointKind::distance) needs("to");
  is_for("axis", is_hinge && is_3d, "hinge in 3D");
  is_for("to", joint.kind == JointKind::distance, "joint of kind \"distance\"");
  is_for("motor", is_hinge, "hinge");
}

Keys<CableDescription> spring_keys() {
  using C = CableDescription;
  return {
      text_key("name", &C::name, "spring[0] ...", "Name in the report."),
      points_key("Its two ends. On a deformable body the vertex nearest to `at`."),
      key<C>({"stiffness", "number > 0", "N/m", "required", "Force for each metre of stretch."},
             [](const SceneNode& node, C& c) { c.stiffness = read_number(node, positive); }),
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
      points_key("Its ends and the guides between them in order, through which it slides without friction. "
                 "On a deformable body the vertex nearest to `at`."),
      key<C>({"tension", "number >= 0", "N", "none", "Force in the cable, in place of a length."},
             [](const SceneNode& node, C& c) { c.tension = read_number(node, not_negative); }),
      number_key("shortening", &C::shortening, "m", any_number,
                 "By how much it is shorter than at rest, without force."),
      key<C>({"stiffness", "number > 0", "N/m", "required without tension",
              "Force for each metre of stretch. A cable never pushes."},
             [](const SceneNode& node, C& c) { c.stiffness = read_number(node, positive); }),
      key<C>({"time_function", "[time_function](#time_function)", "", "none",
              "Factor on tension or shortening in place of the load factor."},
             [](const SceneNode& node, C& c) { read_time_function(node, c.time_function); }),
  };
}

void read_spring(const SceneNode& node, CableDescription& spring) {
  spring.place = node.place();
  spring.name = node.path;
  read_table(node, spring_keys(), spring);
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
