// Values computed from the frames of a run equal those of its states, wherever the scene stands.

#include "resilin/results/saved_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "resilin/fields/evaluator.hpp"
#include "resilin/io/vtu.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/results/result_picture.hpp"
#include "resilin/results/results.hpp"
#include "resilin/results/run.hpp"
#include "resilin/results/taking_up.hpp"
#include "small_scenes.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

struct Placed {
  int dimension;
  bool is_dynamic;
  double distance;  ///< distance of the scene from its origin, in extents of the bar
};

std::ostream& operator<<(std::ostream& stream, const Placed& placed) {
  return stream << placed.dimension << "D, " << (placed.is_dynamic ? "dynamic, " : "static, ")
                << placed.distance;
}

Description scene_of(const Placed& placed) {
  Description scene = small_bar(placed.dimension, placed.is_dynamic);
  scene.end_time = 0.1;
  Vector3 place = Vector3::Zero();
  place.head(placed.dimension).setConstant(placed.distance);
  scene.bodies[0].translate = place;
  FixDescription& wall = scene.fixes[0];
  wall.where.at = place[wall.where.axis];
  wall.where.tolerance = 0.001;
  scene.probes[0].at += place;
  return scene;
}

/// A run into a folder to its end; its last state stays with it.
struct SavedRun {
  SavedRun(const Placed& placed, std::filesystem::path place)
      : folder(std::move(place)), simulation(scene_of(placed)) {
    ResultFolder results(folder);
    results.record(simulation, false);
    const RunOutcome outcome = run_to_end(simulation, {});
    results.record(simulation, true);
    results.finish(simulation, outcome);
  }

  std::filesystem::path folder;
  Simulation simulation;
};

struct FramesOfARun : ::testing::TestWithParam<Placed> {
  const TemporaryFolder folder;
};
INSTANTIATE_TEST_SUITE_P(Places, FramesOfARun,
                         ::testing::Values(Placed{2, false, 0}, Placed{2, true, 0}, Placed{3, false, 0},
                                           Placed{3, true, 0}, Placed{2, false, 1e6}, Placed{2, true, 1e6},
                                           Placed{3, false, 1e6}, Placed{3, true, 1e6}));

TEST_P(FramesOfARun, HaveTheFieldsOfTheStates) {
  const SavedRun run(GetParam(), folder / "out");
  const std::shared_ptr<const World> world = saved_world(run.folder);
  ASSERT_NE(world, nullptr);
  EXPECT_EQ(world->origin, run.simulation.world().origin);
  EXPECT_EQ(world->origin.isZero(0), GetParam().distance == 0);
  const std::filesystem::path file = frame_files(run.folder).back();
  const State state = state_of_frame(*world, read_vtu(file), file);
  EXPECT_EQ(state.time, run.simulation.state().time);
  const std::vector<std::string> names = {"displacement", "velocity", "von_mises", "cauchy_stress"};
  const std::vector<FieldValues> found = FieldEvaluator(*world).evaluate(state, names),
                                 expected = FieldEvaluator(run.simulation.world())
                                                .evaluate(run.simulation.state(), names);
  for (std::size_t f = 0; f < names.size(); ++f) {
    const auto vector = [](const std::vector<double>& values) {
      return Eigen::Map<const VectorX>(values.data(), static_cast<Eigen::Index>(values.size()));
    };
    const VectorX values = vector(found[f].values), true_values = vector(expected[f].values);
    ASSERT_EQ(values.size(), true_values.size());
    // Near the origin bit by bit; elsewhere a place is a rest place and a displacement, rounded once.
    const double tolerance = GetParam().distance == 0 ? 0 : 1e-12 * true_values.cwiseAbs().maxCoeff();
    EXPECT_LE((values - true_values).cwiseAbs().maxCoeff(), tolerance) << names[f];
  }
}

PictureOptions small_picture(const std::string& field) {
  PictureOptions options;
  options.field = field;
  options.width = 200;
  options.height = 150;
  return options;
}

