// Runs that are broken off and gone on with: the same bits, the same verdict, the same files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "resilin/core/error.hpp"
#include "resilin/integrator/integrator.hpp"
#include "resilin/results/saved_report.hpp"
#include "run_into.hpp"
#include "small_scenes.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

/// Steps that are cut short now and then.
Description failing_scene(const std::string& integrator) {
  Description scene = small_bar(2, true);
  scene.integrator = integrator;
  scene.newton.max_iterations = 1;
  scene.bodies[0].velocity = {0, 3, 0};
  scene.output.every = 3;
  return scene;
}

TEST(ResumedRun, RemembersTheStepsThatHadFailed) {
  std::mt19937 random(4);
  for (const std::string& integrator : integrator_names()) {
    SCOPED_TRACE(integrator);
    const TemporaryFolder folder;
    const Description scene = failing_scene(integrator);
    const RunOutcome whole = run_into(folder / "whole", scene, 0);
    ASSERT_EQ(whole.status, RunStatus::not_converged);
    RunOutcome last;
    do {
      last = run_into(folder / "parts", scene, 1 + static_cast<int>(random() % 4));
    } while (last.status == RunStatus::budget);
    EXPECT_EQ(last.status, whole.status);
    EXPECT_EQ(last.reason, whole.reason);
    EXPECT_EQ(read_report(folder / "parts" / "report.json").frames,
              read_report(folder / "whole" / "report.json").frames);
    EXPECT_EQ(folder.read("parts/checkpoint.bin"), folder.read("whole/checkpoint.bin"));
  }
}

/// Bits of every file, also where a body has several materials; those of other regions are another scene.
TEST(ResumedRun, OfABodyWithRegionsGivesTheSameBits) {
  const TemporaryFolder folder;
  Description scene = small_bar(3, true);
  RegionDescription core;
  core.name = "core";
  core.where.kind = Where::Kind::box;
  core.where.min = {0.5, 0, 0};
  core.where.max = {1, 1, 1};
  core.material.constants["youngs_modulus"] = 4e5;
  core.material.density = 3000;
  scene.bodies[0].regions.push_back(core);
  scene.integrator = "newmark";
  run_into(folder / "whole", scene, 0);
  for (int parts = 0; parts < 3; ++parts) run_into(folder / "parts", scene, 3);
  run_into(folder / "parts", scene, 0);
  EXPECT_EQ(folder.read("parts/checkpoint.bin"), folder.read("whole/checkpoint.bin"));
  EXPECT_EQ(read_report(folder / "parts" / "report.json").frames,
            read_report(folder / "whole" / "report.json").frames);
  scene.bodies[0].regions[0].material.constants["youngs_modulus"] = 5e5;
  try {
    run_into(folder / "parts", scene, 0);
    ADD_FAILURE() << "goes on as another scene";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("body.body.region.core.material.youngs_modulus"));
  }
}

/// A bar thrown long is strained most early on; damping takes the rest.
TEST(ResumedRun, RemembersWhereItWasStrainedMost) {
  const TemporaryFolder folder;
  Description scene = small_bar(3, true);
  scene.bodies[0].velocity_gradient = Vector3(3, 0, 0).asDiagonal();
  scene.bodies[0].damping.mass = 30;
  scene.end_time = 20 * scene.time_step;
  const DiscretisationErrors whole = run_into(folder / "whole", scene, 0).discretisation_errors;
  ASSERT_TRUE(whole[0].has_value());
  for (int parts = 0; parts < 4; ++parts) run_into(folder / "parts", scene, 6);
  EXPECT_EQ(run_into(folder / "parts", scene, 0).discretisation_errors, whole);
  EXPECT_EQ(folder.read("parts/checkpoint.bin"), folder.read("whole/checkpoint.bin"));
}

