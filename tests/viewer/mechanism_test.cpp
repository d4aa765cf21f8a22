// Scenes with joints, springs, cables and ties that are played with.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>

#include "resilin/core/error.hpp"
#include "resilin/scene/scene.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/simulation.hpp"
#include "resilin/view/frame_codec.hpp"
#include "resilin/world/joint.hpp"
#include "resilin/world/linear_constraints.hpp"
#include "shared_data.hpp"
#include "temporary_folder.hpp"
#include "viewer/scene_source.hpp"
#include "viewer/served_live_scene.hpp"

namespace resilin::viewer {
namespace {

using nlohmann::json;
using resilin::testing::source_folder;
using resilin::testing::TemporaryFolder;
using ::testing::HasSubstr;

constexpr StepBudget unhurried{.seconds = std::numeric_limits<double>::infinity()};

/// A pendulum on a hinge to the ground with a motor, as the placeholder says; a rod on it by a ball.
std::string pendulum(const std::string& motor) {
  return R"(title = "pendulum"
[simulation]
kind = "dynamic"
dimension = 2
gravity = [0, -9.81]
time_step = 0.01
end_time = 1
[[body]]
name = "arm"
mesh = { box = { size = [0.02, 0.2], cells = [1, 4], origin = [-0.01, -0.2] } }
rigid = { density = 2700 }
[[body]]
name = "rod"
mesh = { box = { size = [0.02, 0.2], cells = [1, 4], origin = [-0.01, -0.4] } }
rigid = { density = 2700 }
[[joint]]
name = "shoulder"
kind = "hinge"
bodies = ["arm"]
at = [0, 0]
)" + motor +
         R"(
[[joint]]
name = "elbow"
kind = "ball"
bodies = ["arm", "rod"]
at = [0, -0.2]
)";
}

/// A rigid block that a cable holds.
std::string lifted(const std::string& law) {
  return R"(title = "lifted"
[simulation]
kind = "dynamic"
dimension = 2
gravity = [0, -10]
time_step = 0.01
end_time = 1
[[body]]
name = "block"
mesh = { box = { size = [0.1, 0.1], cells = [2, 2] } }
rigid = { density = 100 }
damping = { mass = 10 }
[[cable]]
name = "rope"
points = [{ at = [0.05, 1.1] }, { body = "block", at = [0.05, 0.1] }]
)" + law +
         "\n";
}

LiveScene live_of(const std::string& text) {
  return LiveScene(read_scene_from_text(text, "scene.toml", ".").description);
}

std::vector<JointForce> joints_of(const LiveScene& scene) {
  VectorX gradient = VectorX::Zero(scene.state().positions.size());
  return joint_forces(scene.world(), scene.conditions(), gradient, scene.state());
}

double value_of_joint(const LiveScene& scene, const std::string& name) {
  for (const JointForce& joint : joints_of(scene))
    if (joint.name == name) return joint.value;
  return std::numeric_limits<double>::quiet_NaN();
}

/// By how much the relations of a scene are not met, relative to its extent. Those with constants are led to
/// them as supports are, over several steps where each has one iteration.
enum class Relations { all, without_constants };
double broken(const LiveScene& scene, Relations which = Relations::all) {
  const World& world = scene.world();
  const VectorX& x = scene.state().positions;
  VectorX constants = VectorX::Zero(x.size());
  set_constants(world, scene.conditions(), constants);
  VectorX placed = x;
  if (world.dependents() == nullptr) return 0;
  world.dependents()->place(constants, placed);
  if (which == Relations::without_constants)
    for (std::size_t row = 0; row < world.constraints->constants.size(); ++row)
      if (const Index unknown = world.dependents()->relations()[row].unknown;
          !world.constraints->constants[row].empty())
        placed[unknown] = x[unknown];
  return (placed - x).cwiseAbs().maxCoeff() / world.largest_extent();
}

void play(LiveScene& scene, int steps) {
  for (int i = 0; i < steps; ++i) scene.step(unhurried);
}

