#include "resilin/live/live_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "playground.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "shared_data.hpp"

namespace resilin::testing {
namespace {

Index top_corner(const World& world) {
  Eigen::Index highest = 0;
  VectorX heights = world.rest_positions(Eigen::seq(2, Eigen::last, 3));
  heights.maxCoeff(&highest);
  return static_cast<Index>(highest);
}

int steps_to_rest(LiveScene& scene, int most = 4000) {
  int steps = 0;
  for (; steps < most && !scene.report().at_rest; ++steps) scene.step(unhurried);
  return steps;
}

Vector3 position(const LiveScene& scene, Index node) {
  return at_node(node).position(3, scene.state().positions);
}

TEST(LiveScene, GoesOnToTheExactEquilibriumAndSaysSo) {
  LiveScene scene(standing_block(2));
  steps_to_rest(scene);
  EXPECT_TRUE(scene.report().at_rest) << scene.report().words;
  EXPECT_LE(scene.report().relative_residual, 1e-8);
  EXPECT_NE(scene.report().words.find("equilibrium of this mesh"), std::string::npos);

  Description statics = standing_block(2);
  statics.is_dynamic = false;
  Simulation simulation(statics);
  while (!simulation.is_finished()) ASSERT_EQ(simulation.step().status, StepReport::Status::converged);
  const double sag = (simulation.state().positions - simulation.world().rest_positions).norm();
  EXPECT_LT((scene.state().positions - simulation.state().positions).norm(), 1e-7 * sag);

  const VectorX before = scene.state().positions;
  scene.step(unhurried);
  EXPECT_EQ(scene.state().positions, before);
}

/// Page and run: the same element, the same equilibrium, the same words about its cells.
TEST(LiveScene, TakesTheElementOfARunAndSaysHowFarOffItsCellsMayBe) {
  for (const std::string element : {"auto", "P1"}) {
    Description statics = standing_block(3);
    statics.is_dynamic = false;
    statics.gravity = {2, 0, -9.81};
    statics.bodies[0].element = element;
    LiveScene scene(statics);
    LiveControls controls = scene.controls();
    controls.damping = 5;
    scene.set_controls(controls);
    Simulation simulation(statics);
    while (!simulation.is_finished()) ASSERT_EQ(simulation.step().status, StepReport::Status::converged);
    EXPECT_EQ(scene.world().bodies[0].element, simulation.world().bodies[0].element);
    const DiscretisationErrors errors =
        discretisation_errors(simulation.world(), simulation.state().positions);
    EXPECT_EQ(errors[0]->share > large_discretisation_error, element == "P1");
    // In motion, too, before it has come to rest.
    for (int i = 0; i < 40; ++i) scene.step(unhurried);
    ASSERT_FALSE(scene.report().at_rest);
    EXPECT_EQ(scene.report().words.find("has an estimated discretisation error of") != std::string::npos,
              element == "P1");
    steps_to_rest(scene);
    ASSERT_TRUE(scene.report().at_rest) << scene.report().words;
    EXPECT_NEAR(scene.report().discretisation_errors[0]->share, errors[0]->share, 1e-5 * errors[0]->share);
    EXPECT_EQ(scene.report().words.find("has an estimated discretisation error of") != std::string::npos,
              element == "P1");
  }
}

TEST(LiveScene, FollowsTheHandAndSwingsBack) {
  LiveScene scene(standing_block(2, 0));
  const Index corner = top_corner(scene.world());
  const Vector3 start = position(scene, corner);
  const Vector3 target = start + Vector3(0.3, 0, 0);
  scene.grab(at_node(corner), target);
  for (int i = 0; i < 60; ++i) scene.step(unhurried);
  EXPECT_GT(position(scene, corner).x(), start.x() + 0.05);
  scene.release();
  bool passed_rest = false;
  for (int i = 0; i < 240; ++i) {
    scene.step(unhurried);
    passed_rest |= position(scene, corner).x() < start.x();
  }
  EXPECT_TRUE(passed_rest);
}

TEST(LiveScene, HeldPoseConvergesAndTheHandKeepsItsForce) {
  LiveScene scene(standing_block(2, 0));
  LiveControls controls = scene.controls();
  controls.max_force = 20;
  controls.damping = 5;
  scene.set_controls(controls);
  const Index corner = top_corner(scene.world());
  scene.grab(at_node(corner), position(scene, corner) + Vector3(10, 0, 0));
  steps_to_rest(scene);
  ASSERT_TRUE(scene.report().at_rest) << scene.report().words;
  // Nothing else pulls: at rest the elastic force at the corner is the hand's.
  VectorX forces = VectorX::Zero(scene.state().positions.size());
  scene.world().bodies[0].domains.front().energy->add_gradient(scene.state().positions, {}, forces);
  EXPECT_NEAR(forces.segment(3 * Eigen::Index{corner}, 3).norm(), 20, 1e-4);
}

TEST(LiveScene, StepsCutShortNeverRaiseTheTotalEnergy) {
  LiveScene scene(standing_block(3, 0));
  LiveControls controls = scene.controls();
  controls.newton_limit = 1;
  controls.max_force *= 20;
  scene.set_controls(controls);
  const Index corner = top_corner(scene.world());
  scene.grab(at_node(corner), position(scene, corner) + Vector3(3, 2, 1));
  for (int i = 0; i < 10; ++i) scene.step(unhurried);
  scene.release();
  const auto total = [&scene] { return scene.report().elastic_energy + scene.report().kinetic_energy; };
  double before = total();
  ASSERT_GT(before, 0);
  for (int i = 0; i < 200; ++i) {
    scene.step(unhurried);
    EXPECT_LE(total(), before * (1 + 1e-9)) << "step " << i;
    before = total();
  }
}

TEST(LiveScene, RecoversFromEveryBrokenStartByOneIterationForEachFrame) {
  const nlohmann::json reference = read_reference("recover");
  for (const auto& [name, start] : reference["starts"].items()) {
    SCOPED_TRACE(name);
    Description description = standing_block(1, 0);
    BodyDescription& body = description.bodies[0];
    body.mesh = read_solid_mesh(reference_folder() / reference["mesh"].get<std::string>(), 3).mesh;
    description.fixes[0].where.axis = 0;
    LiveScene scene(description);
    VectorX positions = scene.world().rest_positions;
    for (std::size_t v = 0; v < start.size(); ++v) {
      for (int k = 0; k < 3; ++k) {
        const Eigen::Index i = 3 * static_cast<Eigen::Index>(v) + k;
        if (scene.world().is_fixed[static_cast<std::size_t>(i)] == 0)
          positions[i] = start[v][static_cast<std::size_t>(k)];
      }
    }
    scene.place(positions, VectorX::Zero(positions.size()));
    LiveControls controls = scene.controls();
    controls.newton_limit = 1;
    scene.set_controls(controls);
    int frames_until_upright = 0;
    for (int i = 0; i < 300; ++i) {
      scene.step(unhurried);
      ASSERT_TRUE(scene.state().positions.allFinite());
      const bool is_damped = scene.report().words.find("damped") != std::string::npos;
      if (scene.report().inverted_cells > 0) frames_until_upright = i + 1;
      EXPECT_TRUE(scene.report().inverted_cells == 0 || is_damped) << scene.report().words;
      EXPECT_FALSE(scene.report().at_rest && is_damped) << scene.report().words;
    }
    RecordProperty(name, frames_until_upright);
    EXPECT_LE(frames_until_upright, 20);
    controls.damping = 5;
    scene.set_controls(controls);
    steps_to_rest(scene);
    EXPECT_LT((scene.state().positions - scene.world().rest_positions).cwiseAbs().maxCoeff(), 1e-5);
  }
}

TEST(LiveScene, CountsAStepAsSolvedByItsLastIterationAlsoWhenTheTimeIsOver) {
  LiveScene scene(standing_block(2));
  LiveControls controls = scene.controls();
  controls.tolerance = 0.5;
  scene.set_controls(controls);
  const LiveReport& report = scene.step({.seconds = 0});
  EXPECT_EQ(report.newton_iterations, 1);
  EXPECT_LE(report.relative_residual, 0.5);
  EXPECT_TRUE(report.converged) << report.words;
}

TEST(LiveScene, PinsHoldAndLetGo) {
  LiveScene scene(standing_block(2, 0));
  const Index corner = top_corner(scene.world());
  const Vector3 start = position(scene, corner);
  scene.pin(corner);
  LiveControls controls = scene.controls();
  controls.gravity = {0, 9.81, 0};
  scene.set_controls(controls);
  for (int i = 0; i < 60; ++i) scene.step(unhurried);
  EXPECT_EQ(position(scene, corner), start);
  scene.unpin(corner);
  for (int i = 0; i < 60; ++i) scene.step(unhurried);
  EXPECT_GT((position(scene, corner) - start).norm(), 1e-3);
}

TEST(LiveScene, DroppedOnAFloorComesToRestAboveIt) {
  Description description = standing_block(2);
  description.fixes.clear();
  LiveScene scene(description);
  LiveControls controls = scene.controls();
  controls.has_ground = true;
  controls.ground_height = -0.2;
  controls.damping = 2;
  scene.set_controls(controls);
  double lowest = 1;
  for (int i = 0; i < 1500 && !scene.report().at_rest; ++i) {
    scene.step(unhurried);
    lowest = std::min(lowest, scene.state().positions(Eigen::seq(2, Eigen::last, 3)).minCoeff());
  }
  EXPECT_GT(lowest, -0.2);
  EXPECT_LT(lowest, -0.19);
  EXPECT_TRUE(scene.report().at_rest) << scene.report().words;
}

TEST(LiveScene, FloorRisesUnderABodyAsFastAsItGetsOutOfTheWay) {
  Description description = standing_block(2, -9.81);
  description.fixes.clear();
  LiveScene scene(description);
  LiveControls controls = scene.controls();
  controls.has_ground = true;
  controls.ground_height = 0.5;  // through the middle of the body
  scene.set_controls(controls);
  for (int i = 0; i < 300; ++i) {
    scene.step(unhurried);
    ASSERT_GT(scene.state().positions(Eigen::seq(2, Eigen::last, 3)).minCoeff(), *scene.ground());
  }
  EXPECT_NEAR(*scene.ground(), 0.5, 1e-3);
}

/// Two blocks, one above the other, that fall on the floor.
Description two_blocks() {
  Description scene = standing_block(2);
  scene.fixes.clear();
  BodyDescription upper = scene.bodies[0];
  upper.name = "upper";
  upper.translate = {0.1, 0, 1.02};
  scene.bodies.push_back(upper);
  ColliderDescription floor;
  floor.name = "floor";
  floor.shape.point = {0, 0, -0.02};
  floor.shape.normal = Vector3::UnitZ();
  scene.colliders = {floor};
  return scene;
}

TEST(LiveScene, TellsWhatTouches) {
  LiveScene scene(two_blocks());
  ASSERT_TRUE(scene.contact());
  EXPECT_EQ(scene.contact()->active_pairs, 0);
  EXPECT_EQ(scene.contact()->smallest_gap, std::numeric_limits<double>::infinity());
  for (int i = 0; i < 60; ++i) scene.step(unhurried);
  const LiveContact contact = *scene.contact();
  EXPECT_GE(contact.active_pairs, 4) << "what bears on the floor, and what between";
  EXPECT_GT(contact.smallest_gap, 0);
  EXPECT_LT(contact.smallest_gap, scene.controls().contact_distance);
  EXPECT_FALSE(LiveScene(standing_block(2)).contact());
}

TEST(LiveScene, ChangesHowBodiesTouch) {
  LiveScene scene(two_blocks());
  LiveControls controls = scene.controls();
  EXPECT_EQ(controls.contact_friction, 0);
  EXPECT_NEAR(controls.contact_stiffness, 1e5, 1e-6) << "Young's modulus";
  const double reach_before = controls.contact_distance;
  controls.contact_friction = 0.4;
  controls.contact_distance = 0.02;
  scene.set_controls(controls);
  EXPECT_TRUE(scene.world().contact->has_friction());
  EXPECT_EQ(scene.world().contact->activation_distance(), 0.02);
  for (int i = 0; i < 120; ++i) scene.step(unhurried);
  EXPECT_GT(scene.world().contact->smallest_gap(scene.state().positions).distance, reach_before)
      << "they keep farther apart";
  controls = scene.controls();
  controls.youngs_modulus = 3e5;
  scene.set_controls(controls);
  EXPECT_NEAR(scene.controls().contact_stiffness, 3e5, 1e-6)
      << "it follows the bodies until somebody chooses";
  EXPECT_EQ(scene.controls().contact_distance, 0.02);
  controls = scene.controls();
  controls.youngs_modulus = 1e6;
  controls.contact_distance = 0.3;  // beyond half the thickness
  const auto constants = scene.world().bodies[0].domains.front().constants;
  EXPECT_THROW(scene.set_controls(controls), InputError);
  EXPECT_EQ(scene.controls().youngs_modulus, 3e5);
  EXPECT_EQ(scene.world().contact->activation_distance(), 0.02);
  EXPECT_EQ(scene.world().bodies[0].domains.front().constants, constants) << "all or nothing";
  scene.step(unhurried);
}

/// The sliders are those of the body's own material: regions keep theirs.
TEST(LiveScene, PlaysABodyWithRegions) {
  Description description = standing_block(2);
  RegionDescription top;
  top.name = "top";
  top.where.kind = Where::Kind::box;
  top.where.min = {0, 0, 0.5};
  top.where.max = {1, 1, 1};
  top.material.constants["youngs_modulus"] = 1e6;
  description.bodies[0].regions.push_back(top);
  LiveScene scene(description);
  steps_to_rest(scene);
  EXPECT_TRUE(scene.report().at_rest) << scene.report().words;
  Description statics = description;
  statics.is_dynamic = false;
  statics.newton.tolerance = 1e-10;
  Simulation simulation(statics);
  while (!simulation.is_finished()) ASSERT_EQ(simulation.step().status, StepReport::Status::converged);
  const VectorX& expected = simulation.state().positions;
  EXPECT_LT((scene.state().positions - expected).norm(),
            1e-6 * (expected - simulation.world().rest_positions).norm());
  LiveControls controls = scene.controls();
  controls.youngs_modulus = 3e5;
  controls.law = "neo_hookean";
  scene.set_controls(controls);
  const Domains& domains = scene.world().bodies[0].domains;
  EXPECT_EQ(domains[0].law, "neo_hookean");
  EXPECT_EQ(domains[1].law, "stable_neo_hookean");
  EXPECT_NEAR(domains[1].constants[0].second, 1e6 / 2.8, 1e-6);
  for (int i = 0; i < 5; ++i) scene.step(unhurried);
  EXPECT_EQ(scene.report().inverted_cells, 0);
}

TEST(LiveScene, BallPushesAndNeverEnters) {
  LiveScene scene(standing_block(3, 0));
  const double radius = 0.15;
  for (int i = 0; i <= 60; ++i) {
    scene.poke({0.8 - 0.01 * i, 0.2, 0.9}, radius);
    scene.step(unhurried);
    ASSERT_TRUE(scene.ball());
    for (Index node = 0; node < scene.world().num_nodes(); ++node)
      ASSERT_GT((position(scene, node) - *scene.ball()).norm(), radius * (1 - 1e-12));
  }
  EXPECT_LT(position(scene, top_corner(scene.world())).x() - 0, -0.02);
  scene.stop_poking();
  EXPECT_FALSE(scene.ball());
}

TEST(LiveScene, RefusesWhatCannotBeAndStaysAsItIs) {
  LiveScene scene(standing_block(2));
  const auto refuses = [&scene](const std::function<void(LiveControls&)>& change, const std::string& word) {
    LiveControls wrong = scene.controls();
    change(wrong);
    try {
      scene.set_controls(wrong);
      ADD_FAILURE() << word;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
    EXPECT_EQ(scene.controls().poissons_ratio, 0.4);
  };
  refuses([](LiveControls& c) { c.poissons_ratio = 0.5; }, "poissons_ratio");
  refuses([](LiveControls& c) { c.youngs_modulus = -1; }, "youngs_modulus");
  refuses([](LiveControls& c) { c.time_step = std::nan(""); }, "time_step");
  refuses([](LiveControls& c) { c.law = "rubber"; }, "rubber");
  refuses([](LiveControls& c) { c.gravity.x() = INFINITY; }, "gravity");
  EXPECT_THROW(scene.pin(-1), InputError);
  EXPECT_THROW(scene.poke({0, 0, 0}, -1), InputError);
  EXPECT_THROW(scene.grab(at_node(0), {NAN, 0, 0}), InputError);
}

TEST(LiveScene, ChangesItsLawUnlessCellsAreInsideOut) {
  LiveScene scene(standing_block(2, 0));
  LiveControls controls = scene.controls();
  for (const LawInfo* law : live_laws()) {
    controls.law = law->name;
    scene.set_controls(controls);
    EXPECT_EQ(scene.world().bodies[0].domains.front().law, law->name);
    scene.step(unhurried);
  }
  controls.law = "stable_neo_hookean";
  scene.set_controls(controls);
  VectorX mirrored = scene.world().rest_positions;
  mirrored(Eigen::seq(0, Eigen::last, 3)) *= -1;
  scene.place(mirrored, VectorX::Zero(mirrored.size()));
  controls.law = "neo_hookean";
  EXPECT_THROW(scene.set_controls(controls), InputError);
  EXPECT_EQ(scene.world().bodies[0].domains.front().law, "stable_neo_hookean");
}

/// Constants that E and nu do not determine stay as they were given.
TEST(LiveScene, ChangesTheStiffnessOfALawWithFibres) {
  Description description = standing_block(2, 0);
  MaterialDescription& material = description.bodies[0].material;
  material.law = "holzapfel_gasser_ogden";
  material.constants["fibre_modulus"] = 2e4;
  material.constants["fibre_stiffening"] = 3;
  material.fibres = {{Vector3::UnitZ()}};
  LiveScene scene(std::move(description));
  LiveControls controls = scene.controls();
  controls.youngs_modulus *= 2;
  const Material before = scene.world().bodies[0].domains.front().energy->material(0);
  scene.set_controls(controls);
  const Material after = scene.world().bodies[0].domains.front().energy->material(0);
  ASSERT_EQ(after.law->name, "holzapfel_gasser_ogden");
  for (std::size_t i = 0; i < after.constants.size(); ++i) {
    const double factor = after.law->constants[i].is_free ? 1 : 2;
    EXPECT_DOUBLE_EQ(after.constants[i], factor * before.constants[i]) << after.law->constants[i].name;
  }
  EXPECT_EQ(after.fibres, before.fibres);
  EXPECT_EQ(after.constants[2], 2e4);
}

/// Internal variables follow the steps, a change of stiffness and a reset.
TEST(LiveScene, LetsViscoelasticBodiesRelax) {
  Description description = standing_block(2, 0);
  description.bodies[0].material.law = "neo_hookean_simo";
  description.bodies[0].material.viscoelastic = {.g = {0.5}, .tau = {0.05}};
  LiveScene scene(std::move(description));
  EXPECT_EQ(scene.state().history.norm(), 0);
  const Index corner = top_corner(scene.world());
  scene.grab(at_node(corner), position(scene, corner));
  scene.drag(position(scene, corner) + Vector3(0.1, 0.05, 0));
  for (int i = 0; i < 10; ++i) scene.step(unhurried);
  EXPECT_GT(scene.state().history.norm(), 0);
  LiveControls controls = scene.controls();
  controls.youngs_modulus *= 2;
  scene.set_controls(controls);
  scene.step(unhurried);
  EXPECT_TRUE(scene.report().converged);
  controls.law = "neo_hookean";  // without an isochoric part of its own
  EXPECT_THROW(scene.set_controls(controls), InputError);
  scene.reset();
  EXPECT_EQ(scene.state().history.norm(), 0);
}

TEST(LiveScene, HasTheSameBitsForAnyNumberOfThreadsAndAfterReset) {
  const int threads = num_threads();
  const auto played = [](LiveScene& scene) {
    const Index corner = top_corner(scene.world());
    scene.grab(at_node(corner), position(scene, corner));
    for (int i = 0; i < 30; ++i) {
      scene.drag(position(scene, corner) + Vector3(0.1 * i, 0.05, 0));
      scene.step(unhurried);
    }
    return scene.state().positions;
  };
  LiveScene scene(standing_block(4));
  set_num_threads(1);
  const VectorX one = played(scene);
  scene.reset();
  set_num_threads(2);
  const VectorX two = played(scene);
  set_num_threads(threads);
  EXPECT_EQ(one, two);
}

}  // namespace
}  // namespace resilin::testing
