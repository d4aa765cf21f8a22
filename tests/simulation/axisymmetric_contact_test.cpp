// Contact and friction of axisymmetric solids: forces are those of the full turn.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reference_case.hpp"
#include "resilin/element/axisymmetric.hpp"
#include "resilin/fields/contact_traction.hpp"
#include "resilin/mesh/round_generators.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;
constexpr double pi = std::numbers::pi;

BodyDescription turned_body(const std::string& name, const Mesh& mesh, const Vector3& at = Vector3::Zero()) {
  BodyDescription body;
  body.name = name;
  body.mesh = mesh;
  body.translate = at;
  body.element = axisymmetric_name(mesh.find_block(CellKind::quadrilateral) != nullptr ? "Q1" : "P1");
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.4}};
  return body;
}

Description turned_scene(std::vector<BodyDescription> bodies) {
  Description scene;
  scene.dimension = 2;
  scene.newton.tolerance = 1e-11;
  scene.bodies = std::move(bodies);
  return scene;
}

FixDescription held_along(const std::string& body, const Where& where, std::array<bool, 3> components,
                          const Vector3& to = {0, 0, 0}) {
  FixDescription description = fix(body, where);
  description.body = body;
  description.components = components;
  description.displacement = to;
  return description;
}

ColliderDescription half_space(const std::string& name, const Vector3& point, const Vector3& normal) {
  ColliderDescription collider;
  collider.name = name;
  collider.shape.point = point;
  collider.shape.normal = normal;
  return collider;
}

LoadDescription traction_on(const std::string& body, const Where& where, const Vector3& value) {
  LoadDescription load;
  load.body = body;
  load.kind = "traction";
  load.where = where;
  load.value = value;
  return load;
}

Vector3 reaction_of(const Frame& frame, const std::string& name) {
  for (const auto& [other, force] : frame.reactions)
    if (other == name) return force;
  ADD_FAILURE() << "no reaction " << name;
  return Vector3::Zero();
}

constexpr std::array<bool, 3> only_z = {false, true, false}, r_and_z = {true, true, false};
constexpr double gap = 0.0025;  // half of the default activation distance of bodies of 1 m

/// From r = `inner` to `inner` + 1, pressed on a floor.
Description pressed_on_a_floor(double inner, bool is_cut, double pressure) {
  const Mesh mesh =
      is_cut ? make_rectangle({1, 0.25}, {8, 4}) : make_quadrilateral_rectangle({1, 0.25}, {8, 4});
  Description scene = turned_scene({turned_body("ring", mesh, {inner, gap, 0})});
  scene.loads.push_back(traction_on("ring", plane(1, 0.25 + gap), {0, -pressure, 0}));
  scene.colliders.push_back(half_space("floor", {0, 0, 0}, {0, 1, 0}));
  return scene;
}

TEST(AxisymmetricContact, FloorCarriesTheLoadOfTheWholeRingEvenly) {
  constexpr double pressure = 1e3;
  for (const double inner : {0.0, 1.0})
    for (const bool is_cut : {false, true}) {
      const Simulation simulation = converged_end_of(pressed_on_a_floor(inner, is_cut, pressure));
      const double load = pressure * pi * ((inner + 1) * (inner + 1) - inner * inner);
      EXPECT_NEAR(reaction_of(simulation.frame(), "floor").y(), load, 1e-8 * load);
      const VectorX pressures = contact_pressure(simulation.world(), simulation.state());
      const VectorX tractions = contact_traction(simulation.world(), simulation.state());
      const VectorX& x = simulation.state().positions;
      const double stretch = x[2 * 8] / (inner + 1);  // all radii and lengths across have it
      EXPECT_GT(stretch, 1.001);
      for (Eigen::Index node = 0; node < 9; ++node) {
        EXPECT_NEAR(tractions[2 * node + 1], pressure, 1e-6 * pressure);
        EXPECT_NEAR(pressures[node], pressure / (stretch * stretch), 1e-6 * pressure);
      }
      EXPECT_EQ(pressures.tail(pressures.size() - 9).norm(), 0);
    }
}