const std::vector<std::string> mechanisms = {"four_bar",   "slider_crank", "finger_gripper", "cable_finger",
                                             "rope_brake", "cardan_shaft", "tied_blocks",    "periodic_cell"};

struct EveryMechanism : ::testing::TestWithParam<std::string> {
  Description description = read_scene(source_folder() / "examples" / (GetParam() + ".toml")).description;
};

TEST_P(EveryMechanism, PlaysAndStaysTogether) {
  LiveScene scene(description);
  for (int i = 0; i < 40; ++i) {
    scene.step(unhurried);
    ASSERT_TRUE(scene.state().positions.allFinite());
    ASSERT_LT(broken(scene), 1e-9) << "step " << i;
  }
}

/// Hands and sliders by chance, each frame with one Newton iteration.
TEST_P(EveryMechanism, OutlivesAStorm) {
  LiveScene scene(description);
  LiveControls controls = scene.controls();
  controls.newton_limit = 1;
  controls.max_force *= 10;
  scene.set_controls(controls);
  const World& world = scene.world();
  const ShownSurface surface(world);
  std::vector<float> places(3 * static_cast<std::size_t>(surface.num_vertices()));
  std::mt19937 chance(11);
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(chance() % 10001) / 1e4;
  };
  const int rounds = world.num_free_unknowns() > 500 ? 4 : 12;
  for (int round = 0; round < rounds; ++round) {
    const auto vertex = static_cast<Index>(chance() % static_cast<unsigned>(surface.num_vertices()));
    const MaterialPoint point = surface.material_point(vertex);
    const Vector3 start = point.position(world.dimension, scene.state().positions);
    scene.grab(point, start);
    for (std::size_t d = 0; d < scene.drives().size(); ++d)
      scene.drive(d, between(scene.drives()[d].least, scene.drives()[d].greatest));
    Vector3 way(between(-5, 5), between(-5, 5), world.dimension == 3 ? between(-5, 5) : 0);
    way *= world.largest_extent();
    if (round % 4 == 1) scene.pin(surface.nearest_node(vertex), point);
    for (int i = 1; i <= 8; ++i) {
      scene.drag(start + i / 8.0 * way);
      scene.step(unhurried);
      ASSERT_TRUE(scene.state().positions.allFinite());
      ASSERT_LT(broken(scene, Relations::without_constants), 1e-8) << "round " << round;
    }
    scene.release();
    if (round % 4 == 3) scene.unpin_all();
    if (round == 2) scene.reset();
    play(scene, 5);
  }
  ASSERT_TRUE(scene.state().positions.allFinite());
}
INSTANTIATE_TEST_SUITE_P(Examples, EveryMechanism, ::testing::ValuesIn(mechanisms),
                         [](const auto& each) { return each.param; });

TEST(Mechanism, MovesAsARunOfBackwardEuler) {
  Description description = read_scene(source_folder() / "examples" / "four_bar.toml").description;
  description.integrator = "backward_euler";
  Simulation run(description);
  LiveScene scene(description);
  LiveControls controls = scene.controls();
  controls.tolerance = 1e-10;
  scene.set_controls(controls);
  for (int i = 0; i < 50; ++i) {
    ASSERT_EQ(run.step().status, StepReport::Status::converged);
    scene.step(unhurried);
  }
  EXPECT_LT((scene.state().positions - run.state().positions).cwiseAbs().maxCoeff(),
            1e-6 * scene.world().largest_extent());
}

TEST(Mechanism, GoesOnFromAFrameOfARun) {
  const Description description = read_scene(source_folder() / "examples" / "four_bar.toml").description;
  Simulation run(description);
  for (int i = 0; i < 30; ++i) run.step();
  LiveScene scene(description, run.state());
  EXPECT_NEAR(value_of_joint(scene, "shaft"), -0.3 * std::numbers::pi, 2e-3);
  EXPECT_NEAR(scene.drives()[0].value, -0.3 * std::numbers::pi, 1e-9);
  play(scene, 10);
  EXPECT_NEAR(value_of_joint(scene, "shaft"), -0.4 * std::numbers::pi, 2e-3);
  EXPECT_LT(broken(scene), 1e-9);
}