TEST_P(FramesOfARun, AreDrawnAsTheStates) {
  const SavedRun run(GetParam(), folder / "out");
  for (const char* field : {"von_mises", "displacement"}) {
    PictureOptions options = small_picture(field);
    options.shows_rest = true;
    const Image of_frame = draw_result(run.folder, -1, options),
                of_state = draw_state(run.simulation.world(), run.simulation.state(), options);
    EXPECT_EQ(of_frame.pixels, of_state.pixels) << field;
  }
}

TEST_P(FramesOfARun, AreColouredBySmoothStressUnlessAnotherFieldIsAsked) {
  const SavedRun run(GetParam(), folder / "out");
  const Image usual = draw_result(run.folder, -1, small_picture(""));
  EXPECT_EQ(usual.legend.substr(0, usual.legend.find(" [")), "von Mises stress, smooth");
  EXPECT_EQ(usual.pixels, draw_result(run.folder, -1, small_picture("nodal_von_mises")).pixels);
}

/// Gravity decides what is upright: pictures of one scene with y or z up are the same but for the axes.
TEST(PictureOfAState, TakesUpFromGravity) {
  Description scene = scene_of({3, true, 0});
  scene.gravity = {0, 0, -9.81};
  PictureOptions options = small_picture("displacement");
  options.view = "front";
  const auto drawn = [&](const std::string& up) {
    options.up = up;
    const World world(scene);
    State state;
    state.positions = world.rest_positions;
    return draw_state(world, state, options).pixels;
  };
  EXPECT_EQ(drawn("auto"), drawn("z"));
  scene.gravity = {0, -9.81, 0};
  EXPECT_EQ(drawn("auto"), drawn("y"));
  EXPECT_NE(drawn("auto"), drawn("z"));
}

/// A skin of a body is drawn where the field is one of the vertices; the range is that of the cells' nodes.
TEST(PictureOfAState, DrawsTheSkin) {
  Description scene = scene_of({3, true, 0});
  Mesh skin = extract_surface(make_box({1, 0.25, 0.25}, {32, 8, 8})).mesh;
  for (Vector3& vertex : skin.vertices)
    vertex = 0.5 * (vertex + Vector3(0.5, 0.125, 0.125));  // within the cells
  const World bare(scene);
  scene.bodies[0].skin = SkinDescription{.surface = skin, .surface_name = "fine"};
  const World world(scene);
  State state;
  state.positions = world.rest_positions;
  for (Index node = 0; node < world.num_nodes(); ++node)
    state.positions[3 * node + 2] += 0.1 * world.rest_positions[3 * node] * world.rest_positions[3 * node];
  PictureOptions options = small_picture("averaged_von_mises");
  const Image with_skin = draw_state(world, state, options), without = draw_state(bare, state, options);
  EXPECT_NE(with_skin.pixels, without.pixels);
  EXPECT_EQ(with_skin.legend, without.legend) << "the same values";
  options.field = "von_mises";
  EXPECT_EQ(draw_state(world, state, options).pixels, draw_state(bare, state, options).pixels) << "by cell";
}

/// A run with a ball beside its bar that comes nearer at this speed [m/s].
Simulation run_with_ball(double speed, const std::filesystem::path& folder) {
  Description scene = scene_of({3, true, 0});
  ColliderDescription ball;
  ball.name = "ball";
  ball.kind = "sphere";
  ball.shape.center = {0.5, 0, 3};
  ball.shape.radius = 0.3;
  ball.velocity = {0, 0, -speed};
  scene.colliders = {ball};
  Simulation simulation(scene);
  ResultFolder results(folder);
  results.record(simulation, false);
  const RunOutcome outcome =
      run_to_end(simulation, {.after_step = [&](const StepReport&) { results.record(simulation, false); }});
  results.record(simulation, true);
  results.finish(simulation, outcome);
  return simulation;
}