TEST(AxisymmetricContact, SecondOrderAndMixedElementsCarryIt) {
  for (const char* element : {"P2", "P2P0"}) {
    Description scene = pressed_on_a_floor(0, true, 1e3);
    scene.bodies[0].element = axisymmetric_name(element);
    scene.bodies[0].material.law = "neo_hookean_isochoric";
    const Simulation simulation = converged_end_of(scene);
    EXPECT_NEAR(reaction_of(simulation.frame(), "floor").y(), 1e3 * pi, 1e-8 * 1e3 * pi) << element;
  }
}

/// Meshes in the ratio 4 to 3, one of them from the axis on.
TEST(AxisymmetricContact, BodiesPressEachOtherWithTheLoadOfTheWholeRing) {
  Description scene =
      turned_scene({turned_body("lower", make_quadrilateral_rectangle({1, 0.5}, {8, 4})),
                    turned_body("upper", make_quadrilateral_rectangle({1, 0.5}, {6, 3}), {0, 0.5 + gap, 0})});
  scene.fixes = {held_along("lower", plane(1, 0), only_z)};
  scene.loads = {traction_on("upper", plane(1, 1 + gap), {0, -1e3, 0})};
  const Frame frame = converged_end_of(scene).frame();
  EXPECT_NEAR(reaction_of(frame, "lower").y(), 1e3 * pi, 1e-8 * 1e3 * pi);
  ASSERT_EQ(frame.contacts.size(), 1U);
  EXPECT_NEAR(std::abs(frame.contacts[0].force.y()), 1e3 * pi, 1e-8 * 1e3 * pi);
}

TEST(AxisymmetricContact, TheAxisIsNoSurface) {
  Description scene = pressed_on_a_floor(0, true, 1);
  scene.contact.with_themselves = true;
  const World world(scene);
  ASSERT_NE(world.contact, nullptr);
  const ContactSurface& surface = world.contact->surface();
  const VectorX places = surface.places(world.rest_positions);
  int num_on_axis = 0;
  for (std::size_t v = 0; v < surface.parts.num_vertices(); ++v)
    if (places[2 * static_cast<Eigen::Index>(v)] == 0) {
      ++num_on_axis;
      EXPECT_GT(surface.point_areas[v], 0);
    }
  EXPECT_EQ(num_on_axis, 2);  // ends of the top and the bottom
  EXPECT_EQ(world.contact->smallest_gap(world.start_positions).distance,
            std::numeric_limits<double>::infinity());
}

/// Pressed on a shaft from outside, then the shaft is drawn out.
TEST(AxisymmetricContact, AShaftIsDrawnOutAgainstFrictionTimesTheNormalForce) {
  Description scene =
      turned_scene({turned_body("ring", make_quadrilateral_rectangle({0.5, 0.5}, {4, 4}), {1, 0, 0})});
  scene.fixes = {held_along("ring", plane(0, 1.5), only_z)};
  LoadDescription press = traction_on("ring", plane(0, 1.5), {-2e3, 0, 0});
  press.time_function.form = TimeFunction::Ramp{.from = 0, .until = 0.5};
  scene.loads = {press};
  scene.colliders = {half_space("shaft", {1 - gap / 2, 0, 0}, {1, 0, 0})};
  scene.colliders[0].friction = 0.3;
  scene.colliders[0].displacement = {0, 0.2, 0};
  scene.colliders[0].time_function.form = TimeFunction::Ramp{.from = 0.5, .until = 1};
  scene.load_steps = 10;
  const Frame frame = converged_end_of(scene).frame();
  const Vector3 force = reaction_of(frame, "shaft");
  EXPECT_GT(force.x(), 2e3);
  EXPECT_NEAR(force.y(), 0.3 * force.x(), 1e-6 * force.x());
  EXPECT_NEAR(reaction_of(frame, "ring").y(), -force.y(), 1e-6 * force.x());
}

