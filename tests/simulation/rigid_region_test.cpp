// Rigid regions of bodies, whose soft cells share their vertices: [[body.region]] rigid = true.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "every_integrator.hpp"
#include "reference_case.hpp"
#include "resilin/core/error.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/world/rigid_region.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

Where far_half() {
  Where where;
  where.kind = Where::Kind::box;
  where.min = {0.5, -1, -1};
  where.max = {2, 1, 1};
  return where;
}

/// A bar whose far half is rigid, of 2000 kg/m^3; with `modulus` it is a stiff material instead.
Description bar_with_rigid_end(int dimension, bool is_dynamic, std::optional<double> modulus = {}) {
  Description scene = small_bar(dimension, is_dynamic);
  scene.newton.tolerance = 1e-11;
  RegionDescription region;
  region.place = "bar.toml: body[0].region[0]";
  region.name = "tool";
  region.where = far_half();
  if (modulus) {
    region.material.law = "neo_hookean";
    region.material.constants = {{"youngs_modulus", *modulus}, {"poissons_ratio", 0.3}};
    region.material.density = 2000;
  } else {
    region.rigid = RigidDescription{.place = region.place + ".rigid", .density = 2000};
  }
  scene.bodies[0].regions.push_back(region);
  add_rigid_regions(scene);
  return scene;
}

/// All vertices of the bar [m].
VectorX displacements_of_bar(const Simulation& simulation) {
  const World& world = simulation.world();
  const Eigen::Index size = Eigen::Index{world.bodies[0].num_vertices} * world.dimension;
  return simulation.state().positions.head(size) - world.rest_positions.head(size);
}

TEST(RigidRegions, AreWhatStiffOnesTendTo) {
  for (const int dimension : {2, 3})
    for (const std::string element : {"P1", "P2", "P2P0"}) {
      if (dimension == 3 && element == "P2") continue;
      const auto run = [&](std::optional<double> modulus) {
        Description scene = bar_with_rigid_end(dimension, false, modulus);
        scene.newton.tolerance = 1e-9;
        scene.bodies[0].element = element;
        scene.bodies[0].material.law = "neo_hookean_simo";
        LoadDescription push;
        push.kind = "traction";
        push.body = scene.bodies[0].name;
        push.where = plane(0, 1);
        push.value = dimension == 3 ? Vector3(50, 20, -30) : Vector3(50, -30, 0);
        scene.loads.push_back(push);
        return displacements_of_bar(converged_end_of(scene));
      };
      const VectorX rigid = run({}), stiff = run(1e9);
      EXPECT_LT((rigid - stiff).norm(), 2e-4 * stiff.norm()) << dimension << ", " << element;
    }
}

/// By the report the rigid body has the mass of the region, and moves with it.
TEST(RigidRegions, MoveAsRigidBodies) {
  const Simulation simulation = converged_end_of(bar_with_rigid_end(3, true));
  const World& world = simulation.world();
  ASSERT_EQ(world.bodies.size(), 2U);
  EXPECT_EQ(world.bodies[1].name, "body.tool");
  EXPECT_NEAR(world.mass->nodal.sum(), 0.03125 * (1000 + 2000), 1e-9);
  ASSERT_EQ(simulation.frame().rigid_bodies.size(), 1U);
  const Frame::RigidMotion& motion = simulation.frame().rigid_bodies[0];
  const Eigen::Quaterniond turn(motion.rotation[0], motion.rotation[1], motion.rotation[2],
                                motion.rotation[3]);
  const Vector3 centre(0.75, 0.125, 0.125), corner(1, 0.25, 0.25);
  const Vector3 expected = motion.position + turn * (corner - centre);
  EXPECT_LT((expected - corner - simulation.frame().probes[0].displacement).norm(), 1e-5);
  EXPECT_GT(simulation.frame().probes[0].displacement.norm(), 0.05);
}

