// Bodies against rigid surfaces that stand, move and turn: boxes, capsules, cylinders, meshes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "resilin/contact/crossing.hpp"
#include "resilin/world/colliders.hpp"
#include "same_bits.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

Conditions now(const State& state) {
  return {.time = state.time, .load = state.load, .delay = state.collider_delay};
}

/// Expects that no edge goes through a facet, by exact predicates, and that nothing touches.
void expect_apart(const Simulation& simulation) {
  const State& state = simulation.state();
  for (const auto& collider : simulation.world().mesh_colliders) {
    const ContactSurface& surface = collider->surface();
    const VectorX places = surface.places(state.positions, now(state));
    EXPECT_FALSE(first_crossing(surface.parts, collider->meetings(), places)) << state.time;
    EXPECT_GT(collider->smallest_gap(state.positions, now(state)).distance, 0) << state.time;
  }
}

void run_apart(Simulation& simulation) {
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged)
        << simulation.state().time << ": " << report.reason;
    expect_apart(simulation);
    if (::testing::Test::HasFailure()) return;
  }
}

/// A ball of tetrahedra: a cube whose shells are rounded.
Mesh ball_mesh(double radius, int n) {
  Mesh mesh = make_box({2, 2, 2}, {n, n, n}, {-1, -1, -1});
  for (Vector3& X : mesh.vertices)
    if (X.norm() > 0) X *= radius * X.cwiseAbs().maxCoeff() / X.norm();
  return mesh;
}

Description soft_body_in_motion(Mesh mesh, double end_time) {
  Description scene;
  scene.is_dynamic = true;
  scene.gravity = {0, 0, -9.81};
  scene.time_step = 0.01;
  scene.end_time = end_time;
  BodyDescription body;
  body.element = "P1";
  body.mesh = std::move(mesh);
  body.material.constants = {{"youngs_modulus", 2e4}, {"poissons_ratio", 0.4}};
  scene.bodies.push_back(body);
  return scene;
}

ColliderDescription box_collider(const Vector3& center, const Vector3& size) {
  ColliderDescription box;
  box.name = box.kind = "box";
  box.shape.center = center;
  box.shape.size = size;
  return box;
}

ColliderDescription collider_of_mesh(Mesh mesh) {
  ColliderDescription collider;
  collider.name = collider.kind = "mesh";
  collider.shape.mesh_name = "mesh.obj";
  collider.shape.mesh = std::move(mesh);
  return collider;
}

/// Rings about the z axis, open at both ends.
Mesh surface_of_revolution(const std::vector<std::array<double, 2>>& radius_and_height, Index sides) {
  Mesh mesh;
  CellBlock& triangles = mesh.block(CellKind::triangle);
  for (const auto& [radius, height] : radius_and_height)
    for (Index i = 0; i < sides; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides;
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
    }
  for (Index ring = 0; ring + 1 < static_cast<Index>(radius_and_height.size()); ++ring)
    for (Index i = 0; i < sides; ++i) {
      const Index a = ring * sides + i, b = ring * sides + (i + 1) % sides;
      triangles.nodes.insert(triangles.nodes.end(), {a, b, b + sides, a, b + sides, a + sides});
    }
  return mesh;
}

double mean_height(const Simulation& simulation) {
  const VectorX& x = simulation.state().positions;
  const int dim = simulation.world().dimension;
  return x(Eigen::seq(dim - 1, Eigen::last, dim)).mean();
}