/// Stiff rings, whose surfaces hardly tilt. They start at the end of the activation distance.
TEST(AxisymmetricContact, ARingIsDrawnOutOfAnotherAgainstFrictionTimesTheNormalForce) {
  constexpr double apart = 0.0024;
  Description scene = turned_scene(
      {turned_body("inner", make_quadrilateral_rectangle({0.5, 0.9}, {4, 6}), {1, -0.3, 0}),
       turned_body("outer", make_quadrilateral_rectangle({0.5, 0.5}, {4, 4}), {1.5 + apart, 0, 0})});
  for (BodyDescription& body : scene.bodies) body.material.constants["youngs_modulus"] = 1e7;
  scene.fixes = {held_along("inner", plane(0, 1), r_and_z, {0, 0.13, 0}),
                 held_along("outer", plane(0, 2 + apart), only_z)};
  scene.fixes[0].time_function.form = TimeFunction::Ramp{.from = 0.5, .until = 1};
  LoadDescription press = traction_on("outer", plane(0, 2 + apart), {-2e3, 0, 0});
  press.time_function.form = TimeFunction::Ramp{.from = 0, .until = 0.5};
  scene.loads = {press};
  scene.contact.friction = 0.3;
  scene.load_steps = 10;
  const Frame frame = converged_end_of(scene).frame();
  ASSERT_EQ(frame.contacts.size(), 1U);
  const Vector3 force = frame.contacts[0].force;  // with friction
  EXPECT_GT(std::abs(force.x()), 2e3);
  EXPECT_NEAR(std::abs(force.y()), 0.3 * std::abs(force.x()), 5e-3 * std::abs(force.x()));
  EXPECT_NEAR(std::abs(reaction_of(frame, "outer").y()), std::abs(force.y()), 1e-6 * std::abs(force.y()));
}

/// A tube between rough plates beside a quarter of it in 3D.
TEST(AxisymmetricContact, ATubeIsPressedAsAQuarterOfItIn3D) {
  const auto press = [](Description scene, int up) {
    const Vector3 axis = Vector3::Unit(up);
    scene.colliders = {half_space("floor", -gap * axis, axis),
                       half_space("press", (0.5 + gap) * axis, -axis)};
    for (ColliderDescription& plate : scene.colliders) {
      plate.activation_distance = 2 * gap;
      plate.friction = 0.5;
    }
    scene.colliders[1].displacement = -0.05 * axis;
    scene.load_steps = 2;
    return reaction_of(converged_end_of(scene).frame(), "press")[up];
  };
  Description quarter;
  quarter.bodies = {turned_body("tube", make_round({.kind = RoundKind::tube,
                                                    .radius = 2,
                                                    .inner_radius = 1,
                                                    .height = 0.5,
                                                    .degrees = 90,
                                                    .radial_cells = 4,
                                                    .around_cells = 12,
                                                    .axial_cells = 4,
                                                    .is_cut = false}))};
  quarter.bodies[0].element = "Q1";
  quarter.fixes = {held_along("tube", group("start"), {false, true, false}),
                   held_along("tube", group("end"), {true, false, false})};
  quarter.fixes[1].name = "end";
  const double of_quarter = press(quarter, 2);
  const double of_turn = press(
      turned_scene({turned_body("tube", make_quadrilateral_rectangle({1, 0.5}, {4, 4}), {1, 0, 0})}), 1);
  EXPECT_NEAR(of_turn, 4 * of_quarter, 0.01 * std::abs(of_turn));
}

/// A half-space, and a plate of lines that reaches over the axis.
TEST(AxisymmetricContact, APlateOfLinesPressesAsAHalfSpaceDoes) {
  const auto force = [](bool is_box) {
    Description scene = turned_scene({turned_body("disc", make_quadrilateral_rectangle({1, 0.5}, {8, 4}))});
    scene.fixes = {held_along("disc", plane(1, 0), only_z)};
    scene.colliders = {half_space("plate", {0, 0.5 + gap, 0}, {0, -1, 0})};
    if (is_box) {
      scene.colliders[0].kind = "box";
      scene.colliders[0].shape.center = {0, 1 + gap, 0};
      scene.colliders[0].shape.size = {4, 1, 1};
    }
    scene.colliders[0].displacement = {0, -0.1, 0};
    return reaction_of(converged_end_of(scene).frame(), "plate").y();
  };
  EXPECT_NEAR(force(true), force(false), 1e-4 * std::abs(force(false)));
}