TEST(ResumedRun, ThatHadEndedSaysSoAndKeepsItsVerdict) {
  for (const bool is_dynamic : {false, true}) {
    const TemporaryFolder folder;
    const Description scene = small_bar(3, is_dynamic);
    const RunOutcome first = run_into(folder / "out", scene, 0);
    const std::string checkpoint = folder.read("out/checkpoint.bin");
    const RunOutcome again = run_into(folder / "out", scene, 0);
    EXPECT_EQ(again.status, first.status);
    EXPECT_THAT(again.reason, HasSubstr("the run had ended before"));
    EXPECT_EQ(folder.read("out/checkpoint.bin"), checkpoint);
  }
}

TEST(ResumedRun, GoesOnToALaterEndWithoutBeingAskedTwice) {
  const TemporaryFolder folder;
  Description scene = small_bar(2, true);
  scene.end_time = 0.3;
  run_into(folder / "whole", scene, 0);
  scene.end_time = 0.1;
  run_into(folder / "longer", scene, 0);
  scene.end_time = 0.3;
  EXPECT_EQ(run_into(folder / "longer", scene, 0).status, RunStatus::done);
  EXPECT_EQ(folder.read("longer/checkpoint.bin"), folder.read("whole/checkpoint.bin"));
}

/// Steps into the folder, and then no more: what a run that is killed leaves.
void run_until_killed(const std::filesystem::path& folder, const Description& scene, int steps) {
  Simulation simulation(scene);
  ResultFolder results(folder);
  results.resume(simulation, Resume::same_scene);
  results.record(simulation, false);
  for (int step = 0; step < steps; ++step) {
    simulation.step();
    results.record(simulation, false);
  }
}

/// A bar that falls onto colliders: a floor and a ball, standing or moving.
Description bar_onto_colliders(int dimension, bool floor_moves, bool ball_moves) {
  Description scene = small_bar(dimension, true);
  const Vector3 down = scene.gravity.normalized();
  ColliderDescription floor;
  floor.name = "floor";
  floor.shape.point = 0.02 * down;
  floor.shape.normal = -down;
  if (floor_moves) floor.velocity = -0.05 * down;
  ColliderDescription ball;
  ball.name = "ball";
  ball.kind = "sphere";
  ball.shape.center = Vector3(1.1, 0.1, dimension == 3 ? 0.1 : 0) + 0.4 * down;
  ball.shape.radius = 0.2;
  if (ball_moves) ball.velocity = -0.1 * down;
  scene.colliders = {floor, ball};
  scene.output.every = 2;
  scene.output.formats = {OutputFormat::vtu, OutputFormat::html, OutputFormat::usda};
  return scene;
}

TEST(ResumedRun, LeavesTheFilesOfTheUnbrokenRunHoweverOftenItWasKilled) {
  std::mt19937 random(7);
  for (const int dimension : {2, 3})
    for (const auto& [floor_moves, ball_moves] :
         {std::pair(false, false), std::pair(true, false), std::pair(false, true), std::pair(true, true)}) {
      SCOPED_TRACE(std::to_string(dimension) + (floor_moves ? " floor" : "") + (ball_moves ? " ball" : ""));
      const TemporaryFolder folder;
      const Description scene = bar_onto_colliders(dimension, floor_moves, ball_moves);
      run_into(folder / "whole", scene, 0);
      run_until_killed(folder / "parts", scene, 2);
      for (int part = 0; part < 3; ++part) {
        run_into(folder / "parts", scene, 1 + static_cast<int>(random() % 3));
        run_until_killed(folder / "parts", scene, static_cast<int>(random() % 4));
      }
      run_into(folder / "parts", scene, 0);
      const auto whole = files_in(folder / "whole"), parts = files_in(folder / "parts");
      EXPECT_EQ(whole.contains("colliders/0001.vtu"), floor_moves || ball_moves);
      for (const auto& [name, bytes] : whole)
        EXPECT_TRUE(parts.contains(name) && parts.at(name) == bytes) << name;
      EXPECT_EQ(parts.size(), whole.size());
    }
}

