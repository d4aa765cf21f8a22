// Bodies against each other and themselves, at rest and in motion.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "every_integrator.hpp"
#include "resilin/contact/crossing.hpp"
#include "same_bits.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// By another way than contact itself: exact predicates.
bool has_crossing(const Simulation& simulation) {
  const SurfaceContact& contact = *simulation.world().contact;
  return first_crossing(contact.surface().parts, contact.meetings(),
                        contact.surface().places(simulation.state().positions))
      .has_value();
}

/// Every step converges, and after none do surfaces cross. @return whether they have touched
bool run_without_crossing(Simulation& simulation) {
  bool has_touched = false;
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
    EXPECT_FALSE(has_crossing(simulation)) << "t = " << simulation.state().time;
    if (report.status != StepReport::Status::converged) break;
    has_touched |= simulation.frame().contact_energy > 0;
  }
  return has_touched;
}

Vector3 momentum_of(const Simulation& simulation) {
  const World& world = simulation.world();
  VectorX p;
  world.mass->multiply(simulation.state().velocities, p);
  Vector3 sum = Vector3::Zero();
  for (Index node = 0; node < world.num_nodes(); ++node) sum += node_position(world.dimension, node, p);
  return sum;
}

/// A bar and a smaller one that is thrown at it, in space.
Description thrown_bars(int dimension, const std::string& element) {
  Description scene = small_bar(dimension, true);
  scene.gravity.setZero();
  scene.fixes.clear();
  scene.end_time = 0.3;
  scene.time_step = 0.01;
  scene.bodies[0].element = element;
  if (element.starts_with("Q"))
    scene.bodies[0].mesh = dimension == 3 ? make_hexahedron_box({1, 0.25, 0.25}, {4, 1, 1})
                                          : make_quadrilateral_rectangle({1, 0.25}, {4, 1});
  scene.bodies.push_back(scene.bodies[0]);
  BodyDescription& other = scene.bodies[1];
  other.name = "other";
  other.scale = 0.6;
  other.rotate = Rotation{.axis = dimension == 3 ? Vector3(1, 2, 3) : Vector3(0, 0, 1), .degrees = 50};
  other.translate = {0.45, 0.45, 0};
  other.velocity = {0, -3, 0};
  scene.probes[0].body = "body";
  return scene;
}