/// A quarter of a disc of radius 1 in r and z, fine where it touches the plane z = 0.
Mesh graded_ball(int count, double finest) {
  double growth = 1.2;  // ratio of lengths of neighbours: `count` of them reach from 0 to 1
  for (int i = 0; i < 200; ++i) growth = std::pow(1 + (growth - 1) / finest, 1.0 / count);
  const auto graded = [&](double share) {
    return finest * (std::pow(growth, share * count) - 1) / (growth - 1);
  };
  Mesh mesh = make_quadrilateral_rectangle({1, 1}, {count, count});
  for (Vector3& X : mesh.vertices) {
    const double a = graded(X.x()), b = 1 - graded(X.y());
    X = {a * std::sqrt(1 - b * b / 2), 1 - b * std::sqrt(1 - a * a / 2), 0};
  }
  return mesh;
}

/// F = 4/3 E/(1 - nu^2) R^(1/2) d^(3/2).
TEST(AxisymmetricContact, ABallOnAPlaneCarriesTheForceOfHertz) {
  constexpr double reach = 1e-6, approach = 1e-4;
  Description scene = turned_scene({turned_body("ball", graded_ball(28, 1e-3), {0, 0.95 * reach, 0})});
  scene.bodies[0].material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", 0.3}};
  Where middle = plane(1, 1 + 0.95 * reach);
  scene.fixes = {held_along("ball", middle, only_z, {0, -approach, 0})};
  scene.colliders = {half_space("floor", {0, 0, 0}, {0, 1, 0})};
  scene.colliders[0].activation_distance = reach;
  scene.load_steps = 4;
  const double expected = 4.0 / 3 * 1e6 / (1 - 0.09) * std::pow(approach, 1.5);
  EXPECT_NEAR(reaction_of(converged_end_of(scene).frame(), "floor").y(), expected, 0.03 * expected);
}

/// A circle on the axis is a ball, one beside it a torus; each pushes a disc of which it meets nodes.
TEST(AxisymmetricContact, CirclesAreBallsAndTori) {
  for (const double center : {0.0, 0.5}) {
    Description scene = turned_scene({turned_body("disc", make_rectangle({1, 0.5}, {12, 6}))});
    scene.fixes = {held_along("disc", plane(1, 0), r_and_z)};
    scene.colliders.resize(1);
    ColliderDescription& ball = scene.colliders[0];
    ball.name = "ball";
    ball.kind = "sphere";
    ball.shape.center = {center, 0.5 + 0.2 + gap, 0};
    ball.shape.radius = 0.2;
    ball.displacement = {0, -0.1, 0};
    scene.load_steps = 4;
    const Frame frame = converged_end_of(scene).frame();
    const double force = reaction_of(frame, "ball").y();
    EXPECT_LT(force, -100);
    EXPECT_NEAR(reaction_of(frame, "disc").y(), -force, 1e-7 * std::abs(force));
  }
}

TEST(AxisymmetricContact, RefusesWhatItHasNot) {
  const auto refusal = [](const auto& change) {
    Description scene = pressed_on_a_floor(1, true, 1);
    change(scene);
    return refusal_of(scene);
  };
  EXPECT_EQ(refusal([](Description&) {}), "");
  EXPECT_THAT(refusal([](Description& d) { d.colliders[0].rotate.emplace(); }), HasSubstr("a rotation"));
  EXPECT_THAT(refusal([](Description& d) { d.colliders[0].shape.point.y() = -1; }),
              HasSubstr("\"ring\" is not constrained: 1 of 1 rigid-body motions are free in a static "
                        "analysis: translation along y"));
}

}  // namespace
}  // namespace resilin::testing