TEST(RigidRegions, MoveAsStiffOnesDo) {
  for (const int dimension : {2, 3}) {
    const auto run = [&](std::optional<double> modulus) {
      Description scene = bar_with_rigid_end(dimension, true, modulus);
      scene.integrator = "tr_bdf2";
      scene.time_step = 0.01;
      scene.bodies[0].mass = MassKind::consistent;  // exact, as the rigid body's
      return displacements_of_bar(converged_end_of(scene));
    };
    const VectorX rigid = run({}), stiff = run(1e9);
    EXPECT_LT((rigid - stiff).norm(), 1e-3 * stiff.norm()) << dimension;
  }
}

/// A bar that flies and tumbles keeps its momenta and, nearly, its energy.
TEST(RigidRegions, KeepMomentumAndEnergy) {
  for (const int dimension : {2, 3}) {
    Description scene = bar_with_rigid_end(dimension, true);
    scene.gravity.setZero();
    scene.fixes.clear();
    scene.integrator = "tr_bdf2";
    scene.time_step = 1e-3;
    scene.end_time = 0.2;
    for (BodyDescription& body : scene.bodies) {
      body.velocity = {0.3, 0.2, 0};
      body.velocity_gradient << 0, -2, 0, 2, 0, 0, 0, 0, 0;
    }
    const Simulation start(scene), end = converged_end_of(scene);
    const Frame &before = start.frame(), &after = end.frame();
    EXPECT_LT((after.linear_momentum - before.linear_momentum).norm(), 1e-8 * before.linear_momentum.norm());
    EXPECT_LT((after.angular_momentum - before.angular_momentum).norm(),
              1e-4 * before.angular_momentum.norm());
    EXPECT_NEAR(after.kinetic_energy + after.elastic_energy, before.kinetic_energy,
                2e-3 * before.kinetic_energy);
  }
}

/// A support of the region's face turns all of it: the rest of the bar is twisted.
TEST(RigidRegions, AreHeldByTheirVertices) {
  Description scene = bar_with_rigid_end(3, false);
  scene.gravity.setZero();
  FixDescription turn;
  turn.name = "turn";
  turn.body = "body";
  turn.where = plane(0, 1);
  turn.rotate = Rotation{.axis = {1, 0, 0}, .center = {0, 0.125, 0.125}, .degrees = 40};
  scene.fixes.push_back(turn);
  const Simulation region = converged_end_of(scene);
  Description whole = small_bar(3, false);
  whole.gravity.setZero();
  whole.newton.tolerance = 1e-11;
  turn.where = far_half();
  whole.fixes.push_back(turn);
  const Simulation fixed = converged_end_of(whole);
  const VectorX expected = displacements_of_bar(fixed);
  EXPECT_LT((displacements_of_bar(region) - expected).norm(), 1e-8 * expected.norm());
  for (std::size_t support = 0; support < 2; ++support)
    EXPECT_LT((region.frame().reactions[support].second - fixed.frame().reactions[support].second).norm(),
              1e-6);
}

TEST(RigidRegions, AreJoined) {
  // A ball joins the whole body at a vertex of the region, a hinge the region itself.
  for (const bool is_hinge : {true, false}) {
    Description scene = bar_with_rigid_end(3, false);
    JointDescription joint;
    joint.name = "joint";
    joint.kind = is_hinge ? JointKind::hinge : JointKind::ball;
    joint.bodies = {is_hinge ? "body.tool" : "body"};
    joint.at = {1, 0.125, 0};
    joint.axis = {0, 1, 0};
    scene.joints.push_back(joint);
    const Simulation simulation = converged_end_of(scene);
    ASSERT_EQ(simulation.frame().joints.size(), 1U);
    const double weight = 9.81 * 0.03125 * 3000;
    const Vector3 sum = simulation.frame().joints[0].force + simulation.frame().reactions[0].second;
    EXPECT_LT((sum - Vector3(0, 0, weight)).norm(), 1e-5 * weight);
  }
}