/// As if killed at its very end: all is made of its frames, and the checkpoint is still one from before.
TEST(ResumedRun, MakesTheSameOnceMoreWhereItEndedBeforeItsLastCheckpoint) {
  const TemporaryFolder folder;
  const Description scene = bar_onto_colliders(3, true, true);
  run_into(folder / "whole", scene, 0);
  run_into(folder / "parts", scene, 4);
  const std::filesystem::path checkpoint = folder / "parts" / "checkpoint.bin";
  const std::filesystem::path kept = folder / "kept.bin";
  {
    Simulation simulation(scene);
    ResultFolder results(folder / "parts");
    results.resume(simulation, Resume::same_scene);
    const RunOutcome outcome = run_to_end(simulation, {.after_step = [&](const StepReport&) {
                                            results.record(simulation, simulation.is_finished());
                                          }});
    ASSERT_EQ(outcome.status, RunStatus::done);
    std::filesystem::rename(checkpoint, kept);
    std::filesystem::create_directories(checkpoint / "in the way");
    EXPECT_THROW(results.finish(simulation, outcome), FileError);
    std::filesystem::remove_all(checkpoint);
    std::filesystem::rename(kept, checkpoint);
  }
  run_into(folder / "parts", scene, 0);
  const auto whole = files_in(folder / "whole"), parts = files_in(folder / "parts");
  for (const auto& [name, bytes] : whole)
    EXPECT_TRUE(parts.contains(name) && parts.at(name) == bytes) << name;
  EXPECT_EQ(parts.size(), whole.size());
}

/// Files in the folder are kept where they are of the scene that is gone on with, and only there.
TEST(ResumedRun, WritesCollidersAnewThatHaveNoFileOrAreOfAnotherScene) {
  const TemporaryFolder folder;
  Description scene = bar_onto_colliders(3, false, false);
  run_into(folder / "out", scene, 2);
  const std::string first = folder.read("out/colliders/0000.vtu");
  std::filesystem::remove(folder / "out" / "colliders" / "0000.vtu");
  run_into(folder / "out", scene, 2);
  EXPECT_FALSE(folder.read("out/colliders/0000.vtu").empty());
  scene.colliders[1].shape.radius = 0.1;
  run_into(folder / "out", scene, 2, Resume::anyway);
  const std::string other = folder.read("out/colliders/0000.vtu");
  EXPECT_TRUE(other != first);
  run_into(folder / "out", scene, 0);
  EXPECT_TRUE(folder.read("out/colliders/0000.vtu") == other);
}

/// The clock goes on where it stood, whatever the steps are from there on.
TEST(ResumedRun, WithOtherStepsGoesOnFromTheTimeThatItHadReached) {
  for (const double factor : {0.25, 0.7, 3.0}) {
    const TemporaryFolder folder;
    Description scene = small_bar(2, true);
    scene.end_time = 1;
    run_into(folder / "out", scene, 4);
    const double reached = 4 * scene.time_step;
    scene.time_step *= factor;
    run_into(folder / "out", scene, 2, Resume::anyway);
    EXPECT_EQ(run_into(folder / "out", scene, 1).status, RunStatus::budget);  // the same scene by now
    const SavedReport report = read_report(folder / "out" / "report.json");
    ASSERT_EQ(report.frames.size(), 8u);
    for (int step = 5; step <= 7; ++step) {
      const double time = report.frames[static_cast<std::size_t>(step)]["time"];
      EXPECT_NEAR(time, reached + (step - 4) * scene.time_step, 1e-15);
    }
  }
}

TEST(ResultFolder, SweepsUpWhatAKilledRunHasLeftAndNothingElse) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "frames");
  const std::vector<std::string> left = {"report.json.partial.4194300.0", "frames/0003.vtu.partial",
                                         "checkpoint.bin.partial.12.3"};
  const std::vector<std::string> others = {"notes.partial.txt", "partial", "my.partially.done",
                                           "frames/a.vtu"};
  for (const std::string& name : left) folder.write(name, "half");
  for (const std::string& name : others) folder.write(name, "whole");
  const ResultFolder results(folder.path());
  for (const std::string& name : left) EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
  for (const std::string& name : others) EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
}

}  // namespace
}  // namespace resilin::testing