TEST(CollidersOfARun, LieBesideItsFrames) {
  const TemporaryFolder folder;
  const Simulation moving = run_with_ball(2, folder / "moving"), still = run_with_ball(0, folder / "still");
  const std::size_t num_frames = frame_files(folder / "moving").size();
  const auto files_in = [](const std::filesystem::path& place) {
    return std::distance(std::filesystem::directory_iterator(place), std::filesystem::directory_iterator{});
  };
  EXPECT_EQ(files_in(folder / "moving" / "colliders"), static_cast<std::ptrdiff_t>(num_frames));
  EXPECT_EQ(files_in(folder / "still" / "colliders"), 1);
  for (const char* run : {"moving", "still"}) EXPECT_TRUE(exists(folder / run / "colliders.pvd"));
  const std::filesystem::path last = frame_files(folder / "moving").back();
  const VtuContent content = read_vtu(folder / "moving" / "colliders" / last.filename());
  Vector3 middle = Vector3::Zero();
  for (const Vector3& x : content.file.mesh.vertices)
    middle += x / static_cast<double>(content.file.mesh.vertices.size());
  EXPECT_LT((middle - Vector3(0.5, 0, 3 - 2 * moving.state().time)).norm(), 1e-12);
  for (const Simulation* simulation : {&moving, &still}) {
    const std::filesystem::path place = folder / (simulation == &moving ? "moving" : "still");
    EXPECT_EQ(draw_result(place, -1, small_picture("von_mises")).pixels,
              draw_state(simulation->world(), simulation->state(), small_picture("von_mises")).pixels);
  }
}

TEST(CollidersOfARun, GoWithTheSceneThatHadThem) {
  const TemporaryFolder folder;
  run_with_ball(2, folder / "out");
  run_with_ball(0, folder / "out");
  EXPECT_FALSE(exists(folder / "out" / "colliders" / "0001.vtu"));
  const SavedRun bare({3, true, 0}, folder / "out");
  EXPECT_FALSE(exists(folder / "out" / "colliders"));
  EXPECT_FALSE(exists(folder / "out" / "colliders.pvd"));
}

/// A ball that is led into a bar while its load grows is where the load factor says.
TEST(CollidersOfARun, PressInTheFieldsOfFramesAtRest) {
  const TemporaryFolder folder;
  Description scene = scene_of({3, false, 0});
  ColliderDescription ball;
  ball.name = "ball";
  ball.kind = "sphere";
  ball.shape.center = {0.5, 0.125, 0.56};
  ball.shape.radius = 0.3;
  ball.displacement = {0, 0, -0.02};
  scene.colliders = {ball};
  scene.gravity.setZero();
  Simulation simulation(scene);
  {
    ResultFolder results(folder / "out");
    const RunOutcome outcome = run_to_end(simulation, {});
    ASSERT_EQ(outcome.status, RunStatus::done) << outcome.reason;
    results.record(simulation, true);
    results.finish(simulation, outcome);
  }
  const std::shared_ptr<const World> world = saved_world(folder / "out");
  const std::filesystem::path file = frame_files(folder / "out").back();
  const State state = state_of_frame(*world, read_vtu(file), file);
  EXPECT_EQ(state.time, simulation.state().time);
  EXPECT_EQ(state.load, simulation.state().load);
  const std::vector<std::string> names = {"contact_pressure", "contact_gap"};
  const std::vector<FieldValues> found = FieldEvaluator(*world).evaluate(state, names),
                                 expected =
                                     FieldEvaluator(simulation.world()).evaluate(simulation.state(), names);
  EXPECT_GT(std::ranges::max(expected[0].values), 0);
  EXPECT_EQ(found[0].values, expected[0].values);
  EXPECT_THAT(found[1].values, ::testing::Pointwise(::testing::NanSensitiveDoubleEq(), expected[1].values));
}