/// Loads, colliders and results take the body as one.
TEST(RigidRegions, ShareTheSurfaceOfTheirBody) {
  Description scene = bar_with_rigid_end(3, false);
  scene.gravity.setZero();
  LoadDescription push;
  push.kind = "force";
  push.body = "body";
  push.where = plane(2, 0.25);
  push.value = {0, 0, -5};
  scene.loads.push_back(push);
  const Simulation simulation = converged_end_of(scene);
  EXPECT_LT((simulation.frame().reactions[0].second - Vector3(0, 0, 5)).norm(), 1e-6);

  const World& world = simulation.world();
  FieldEvaluator fields(world);
  const std::vector<std::string> names = {"von_mises", "averaged_von_mises"};
  const std::vector<FieldValues> values = fields.evaluate(simulation.state(), names);
  const Body& body = world.bodies[0];
  for (Index cell = 0; cell < body.num_cells(); ++cell)
    EXPECT_EQ(std::isnan(values[0].values[static_cast<std::size_t>(cell)]),
              body.domains.of_cell(cell).is_rigid);
  for (Index node = 0; node < body.num_nodes; ++node)
    EXPECT_EQ(std::isnan(values[1].values[static_cast<std::size_t>(node)]),
              world.rest_positions[Eigen::Index{node} * 3] > 0.5 + 1e-9);

  scene.loads.clear();
  ColliderDescription plate;
  plate.name = "plate";
  plate.kind = "half_space";
  plate.shape.point = {0, 0, 0.26};
  plate.shape.normal = {0, 0, -1};
  plate.displacement = {0, 0, -0.06};
  scene.colliders.push_back(plate);
  const Simulation pressed = converged_end_of(scene);
  EXPECT_LT(pressed.frame().probes[0].displacement.z(), -0.04);
}

/// Two rigid regions that share a face are one body; with one vertex in common they are a ball joint.
TEST(RigidRegions, MayTouchEachOther) {
  Description scene = small_bar(3, false);
  scene.newton.tolerance = 1e-11;
  for (const double low : {0.5, 0.75}) {
    RegionDescription region;
    region.place = "region";
    region.name = low < 0.6 ? "first" : "second";
    region.where = far_half();
    region.where.min.x() = low;
    region.where.max.x() = low + 0.25;
    region.rigid = RigidDescription{.density = 2000};
    scene.bodies[0].regions.push_back(region);
  }
  add_rigid_regions(scene);
  const VectorX two = displacements_of_bar(converged_end_of(scene)),
                one = displacements_of_bar(converged_end_of(bar_with_rigid_end(3, false)));
  EXPECT_LT((two - one).norm(), 1e-5 * one.norm());
}

TEST(RigidRegions, AreRefusedInOneLine) {
  const auto refusal = [](const auto& spoil) {
    Description scene = bar_with_rigid_end(3, true);
    spoil(scene);
    return refusal_of(scene);
  };
  EXPECT_THAT(
      refusal([](Description& scene) {
        FixDescription edge;
        edge.place = "bar.toml: fix[1]";
        edge.name = "edge";
        edge.body = "body";
        edge.where.kind = Where::Kind::box;
        edge.where.min = {0.99, -1, 0.24};
        edge.where.max = {1.01, 1, 0.26};
        scene.fixes.push_back(edge);
      }),
      HasSubstr("bar.toml: fix[1].where: expected vertices that hold the rigid region \"body.tool\" as "
                "a whole, or none of it, got points in a line"));
  EXPECT_THAT(refusal([](Description& scene) { scene.bodies[1].rigid->density.reset(); }),
              HasSubstr("expected a density for a rigid body with weight or inertia"));
  EXPECT_THAT(refusal([](Description& scene) { scene.modes = ModesOptions{}, scene.is_dynamic = false; }),
              HasSubstr("region[0]: expected a scene without rigid regions for modal analysis"));
  EXPECT_THAT(refusal([](Description& scene) {
                SectionDescription section;
                section.name = "cut";
                section.body = "body";
                section.at = 0.3;
                scene.sections.push_back(section);
              }),
              HasSubstr("expected a body without rigid regions"));
  Description all = small_bar(3, false);
  RegionDescription region;
  region.name = "all";
  region.rigid.emplace();
  all.bodies[0].regions.push_back(region);
  EXPECT_THROW(add_rigid_regions(all), InputError);
}

}  // namespace
}  // namespace resilin::testing