/// Under its weight, held sideways, a block is as high on a floor of triangles as on a half-space.
TEST(ABlockOnABox, RestsAsOnAHalfSpace) {
  std::vector<double> heights, forces;
  for (const bool is_box : {false, true}) {
    Description scene = soft_body_in_motion(make_box({1, 1, 0.5}, {3, 3, 2}, {0, 0, 0.003}), 1);
    scene.is_dynamic = false;
    FixDescription sides;
    sides.name = "sides";
    sides.components = {true, true, false};
    scene.fixes.push_back(sides);
    ColliderDescription floor = box_collider({0.4, 0.6, -0.5}, {4, 5, 1});
    if (!is_box) {
      floor.kind = "half_space";
      floor.shape.normal = Vector3::UnitZ();
    }
    floor.name = "floor";
    scene.colliders = {floor};
    const Simulation simulation = converged_end_of(scene);
    heights.push_back(mean_height(simulation));
    EXPECT_EQ(simulation.frame().reactions[1].first, "floor");
    forces.push_back(simulation.frame().reactions[1].second.z());
  }
  const double weight = 0.5 * 1000 * 9.81;
  EXPECT_NEAR(forces[0], weight, 1e-7 * weight);
  EXPECT_NEAR(forces[1], weight, 1e-7 * weight);
  EXPECT_NEAR(heights[1], heights[0], 0.02 * 0.005);  // tolerance relative to the activation distance
}

/// A belt takes a block along by its friction, at mu g until it is as fast; a turning table does so in a
/// circle.
TEST(ABlockOnABox, IsTakenAlongByFriction) {
  for (const bool turns : {false, true}) {
    Description scene = soft_body_in_motion(make_box({0.2, 0.2, 0.1}, {2, 2, 1}, {-0.1, -0.1, 0}), 0.4);
    scene.bodies[0].material.constants["youngs_modulus"] = 1e6;
    const double radius = turns ? 2 : 0;
    scene.bodies[0].translate = {radius, 0, 0.6e-3};
    ColliderDescription floor = box_collider({0, 0, -0.5}, {9, 9, 1});
    floor.friction = 0.5;
    if (turns) {
      floor.rotate = ColliderTurn{.axis = {0, 0, 1}, .center = {0, 0, 0}, .degrees_per_second = 10};
    } else {
      floor.velocity = {0.4, 0, 0};
    }
    scene.colliders = {floor};
    Simulation simulation(scene);
    run_apart(simulation);
    const Frame& frame = simulation.frame();
    const double mass = 4;  // kg
    const double speed = turns ? 10 * std::numbers::pi / 180 * radius : 0.4;
    EXPECT_NEAR(frame.linear_momentum.norm() / mass, speed, 0.02 * speed) << turns;
    EXPECT_GT(frame.linear_momentum[turns ? 1 : 0], 0.9 * mass * speed);
    EXPECT_GT(frame.dissipated_energy, 0);
  }
}

TEST(ASoftBall, FallsThroughAFunnelThatIsNarrowerThanItself) {
  Description scene = soft_body_in_motion(ball_mesh(0.1, 4), 1.2);
  scene.bodies[0].translate = {0.02, 0.01, 0.35};
  scene.colliders = {
      collider_of_mesh(surface_of_revolution({{0.4, 0.3}, {0.25, 0.15}, {0.085, 0}, {0.085, -0.08}}, 24))};
  Simulation simulation(scene);
  run_apart(simulation);
  EXPECT_LT(mean_height(simulation), -0.2);
}

/// Statics: what a box presses is what the support bears, and the work is where it went.
TEST(ABoxThatPressesABlock, IsBorneByItsSupport) {
  for (const int dim : {2, 3}) {
    Description scene;
    scene.dimension = dim;
    scene.load_steps = 3;
    BodyDescription body;
    body.element = "P1";
    body.mesh = dim == 3 ? make_box({1, 1, 1}, {4, 4, 4}) : make_rectangle({1, 1}, {6, 6});
    scene.bodies.push_back(body);
    FixDescription foot;
    foot.name = "foot";
    foot.where.kind = Where::Kind::plane;
    foot.where.axis = dim - 1;
    scene.fixes.push_back(foot);
    const Vector3 up = Vector3::Unit(dim - 1);
    ColliderDescription stamp =
        box_collider(Vector3(0.5, dim == 3 ? 0.4 : 0, 0) + 1.21 * up, {0.5, dim == 3 ? 0.5 : 0.4, 0.4});
    stamp.displacement = -0.1 * up;
    scene.colliders = {stamp};
    const Simulation simulation = converged_end_of(scene);
    expect_apart(simulation);
    const Frame& frame = simulation.frame();
    const double size = frame.reactions[1].second.norm();
    EXPECT_LT(frame.reactions[1].second.dot(up), -1000);  // N
    EXPECT_LT((frame.reactions[0].second + frame.reactions[1].second).norm(), 1e-6 * size);
    EXPECT_LT((frame.reaction_torques[0] + frame.reaction_torques[1]).norm(), 1e-6 * size);
  }
}

