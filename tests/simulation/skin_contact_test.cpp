// Bodies that meet others, themselves and colliders with their skins, in motion and at rest.

#include <gtest/gtest.h>

#include <cmath>

#include "resilin/contact/crossing.hpp"
#include "resilin/mesh/edit.hpp"
#include "round_skin.hpp"
#include "same_bits.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

void expect_skins_apart(const Simulation& simulation) {
  std::vector<std::shared_ptr<const SurfaceContact>> contacts(simulation.world().mesh_colliders.begin(),
                                                              simulation.world().mesh_colliders.end());
  if (simulation.world().contact) contacts.push_back(simulation.world().contact);
  for (const auto& contact : contacts) {
    const VectorX places =
        contact->surface().places(simulation.state().positions, conditions_of(simulation.state()));
    EXPECT_FALSE(first_crossing(contact->surface().parts, contact->meetings(), places))
        << "t = " << simulation.state().time;
  }
}

void run_with_skins_apart(Simulation& simulation) {
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
    expect_skins_apart(simulation);
  }
}

ColliderDescription skin_ground(const char* kind, double friction = 0) {
  ColliderDescription ground;
  ground.name = "ground";
  ground.kind = kind;
  ground.shape.normal = Vector3::UnitZ();
  ground.shape.center = {0, 0, -1};
  ground.shape.size = {20, 20, 2};
  ground.friction = friction;
  return ground;
}

/// Cubes of 0.2 m with balls in them, one above the other, fall on the ground.
Description falling_balls(const std::string& element, int num_cuts, bool is_smooth = false) {
  Description scene;
  scene.is_dynamic = true;
  scene.gravity = {0, 0, -9.81};
  scene.time_step = 0.01;
  scene.end_time = 0.4;
  for (const double z : {0.01, 0.22}) {
    BodyDescription body;
    body.name = z < 0.1 ? "lower" : "upper";
    body.element = element;
    body.mesh = make_box({0.2, 0.2, 0.2}, {3, 3, 3});
    body.material.law = "neo_hookean";
    body.material.constants = {{"youngs_modulus", 3e4}, {"poissons_ratio", 0.4}};
    body.skin = SkinDescription{.place = "skin",
                                .surface = ball_surface(0.1, {0.1, 0.1, 0.1}, num_cuts),
                                .surface_name = "ball.obj",
                                .is_smooth = is_smooth};
    body.contact_surface = MeetingSurface::skin;
    body.translate = {z < 0.1 ? 0 : 0.02, 0, z};
    scene.bodies.push_back(body);
  }
  scene.colliders = {skin_ground("half_space")};
  return scene;
}

double lowest_of_skin(const Simulation& simulation, std::size_t body) {
  const Skin& skin = *simulation.world().bodies[body].skin;
  std::vector<double> places(3 * static_cast<std::size_t>(skin.num_vertices()));
  skin.embedding.apply(simulation.state().positions, places);
  double lowest = places[2];
  for (std::size_t i = 2; i < places.size(); i += 3) lowest = std::min(lowest, places[i]);
  return lowest;
}

/// With the boundary of its cells as skin a body goes the same way as without one.
TEST(ASkinThatIsTheBoundary, ChangesNothing) {
  for (const char* kind : {"half_space", "box"}) {
    std::vector<VectorX> ends;
    for (const bool has_skin : {false, true}) {
      Description scene = falling_balls("P1", 1);
      scene.end_time = 0.2;
      scene.colliders = {skin_ground(kind, 0.3)};
      scene.contact.friction = 0.3;
      for (BodyDescription& body : scene.bodies) {
        body.skin->surface = extract_surface(body.mesh).mesh;
        body.contact_surface = has_skin ? MeetingSurface::skin : MeetingSurface::boundary;
        body.velocity = {0.3, 0, -1};
      }
      Simulation simulation(scene);
      run_with_skins_apart(simulation);
      ends.push_back(simulation.state().positions);
    }
    // Where a step of Newton's method ends is up to rounding.
    EXPECT_LT((ends[0] - ends[1]).cwiseAbs().maxCoeff(), 1e-7) << kind;
  }
}

TEST(SkinsOfEveryKind, KeepApartInMotion) {
  struct Case {
    const char* element;
    int num_cuts;
    bool is_smooth, with_itself;
    double friction;
  };
  for (const Case& each : {Case{"P1", 3, false, true, 0.5}, Case{"P1", 5, false, false, 0},
                           Case{"P1", 2, true, false, 0.3}, Case{"P2", 3, false, false, 0.3}}) {
    SCOPED_TRACE(std::string(each.element) + " " + std::to_string(each.num_cuts));
    Description scene = falling_balls(each.element, each.num_cuts, each.is_smooth);
    scene.end_time = 0.3;
    scene.contact.with_themselves = each.with_itself;
    scene.contact.friction = each.friction;
    scene.colliders = {skin_ground(each.with_itself ? "box" : "half_space", each.friction)};
    Simulation simulation(scene);
    run_with_skins_apart(simulation);
    EXPECT_GT(lowest_of_skin(simulation, 0), 0);
    EXPECT_LT(lowest_of_skin(simulation, 0), 0.01);
    EXPECT_GT(lowest_of_skin(simulation, 1), 0.05);
  }
}

/// One body with a skin and one without; the cells of the one may be where the other is.
TEST(ASkin, MeetsTheBoundaryOfAnotherBody) {
  Description scene = falling_balls("P1", 3);
  scene.bodies[1].skin.reset();
  scene.bodies[1].contact_surface = MeetingSurface::boundary;
  scene.bodies[1].translate = {0.1, 0.1, 0.215};
  Simulation simulation(scene);
  run_with_skins_apart(simulation);
  EXPECT_GT(simulation.frame().contact_energy, 0);
}

/// At rest a ball stands on its lowest vertices, which bear its weight.
TEST(ABallInACube, RestsOnItsSkin) {
  for (const char* element : {"P1", "P2"})
    for (const char* kind : {"half_space", "box"}) {
      SCOPED_TRACE(std::string(element) + " on a " + kind);
      Description scene = falling_balls(element, 3);
      scene.bodies.resize(1);
      scene.bodies[0].translate.z() = 2e-4;
      scene.is_dynamic = false;
      scene.colliders = {skin_ground(kind)};
      FixDescription sides;
      sides.name = "sides";
      sides.components = {true, true, false};
      scene.fixes = {sides};
      const Simulation simulation = converged_end_of(scene);
      const double reach = 0.005 * 0.2, gap = lowest_of_skin(simulation, 0);
      EXPECT_GT(gap, 0);
      EXPECT_LT(gap, reach);
      const double weight = 1000 * 9.81 * 0.008;
      EXPECT_NEAR(simulation.frame().reactions.back().second.z(), weight, 1e-6 * weight);
      // Cells reach below: nothing keeps them out.
      double lowest = 1;
      for (Index node = 0; node < simulation.world().num_nodes(); ++node)
        lowest = std::min(lowest, simulation.state().positions[Eigen::Index{node} * 3 + 2]);
      EXPECT_LT(lowest, gap);
    }
}

TEST(ARunOfSkins, HasTheSameBitsHoweverItIsRun) {
  Description scene = falling_balls("P1", 3);
  scene.end_time = 0.2;
  scene.contact.friction = 0.4;
  expect_same_bits_however_it_is_run(scene, 11);
}

}  // namespace
}  // namespace resilin::testing