class BodiesInMotion : public WithEveryIntegrator {};
INSTANTIATE_TEST_SUITE_P(Catalogue, BodiesInMotion, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

TEST_P(BodiesInMotion, KeepApartAndTheirMomentum) {
  for (const int dimension : {2, 3}) {
    Description scene = thrown_bars(dimension, "P1");
    scene.integrator = integrator;
    Simulation simulation(scene);
    const Vector3 before = momentum_of(simulation);
    EXPECT_TRUE(run_without_crossing(simulation));
    EXPECT_LT((momentum_of(simulation) - before).norm(), 1e-6 * before.norm()) << dimension;
    EXPECT_GT(simulation.frame().kinetic_energy, 0);
  }
}

TEST(BodiesOfEveryElement, KeepApart) {
  for (const auto& [dimension, element] :
       {std::pair{2, "P2"}, {2, "Q1"}, {2, "P2P0"}, {3, "P2"}, {3, "Q1"}, {3, "P2P0"}}) {
    Description scene = thrown_bars(dimension, element);
    Simulation simulation(scene);
    EXPECT_TRUE(run_without_crossing(simulation)) << element << " " << dimension;
  }
}

/// A press that cannot be where it is led to stays behind, as colliders do.
TEST_P(BodiesInMotion, AreNotLedThroughEachOtherByTheirSupports) {
  for (const int dimension : {2, 3}) {
    const int up = dimension - 1;
    Description scene = small_bar(dimension, true);
    scene.integrator = integrator;
    scene.time_step = 0.05;
    scene.bodies[0].name = "lower";
    scene.bodies[0].material.law = "neo_hookean";
    scene.bodies.push_back(scene.bodies[0]);
    scene.bodies[1].name = "upper";
    scene.bodies[1].translate[up] = 0.27;
    scene.fixes[0].body = "lower";
    scene.fixes[0].where.axis = up;
    scene.fixes.push_back(scene.fixes[0]);
    FixDescription& press = scene.fixes[1];
    press.name = press.body = "upper";
    press.where.at = 0.52;
    press.velocity[up] = -16;  // in one step as far as both are high, and on
    scene.probes[0].body = "lower";
    Simulation simulation(scene);
    for (int step = 0; step < 3; ++step) {
      EXPECT_NE(simulation.step().status, StepReport::Status::converged) << dimension;
      EXPECT_FALSE(has_crossing(simulation)) << dimension << ", step " << step;
      EXPECT_GT(simulation.frame().min_volume_ratio, 0) << dimension << ", step " << step;
    }
  }
}

/// Held sideways everywhere, two cubes of one hexahedron are columns upon each other: each layer carries
/// what is above it.
TEST(ACubeOnACube, PressesItWithItsWeight) {
  Description scene;
  scene.gravity = {0, 0, -9.81};
  for (const double z : {0.0, 1.003}) {
    BodyDescription body;
    body.name = z == 0 ? "lower" : "upper";
    body.mesh = make_hexahedron_box({1, 1, 1}, {1, 1, 1}, {0, 0, z});
    body.element = "Q1";
    body.material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", 0.3}};
    scene.bodies.push_back(body);
    FixDescription sides;
    sides.body = sides.name = body.name;
    sides.components = {true, true, false};
    scene.fixes.push_back(sides);
  }
  FixDescription foot;
  foot.name = "foot";
  foot.body = "lower";
  foot.where.kind = Where::Kind::plane;
  foot.where.axis = 2;
  foot.components = {false, false, true};
  scene.fixes.push_back(foot);
  Simulation simulation(scene);
  EXPECT_TRUE(run_without_crossing(simulation));
  const Frame& frame = simulation.frame();
  EXPECT_EQ(frame.reactions[2].first, "foot");
  EXPECT_NEAR(frame.reactions[2].second.z(), 2 * 9810, 1e-7 * 9810);
  ASSERT_EQ(frame.contacts.size(), 1U);
  const auto& [body, other, force, gap, num_pairs] = frame.contacts[0];
  EXPECT_EQ(body, 0);
  EXPECT_EQ(other, 1);
  EXPECT_LT((force - Vector3(0, 0, 9810)).norm(), 1e-7 * 9810);
  EXPECT_GT(gap, 0);
  EXPECT_LT(gap, simulation.world().contact->activation_distance());
  EXPECT_GT(num_pairs, 0);
}

/// A ring of 1 m, pressed at its top and its bottom by `force` [N] each.
Description squeezed_ring(double force) {
  Description scene;
  scene.dimension = 2;
  scene.load_steps = 10;
  BodyDescription body;
  body.name = "ring";
  body.element = "P1";
  body.mesh = make_rectangle({1, 0.08}, {64, 2});
  // Closed: the vertices at the end are those at the beginning.
  Mesh& mesh = body.mesh;
  std::vector<Vector3> places;
  std::vector<Index> number(mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vector3& X = mesh.vertices[v];
    const double angle = -2 * std::acos(-1.0) * X.x(), radius = 0.5 - 0.08 + X.y();
    if (X.x() == 1) {
      for (std::size_t w = 0; w < v; ++w)
        if (mesh.vertices[w].x() == 0 && mesh.vertices[w].y() == X.y()) number[v] = number[w];
      continue;
    }
    number[v] = static_cast<Index>(places.size());
    places.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  for (CellBlock& block : mesh.blocks)
    for (Index& node : block.nodes) node = number[static_cast<std::size_t>(node)];
  mesh.vertices = places;
  mesh.groups.clear();
  std::erase_if(mesh.blocks, [](const CellBlock& block) { return block.kind != CellKind::triangle; });
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.3}};
  scene.bodies.push_back(body);
  scene.contact.with_themselves = true;
  for (const int axis : {0, 1}) {  // the ring is symmetric
    FixDescription fix;
    fix.name = axis == 0 ? "x" : "y";
    fix.where.kind = Where::Kind::plane;
    fix.where.axis = axis;
    fix.components = {axis == 0, axis == 1, false};
    scene.fixes.push_back(fix);
  }
  for (const double side : {-1.0, 1.0}) {
    LoadDescription press;
    press.name = side < 0 ? "bottom" : "top";
    press.kind = "nodal_force";
    press.where.kind = Where::Kind::box;
    press.where.min = {-1e-3, side < 0 ? -0.501 : 0.499, 0};
    press.where.max = {1e-3, side < 0 ? -0.499 : 0.501, 0};
    press.value = {0, -side * force, 0};
    scene.loads.push_back(press);
  }
  return scene;
}

TEST(ARing, TouchesItselfWhenItIsSqueezedFlat) {
  Simulation round(squeezed_ring(20));
  EXPECT_FALSE(run_without_crossing(round));
  Simulation flat(squeezed_ring(1000));
  EXPECT_TRUE(run_without_crossing(flat));
  Description through = squeezed_ring(1000);
  through.contact.with_themselves = false;
  EXPECT_EQ(World(through).contact, nullptr);
}

TEST(BodiesThatTouch, GiveTheSameBitsForAnyNumberOfThreadsAndAfterACheckpoint) {
  const Description scene = thrown_bars(3, "P1");
  expect_same_bits_for_any_number_of_threads(scene);
  expect_same_bits_after_a_checkpoint(scene, 14);
}

}  // namespace
}  // namespace resilin::testing