TEST(ABodyOnABoxThatRises, IsLifted) {
  Description scene = soft_body_in_motion(make_box({0.4, 0.4, 0.2}, {4, 4, 2}, {-0.2, -0.2, 0.005}), 0.6);
  ColliderDescription lift = box_collider({0, 0, -0.1}, {0.6, 0.6, 0.2});
  lift.velocity = {0, 0, 1};
  lift.until = 0.4;
  scene.colliders = {lift};
  Simulation simulation(scene);
  run_apart(simulation);
  EXPECT_GT(mean_height(simulation), 0.45);
  EXPECT_EQ(simulation.state().collider_delay, 0);
}

TEST(APaddleThatTurns, ThrowsABody) {
  Description scene = soft_body_in_motion(make_box({0.2, 0.2, 0.2}, {3, 3, 3}, {0.3, -0.1, 0.03}), 0.6);
  ColliderDescription paddle = box_collider({0.3, 0, 0}, {0.7, 0.4, 0.04});
  paddle.rotate = ColliderTurn{.axis = {0, -1, 0}, .center = {0, 0, 0}, .degrees_per_second = 240};
  paddle.until = 0.25;
  paddle.activation_distance = 0.01;
  scene.colliders = {paddle};
  Simulation simulation(scene);
  double highest = 0;
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
    expect_apart(simulation);
    highest = std::max(highest, mean_height(simulation));
  }
  EXPECT_GT(highest, 0.3);
}

/// Between rollers that turn and come nearer, a ball is squeezed and stays whole.
TEST(ABallBetweenRollers, IsSqueezed) {
  Description scene = soft_body_in_motion(ball_mesh(0.1, 4), 0.5);
  for (const double side : {-1.0, 1.0}) {
    ColliderDescription roller;
    roller.name = side < 0 ? "left" : "right";
    roller.kind = "cylinder";
    roller.shape.start = {0.22 * side, -0.3, -0.05};
    roller.shape.end = {0.22 * side, 0.3, -0.05};
    roller.shape.radius = 0.1;
    roller.rotate =
        ColliderTurn{.axis = {0, side, 0}, .center = {0.22 * side, 0, -0.05}, .degrees_per_second = 90};
    roller.displacement = {-0.06 * side, 0, 0};
    roller.time_function.form = TimeFunction::Ramp{.from = 0, .until = 0.3};
    scene.colliders.push_back(roller);
  }
  Simulation simulation(scene);
  run_apart(simulation);
  EXPECT_GT(simulation.frame().min_volume_ratio, 0);
}