/// Several materials with different numbers of internal variables; bodies of one kind of cell stand together
/// in a frame, but not in the scene.
TEST(FramesOfViscoelasticBodies, HoldTheirInternalVariables) {
  const TemporaryFolder folder;
  Description scene = scene_of({2, true, 0});
  scene.end_time = 0.04;
  BodyDescription elastic = scene.bodies[0];
  elastic.mesh = make_quadrilateral_rectangle({1, 0.25}, {3, 1});
  elastic.element = "Q1";
  elastic.name = "elastic";
  elastic.translate = {0, 1, 0};
  scene.bodies[0].material.law = "yeoh";
  scene.bodies[0].material.viscoelastic = {.g = {0.4}, .tau = {0.01}};
  RegionDescription region;
  region.name = "far";
  region.where.kind = Where::Kind::box;
  region.where.min = {0.5, -1, -1};
  region.where.max = {2, 2, 2};
  scene.bodies[0].regions.push_back(region);
  BodyDescription other = scene.bodies[0];
  other.name = "other";
  other.translate = {0, 2, 0};
  other.regions.clear();
  other.material.viscoelastic = {.g = {0.2, 0.3}, .tau = {0.01, 1}};
  scene.fixes[0].body = scene.probes[0].body = scene.bodies[0].name;
  scene.bodies.push_back(elastic);
  scene.bodies.push_back(other);
  Simulation simulation(scene);
  {
    ResultFolder results(folder / "out");
    const RunOutcome outcome = run_to_end(simulation, {});
    ASSERT_EQ(outcome.status, RunStatus::done) << outcome.reason;
    results.record(simulation, true);
    results.finish(simulation, outcome);
  }
  const std::shared_ptr<const World> world = saved_world(folder / "out");
  const std::filesystem::path file = frame_files(folder / "out").back();
  const State state = state_of_frame(*world, read_vtu(file), file);
  EXPECT_GT(state.history.norm(), 0);
  EXPECT_EQ(state.history, simulation.state().history);
  const std::vector<std::string> names = {"cauchy_stress"};
  EXPECT_EQ(FieldEvaluator(*world).evaluate(state, names)[0].values,
            FieldEvaluator(simulation.world()).evaluate(simulation.state(), names)[0].values);
}

/// The last picture of a run somewhere.
Image picture_at(double distance, const std::filesystem::path& folder) {
  const SavedRun run({3, false, distance}, folder);
  return draw_result(folder, -1, small_picture("von_mises"));
}

TEST(PicturesOfFarScenes, AreThoseOfNearOnes) {
  const TemporaryFolder folder;
  const Image near = picture_at(0, folder / "near"), far = picture_at(1e6, folder / "far");
  std::size_t different = 0;
  for (std::size_t i = 0; i < near.pixels.size(); ++i) different += near.pixels[i] != far.pixels[i] ? 1 : 0;
  EXPECT_LE(different, near.pixels.size() / 1000);  // edges of triangles that end on the edge of a pixel
}

/// Where a ball is then, the frames say.
TEST(FramesOfARunWithColliders, SayHowFarTheseAreBehind) {
  const TemporaryFolder folder;
  Description scene = bar_before_a_fast_ball();
  scene.end_time = 0.2;
  Simulation simulation(scene);
  ResultFolder results(folder / "out");
  std::vector<State> states;
  double longest_delay = 0;
  const auto record = [&](bool is_last) {
    results.record(simulation, is_last);
    states.push_back(simulation.state());
    longest_delay = std::max(longest_delay, simulation.state().collider_delay);
  };
  record(false);
  const RunOutcome outcome =
      run_to_end(simulation, {.after_step = [&](const StepReport&) { record(simulation.is_finished()); }});
  results.finish(simulation, outcome);
  ASSERT_GT(longest_delay, 0);
  const std::shared_ptr<const World> world = world_to_take_up(folder / "out");
  for (std::size_t number = 0; number < states.size(); ++number) {
    const State state = state_to_take_up(folder / "out", *world, number);
    EXPECT_EQ(state.time, states[number].time);
    EXPECT_EQ(state.positions, states[number].positions);
    EXPECT_EQ(state.velocities, states[number].velocities);
    EXPECT_EQ(state.collider_delay, states[number].collider_delay);
  }
}