TEST(Mechanism, AMotorGoesToTheAngleOfItsSliderAndStaysThereAfterAReset) {
  LiveScene scene =
      live_of(pendulum("motor = { position = 0.5, time_function = { table = [[0, 0], [1, 1]] } }"));
  ASSERT_EQ(scene.drives().size(), 1u);
  const Drive& drive = scene.drives()[0];
  EXPECT_EQ(drive.key, "drive.shoulder");
  EXPECT_EQ(drive.kind, Drive::Kind::angle);
  EXPECT_EQ(drive.greatest, 1);
  play(scene, 20);
  EXPECT_NEAR(value_of_joint(scene, "shoulder"), 0.1, 1e-3);
  EXPECT_NEAR(drive.value, 0.1, 1e-9);
  scene.drive(0, -0.6);
  scene.step(unhurried);
  EXPECT_GT(value_of_joint(scene, "shoulder"), 0) << "it does not jump";
  play(scene, 60);
  EXPECT_NEAR(value_of_joint(scene, "shoulder"), -0.6, 1e-3);
  scene.reset();
  EXPECT_NEAR(value_of_joint(scene, "shoulder"), 0, 1e-12);
  play(scene, 60);
  EXPECT_NEAR(value_of_joint(scene, "shoulder"), -0.6, 1e-3);
  scene.stop_driving();
  scene.reset();
  play(scene, 20);
  EXPECT_NEAR(value_of_joint(scene, "shoulder"), 0.1, 1e-3);
}

TEST(Mechanism, AMotorByVelocityTurnsOnFromWhereItIs) {
  LiveScene scene = live_of(pendulum("motor = { velocity = 1 }"));
  play(scene, 20);
  EXPECT_NEAR(value_of_joint(scene, "shoulder"), 0.2, 1e-3);
  scene.drive(0, 0);
  play(scene, 100);
  const double angle = value_of_joint(scene, "shoulder");
  EXPECT_GT(angle, 0.2);
  EXPECT_LT(angle, 0.35);
  play(scene, 50);
  EXPECT_NEAR(value_of_joint(scene, "shoulder"), angle, 1e-3);
  scene.drive(0, 2);
  play(scene, 150);
  EXPECT_GT(std::abs(value_of_joint(scene, "shoulder") - angle), 0.3);
}

TEST(Mechanism, CablesLiftByTheirSliders) {
  const auto height = [](const LiveScene& scene) {
    double sum = 0;
    for (Index node = 0; node < 3; ++node) sum += node_position(2, node, scene.state().positions).y() / 3;
    return sum - 0.05;
  };
  LiveScene pulled = live_of(lifted("tension = 10\nfriction = 0"));  // its weight is 10 N
  play(pulled, 50);
  EXPECT_NEAR(height(pulled), 0, 1e-3);
  pulled.drive(0, 12);
  play(pulled, 50);
  EXPECT_GT(height(pulled), 0.01);
  LiveScene wound = live_of(lifted("stiffness = 1e4"));
  wound.drive(0, 0.1);
  play(wound, 200);
  EXPECT_NEAR(height(wound), 0.1 - 10 / 1e4, 1e-3);
}

TEST(Mechanism, RefusesValuesThatCannotBe) {
  LiveScene scene = live_of(lifted("tension = 10"));
  for (const double value : {-1.0, 1e9, std::nan("")}) EXPECT_THROW(scene.drive(0, value), InputError);
  EXPECT_THROW(scene.drive(1, 0), InputError);
  EXPECT_FALSE(scene.drives()[0].is_driven);
}