/// Shafts that turn about their own axes carry what lies on them, their facets in its way or not.
TEST(ABlockOnRollers, IsCarriedAtTheirSpeed) {
  Description scene = soft_body_in_motion(make_box({0.4, 0.2, 0.04}, {8, 2, 1}, {-0.2, -0.1, 0.0003}), 0.4);
  for (const double x : {-0.15, 0.15, 0.45}) {
    ColliderDescription roller;
    roller.name = "at " + std::to_string(x);
    roller.kind = "cylinder";
    roller.shape.start = {x, -0.2, -0.1};
    roller.shape.end = {x, 0.2, -0.1};
    roller.shape.radius = 0.1;
    roller.friction = 0.5;
    roller.rotate = ColliderTurn{.axis = {0, 1, 0}, .center = {x, 0, -0.1}, .degrees_per_second = 180};
    scene.colliders.push_back(roller);
  }
  const Simulation simulation = converged_end_of(scene);
  EXPECT_EQ(simulation.state().collider_delay, 0);
  const double speed = 0.1 * std::acos(-1.0);
  VectorX momentum;
  simulation.world().mass->multiply(simulation.state().velocities, momentum);
  double along = 0;
  for (Index node = 0; node < simulation.world().num_nodes(); ++node)
    along += node_position(3, node, momentum).x();
  EXPECT_NEAR(along / simulation.world().bodies[0].mass, speed, 0.02 * speed);
}

/// A hopper of two lines and a pin of one point, in the plane.
TEST(ABodyInThePlane, SlidesAlongPolylinesAndRoundAPoint) {
  Description scene = soft_body_in_motion(make_rectangle({0.2, 0.2}, {4, 4}, {-0.1, 0.3}), 1);
  scene.dimension = 2;
  scene.gravity = {0, -9.81, 0};
  Mesh hopper;
  hopper.vertices = {{-0.6, 0.5, 0}, {-0.08, 0, 0}, {-0.08, -0.1, 0}, {0.08, -0.1, 0},
                     {0.08, 0, 0},   {0.6, 0.5, 0}, {0.01, -0.3, 0}};
  hopper.block(CellKind::line).nodes = {0, 1, 1, 2, 3, 4, 4, 5};
  hopper.block(CellKind::point).nodes = {6};
  scene.colliders = {collider_of_mesh(hopper)};
  Simulation simulation(scene);
  // The point may turn linear cells inside out where the law allows it; it never gets into the body.
  while (!simulation.is_finished()) {
    simulation.step();
    expect_apart(simulation);
  }
  EXPECT_LT(mean_height(simulation), -0.2);  // m: through the neck, and held up by the point
}

/// The same bits for any number of threads, and when a run is broken off and gone on with.
TEST(ACollidersRun, HasTheSameBitsHoweverItIsRun) {
  Description scene = soft_body_in_motion(make_box({0.2, 0.2, 0.2}, {3, 3, 3}, {0.3, -0.1, 0.03}), 0.2);
  ColliderDescription paddle = box_collider({0.3, 0, 0}, {0.7, 0.4, 0.04});
  paddle.rotate = ColliderTurn{.axis = {0, -1, 0}, .center = {0, 0, 0}, .degrees_per_second = 180};
  scene.colliders = {paddle};
  expect_same_bits_however_it_is_run(scene, 9);
}

// ---- scenes that cannot be

Description block_and(ColliderDescription collider, const Vector3& translate = Vector3::Zero()) {
  Description scene = soft_body_in_motion(make_box({0.2, 0.2, 0.2}, {2, 2, 2}, {-0.1, -0.1, -0.1}), 1);
  scene.bodies[0].translate = translate;
  collider.place = "collider[0]";
  scene.colliders = {std::move(collider)};
  return scene;
}

TEST(ABodyInsideAClosedCollider, IsRefusedWithTheWayOut) {
  const std::string refusal = refusal_of(block_and(box_collider({0, 0, 0}, {2, 2, 2})));
  EXPECT_THAT(
      refusal,
      HasSubstr("collider[0]: expected bodies that start outside, with a gap, got vertex 4 of \"body\" at "
                "(0, 0, -0.1), 0.9 m inside; move the body (translate) or the collider by 0.9"));
  const std::string corner = refusal_of(block_and(box_collider({1, 1, 1}, {2, 2, 2}), {-0.05, -0.05, -0.05}));
  EXPECT_THAT(corner,
              HasSubstr("of \"body\" at (0.05, 0.05, 0.05), 0.05 m inside; move the body (translate) or "
                        "the collider by 0.0505 m or more"));
}