/// Frames show the mesh of a rigid body, and its control nodes are read back from them.
TEST(FramesOfARigidBody, ShowItsMesh) {
  const TemporaryFolder folder;
  for (const int dim : {2, 3}) {
    Description scene = small_bar(dim, true);
    scene.probes.clear();
    BodyDescription rigid = scene.bodies[0];
    rigid.name = "rigid";
    rigid.mesh = dim == 3 ? make_hexahedron_box({0.2, 0.2, 0.2}, {2, 3, 2})
                          : make_quadrilateral_rectangle({0.2, 0.2}, {2, 3});
    rigid.element.clear();
    rigid.translate = {0, 1, 0};
    rigid.rigid = RigidDescription{.density = 1000};
    rigid.velocity_gradient(0, 1) = -30;
    rigid.velocity_gradient(1, 0) = 30;
    scene.fixes[0].body = "soft";
    scene.bodies[0].name = "soft";
    scene.bodies.insert(scene.bodies.begin(), rigid);
    scene.end_time = 0.1;
    scene.time_step = 0.01;
    scene.output.fields = {"displacement", "averaged_von_mises", "von_mises"};
    Simulation simulation(scene);
    const std::filesystem::path place = folder / std::to_string(dim);
    ResultFolder results(place);
    results.record(simulation, false);
    const RunOutcome outcome = run_to_end(simulation, {});
    results.record(simulation, true);
    results.finish(simulation, outcome);
    const std::filesystem::path file = frame_files(place).back();
    const VtuContent frame = read_vtu(file);
    const auto world = saved_world(place);
    const State state = state_of_frame(*world, frame, file);
    EXPECT_EQ(state.positions, simulation.state().positions);
    EXPECT_EQ(state.velocities, simulation.state().velocities);
    const std::size_t num_cells = dim == 3 ? 12 : 6;
    EXPECT_EQ(
        frame.file.mesh.find_block(dim == 3 ? CellKind::hexahedron : CellKind::quadrilateral)->num_cells(),
        static_cast<Index>(num_cells));
    const auto array = [](const std::vector<VtuValues>& all, const char* name) {
      return *std::ranges::find(all, std::string(name), &VtuValues::name);
    };
    const VtuValues stress = array(frame.cell_data, "von_mises"), bodies = array(frame.cell_data, "body"),
                    displacement = array(frame.point_data, "displacement"),
                    averaged = array(frame.point_data, "averaged_von_mises");
    EXPECT_EQ(std::ranges::count(bodies.values, 0.0), static_cast<std::ptrdiff_t>(num_cells));
    for (std::size_t cell = 0; cell < stress.values.size(); ++cell)
      EXPECT_EQ(std::isnan(stress.values[cell]), bodies.values[cell] == 0);
    // In no time of a turn, distances within the body are those at rest.
    const std::size_t first = static_cast<std::size_t>(world->num_nodes()), count = dim == 3 ? 36 : 12;
    ASSERT_EQ(frame.file.mesh.vertices.size(), first + count);
    const auto rest = [&](std::size_t point) {
      return Vector3(frame.file.mesh.vertices[point] -
                     Eigen::Map<const Vector3>(displacement.values.data() + 3 * point));
    };
    for (std::size_t v = first; v < first + count; ++v) {
      const double now = (frame.file.mesh.vertices[v] - frame.file.mesh.vertices[first]).norm();
      EXPECT_NEAR(now, (rest(v) - rest(first)).norm(), 1e-4);
      EXPECT_TRUE(std::isnan(averaged.values[v]));
      EXPECT_NEAR(rest(v).x(), std::clamp(rest(v).x(), 0.0, 0.2), 1e-12);
    }
    EXPECT_GT(Eigen::Map<const Vector3>(displacement.values.data() + 3 * first).norm(), 0.01);
  }
}

}  // namespace
}  // namespace resilin::testing