TEST(Mechanism, RefusesRigidRegions) {
  const std::string text = R"([simulation]
kind = "dynamic"
dimension = 2
time_step = 0.01
end_time = 1
[[body]]
name = "bar"
mesh = { box = { size = [0.2, 0.02], cells = [4, 1] } }
material = { law = "neo_hookean", youngs_modulus = 1e5, poissons_ratio = 0.3, density = 1000 }
[[body.region]]
name = "plate"
where = { box = [[0.1, -1], [1, 1]] }
rigid = { density = 2700 }
)";
  EXPECT_THAT([&] { live_of(text); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("without rigid regions")));
}

TEST(Mechanism, ARigidBodyIsGrabbedWhereItIsTouchedAndKeepsItsShape) {
  LiveScene scene = live_of(pendulum(""));
  const ShownSurface surface(scene.world());
  const auto rod = std::ranges::find(surface.parts(), "rod", &ShownSurface::Part::name);
  std::vector<float> places(3 * static_cast<std::size_t>(surface.num_vertices()));
  const Index vertex = rod->first_vertex;
  const MaterialPoint point = surface.material_point(vertex);
  const Vector3 start = point.position(2, scene.state().positions);
  scene.grab(point, start);
  const Vector3 target = start + Vector3(0.1, 0.05, 0);
  scene.drag(target);
  LiveControls controls = scene.controls();
  controls.damping = 10;
  controls.max_force *= 10;
  scene.set_controls(controls);
  play(scene, 200);
  EXPECT_LT((point.position(2, scene.state().positions) - target).norm(), 0.02);
  surface.positions(scene.state().positions, places);
  const auto at = [&](const auto& values, Index v) {
    return Vector3(static_cast<double>(values[3 * static_cast<std::size_t>(v)]),
                   static_cast<double>(values[3 * static_cast<std::size_t>(v) + 1]), 0);
  };
  for (Index v = vertex; v < vertex + rod->num_vertices; ++v)
    EXPECT_NEAR((at(places, v) - at(places, vertex)).norm(),
                (at(surface.rest_positions(), v) - at(surface.rest_positions(), vertex)).norm(), 1e-5);
}

TEST(Mechanism, APinHoldsAPointOfAJoinedRigidBody) {
  LiveScene scene = live_of(pendulum(""));
  LiveControls controls = scene.controls();
  controls.gravity = {5, -9.81, 0};
  controls.damping = 5;
  scene.set_controls(controls);
  const ShownSurface surface(scene.world());
  const auto rod = std::ranges::find(surface.parts(), "rod", &ShownSurface::Part::name);
  const MaterialPoint point = surface.material_point(rod->first_vertex);
  const Vector3 start = point.position(2, scene.state().positions);
  scene.pin(surface.nearest_node(rod->first_vertex), point);
  play(scene, 100);
  EXPECT_LT((point.position(2, scene.state().positions) - start).norm(), 1e-5);
  scene.unpin_all();
  play(scene, 30);
  EXPECT_GT((point.position(2, scene.state().positions) - start).norm(), 1e-3);
}

TEST(Mechanism, ThePageListsItsDrivesAndDrawsItsConnectors) {
  const std::string text = pendulum("motor = { position = 0.5 }");
  ServedLiveScene scene([&] { return read_scene_from_text(text, "scene.toml", "."); });
  const json header = scene.header();
  EXPECT_EQ(header["controls"][0]["key"], "drive.shoulder");
  EXPECT_EQ(header["controls"][0]["unit"], "rad");
  ASSERT_EQ(header["connectors"].size(), 2u);
  EXPECT_EQ(header["connectors"][1]["kind"], "ball");
  EXPECT_TRUE(header["marks"].empty()) << "a motor is no load";
  scene.apply(SetControl{.value = 0.3, .drive = "drive.shoulder"});
  EXPECT_EQ(scene.state()["values"]["drive.shoulder"], 0.3);
  for (int i = 0; i < 100; ++i) scene.step(3600);
  EXPECT_NEAR(scene.status()["drives"]["drive.shoulder"].get<double>(), 0.3, 1e-9);
  // The elbow as the page finds it, from vertices of the frame.
  const DecodedFrame frame = decode_frame(scene.frame(1, 0, {}, 1));
  const json& point = header["connectors"][1]["points"][0];
  Vector3 elbow = Vector3::Zero();
  for (std::size_t i = 0; i < point["vertices"].size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      elbow[static_cast<Eigen::Index>(k)] +=
          point["weights"][i].get<double>() *
          static_cast<double>(frame.positions[3 * point["vertices"][i].get<std::size_t>() + k]);
  EXPECT_LT((elbow - 0.2 * Vector3(std::sin(0.3), -std::cos(0.3), 0)).norm(), 1e-3);
  try {
    scene.apply(SetControl{.value = 0.3, .drive = "drive.elbow"});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("drive.shoulder"));
  }
}