TEST(ABodyThroughAnOpenCollider, IsRefused) {
  Mesh sheet;
  sheet.vertices = {{-1, -1, 0.03}, {1, -1, 0.03}, {0, 1, 0.03}};
  sheet.block(CellKind::triangle).nodes = {0, 1, 2};
  EXPECT_THAT(
      refusal_of(block_and(collider_of_mesh(sheet))),
      HasSubstr("collider[0]: expected bodies that start beside it, got \"body\" goes through it near"));
  for (Vector3& vertex : sheet.vertices) vertex.z() = 0.1;
  EXPECT_THAT(refusal_of(block_and(collider_of_mesh(sheet))), HasSubstr("on its surface; move the body"));
  for (Vector3& vertex : sheet.vertices) vertex.z() = 0.11;
  EXPECT_EQ(refusal_of(block_and(collider_of_mesh(sheet))), "");
}

TEST(AColliderInsideABody, IsRefused) {
  Mesh pin;
  pin.vertices = {{0.01, 0.02, 0.03}};
  EXPECT_THAT(refusal_of(block_and(collider_of_mesh(pin))),
              HasSubstr("expected bodies that start beside it, got one that is inside \"body\""));
  EXPECT_THAT(refusal_of(block_and(box_collider({0, 0, 0}, {0.1, 0.1, 0.1}))), HasSubstr("inside \"body\""));
}

/// Where the distance of colliders is a formula, only the vertices of bodies tell: a ball between them has
/// its surface.
TEST(ABallInsideABody, IsRefused) {
  ColliderDescription ball;
  ball.kind = "sphere";
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true}) {
      Description scene = small_bar(dimension, is_dynamic);
      ball.shape.center = {0.06, 0.06, dimension == 3 ? 0.06 : 0};
      ball.shape.radius = 0.05;
      ball.place = "collider[0]";
      scene.colliders = {ball};
      EXPECT_THAT(
          refusal_of(scene),
          HasSubstr("collider[0]: expected bodies that start beside it, got one that is inside \"body\""));
      // Its middle is outside: it stands through a side, between the vertices.
      scene.colliders[0].shape.center[dimension - 1] = -0.02;
      EXPECT_THAT(refusal_of(scene), HasSubstr("\"body\" goes through it near vertex"));
      scene.colliders[0].shape.center[dimension - 1] = -0.06;
      EXPECT_EQ(refusal_of(scene), "");
    }
}

TEST(AMeshOfACollider, IsRefusedWhereItIsNone) {
  Mesh mesh;
  mesh.vertices = {{2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {2, 1, 0}, {3, -1, 0}};
  EXPECT_EQ(refusal_of(block_and(collider_of_mesh(mesh))), "");  // five points
  mesh.block(CellKind::triangle).nodes = {0, 1, 2};
  EXPECT_THAT(
      refusal_of(block_and(collider_of_mesh(mesh))),
      HasSubstr("collider[0].mesh: mesh.obj: expected triangles with an area, got one without at (2, 0, 0)"));
  mesh.block(CellKind::triangle).nodes = {0, 1, 3, 0, 1, 4};
  EXPECT_EQ(refusal_of(block_and(collider_of_mesh(mesh))), "");
  mesh.block(CellKind::triangle).nodes = {0, 1, 3, 1, 0, 3};
  EXPECT_THAT(refusal_of(block_and(collider_of_mesh(mesh))),
              HasSubstr("two upon each other along the edge from (2, 0, 0) to (3, 0, 0)"));
  mesh.block(CellKind::triangle).nodes = {0, 1, 3};
  mesh.vertices[1].y() = std::nan("");
  EXPECT_THAT(refusal_of(block_and(collider_of_mesh(mesh))), HasSubstr("expected finite coordinates"));
  EXPECT_THAT(refusal_of(block_and(collider_of_mesh(Mesh{}))),
              HasSubstr("expected triangles, edges or points"));
}

}  // namespace
}  // namespace resilin::testing
