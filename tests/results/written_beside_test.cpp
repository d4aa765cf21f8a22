// Frames that are written while the next step is computed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "run_into.hpp"
#include "small_scenes.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::EndsWith;

class WrittenBeside : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override { set_num_threads(GetParam()); }
  void TearDown() override { set_num_threads(before_); }

 private:
  int before_ = num_threads();
};

std::map<std::string, std::string> files_of(const Description& scene) {
  const TemporaryFolder folder;
  run_into(folder / "run", scene, 3);
  run_into(folder / "run", scene, 0);
  return files_in(folder / "run");
}

Description bar_above_a_floor(int dimension, const std::string& element) {
  Description scene = small_bar(dimension, true);
  scene.bodies[0].element = element;
  scene.fixes.clear();
  ColliderDescription floor;
  floor.name = "floor";
  floor.shape.point = 0.05 * scene.gravity.normalized();
  floor.shape.normal = -scene.gravity.normalized();
  floor.displacement = 0.01 * floor.shape.normal;
  floor.time_function.form = TimeFunction::Sine{.frequency = 2};
  floor.friction = 0.3;
  scene.colliders.push_back(floor);
  scene.output.fields = {"displacement", "velocity", "von_mises", "nodal_pressure", "contact_pressure"};
  scene.output.formats = {OutputFormat::vtu, OutputFormat::html, OutputFormat::usda};
  return scene;
}

TEST_P(WrittenBeside, AreTheFilesOfOneThread) {
  std::vector<Description> scenes = {small_bar(2, false), small_bar(3, true), bar_above_a_floor(2, "P1"),
                                     bar_above_a_floor(3, "P2")};
  for (const Description& scene : scenes) {
    const std::map<std::string, std::string> files = files_of(scene);
    set_num_threads(1);
    EXPECT_GE(files.size(), 5U);
    EXPECT_TRUE(files == files_of(scene)) << scene.colliders.size() << " " << scene.dimension;
    set_num_threads(GetParam());
  }
}

/// A folder stands where the file of the fourth frame is to go.
TEST_P(WrittenBeside, AreToldOfWhereTheyCannotBeWritten) {
  const TemporaryFolder folder;
  const std::filesystem::path blocked = folder / "run" / "frames" / "0003.vtu";
  std::filesystem::create_directories(blocked / "inside");
  const Description scene = small_bar(3, true);
  try {
    run_into(folder / "run", scene, 0);
    ADD_FAILURE() << "nothing is said of " << blocked;
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find(blocked.string()), std::string::npos) << error.what();
  }
  std::filesystem::remove_all(blocked);
  EXPECT_EQ(run_into(folder / "run", scene, 0).status, RunStatus::done);
  EXPECT_EQ(folder.read("run/frames/0003.vtu").empty(), false);
}

/// The frame that is on its way is whole when the folder is left.
TEST_P(WrittenBeside, AreWholeWhenTheRunIsLeft) {
  const TemporaryFolder folder;
  {
    Simulation simulation(small_bar(3, true));
    ResultFolder results(folder / "run");
    results.record(simulation, false);
    simulation.step();
    results.record(simulation, false);
  }
  EXPECT_THAT(folder.read("run/frames/0001.vtu"), EndsWith("</VTKFile>\n"));
}

INSTANTIATE_TEST_SUITE_P(Threads, WrittenBeside, ::testing::Values(1, 2, 4));

}  // namespace
}  // namespace resilin::testing