TEST(Mechanism, SavesWhatWasDriven) {
  const TemporaryFolder folder;
  const auto saved = [&](const std::string& text, const std::string& key, double value) {
    const std::unique_ptr<ServedLiveScene> scene =
        served_scene(scene_file(folder.write("scene.toml", text), {}));
    scene->apply(SetControl{.value = value, .drive = key});
    scene->save();
    Description description = read_scene(folder.path() / "scene-2.toml").description;
    std::filesystem::remove(folder.path() / "scene-2.toml");
    return description;
  };
  const Description angle = saved(
      pendulum(
          "motor = { position = 0.5, stiffness = 100, time_function = { ramp = { from = 0, until = 1 } } }"),
      "drive.shoulder", 0.3);
  EXPECT_EQ(angle.joints[0].motor->position, 0.3);
  EXPECT_EQ(angle.joints[0].motor->stiffness, 100);
  EXPECT_EQ(angle.joints[0].motor->time_function.value(0.5), 1);
  EXPECT_EQ(saved(pendulum("motor = { velocity = 1 }"), "drive.shoulder", -2).joints[0].motor->velocity, -2);
  EXPECT_EQ(saved(pendulum("motor = { torque = 1 }"), "drive.shoulder", -2).joints[0].motor->effort, -2);
  EXPECT_EQ(saved(lifted("tension = 10"), "drive.rope", 5).cables[0].tension, 5);
  EXPECT_EQ(saved(lifted("stiffness = 1e4"), "drive.rope", 0.1).cables[0].shortening, 0.1);
}

TEST(Mechanism, AFaceOfARigidBodyIsHeldAndSaved) {
  const TemporaryFolder folder;
  const std::unique_ptr<ServedLiveScene> scene =
      served_scene(scene_file(folder.write("scene.toml", pendulum("")), {}));
  const ShownSurface surface(scene->world());
  const auto rod = std::ranges::find(surface.parts(), "rod", &ShownSurface::Part::name);
  std::uint32_t lowest = static_cast<std::uint32_t>(rod->first_vertex);
  const auto place = [&](std::uint32_t v) {
    const float* at = &surface.rest_positions()[3 * std::size_t{v}];
    return Vector3(at[0], at[1], at[2]);
  };
  for (Index v = rod->first_vertex; v < rod->first_vertex + rod->num_vertices; ++v)
    if (place(static_cast<std::uint32_t>(v)).y() < place(lowest).y()) lowest = static_cast<std::uint32_t>(v);
  scene->apply(HoldFace{lowest, place(lowest) + Vector3(0.01, 0, 0), {}});
  scene->apply(SetControl{find_live_control("gravity"), Vector3(5, -9.81, 0)});
  for (int i = 0; i < 50; ++i) scene->step(3600);
  const DecodedFrame frame = decode_frame(scene->frame(1, 0, {}, 1));
  EXPECT_NEAR(static_cast<double>(frame.positions[3 * std::size_t{lowest}]), place(lowest).x(), 1e-4);
  scene->save();
  const World saved(read_scene(folder.path() / "scene-2.toml").description);
  ASSERT_EQ(saved.supports.size(), 1u);
  EXPECT_EQ(saved.supports[0].nodes.size(), 3u) << "all control nodes";
}

}  // namespace
}  // namespace resilin::viewer
