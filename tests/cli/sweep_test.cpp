// Sweeps: resumed after being killed at any moment, shared by processes, and what they print.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <map>
#include <random>
#include <sstream>
#include <thread>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;
using Words = std::vector<std::string>;

struct SweepCommand : ::testing::Test {
  TemporaryFolder folder;
  SweepCommand() { folder.write("box.toml", box_scene); }

  void write(const std::string& text) const { folder.write("sweep.toml", "base = \"box.toml\"\n" + text); }
  ProgramResult sweep(const Words& more = {}) const { return run_program(folder.path(), arguments(more)); }
  static Words arguments(const Words& more) {
    Words words = {"sweep", "sweep.toml", "--out", "out"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// Hash and quantities of each line of the table.
  std::map<std::string, std::string> table(const std::string& out = "out") const {
    std::istringstream lines(read_text_file(folder / out / "results.csv"));
    std::map<std::string, std::string> table;
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      std::istringstream cells(line);
      std::string scene, hash, modulus, status, tip;
      std::getline(cells, scene, ',');
      std::getline(cells, hash, ',');
      std::getline(cells, modulus, ',');
      std::getline(cells, status, ',');
      std::getline(cells, tip, ',');
      EXPECT_TRUE(table.emplace(scene, hash + " " + modulus + " " + status + " " + tip).second) << scene;
    }
    return table;
  }
};

const std::string forty =
    "quantities = [\"probe.tip.displacement.z\"]\n[parameters]\n"
    "body.box.material.youngs_modulus = { logspace = [1e5, 1e7, 40] }\n";

TEST_F(SweepCommand, RunsAndPrintsWhatItDoes) {
  write(forty);
  const ProgramResult result = sweep();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, HasSubstr("sweep.toml: 40 scenes"));
  EXPECT_THAT(result.out, HasSubstr("40 of 40 done; 40 run here"));
  EXPECT_THAT(result.out, HasSubstr("out/results.csv"));
  EXPECT_EQ(table().size(), 40u);
  const ProgramResult again = sweep();
  EXPECT_THAT(again.out, HasSubstr("40 of 40 done; 0 run here"));
  EXPECT_EQ(sweep({"--quiet"}).out, "");
}

TEST_F(SweepCommand, SaysHowManyAndHowLong) {
  write(forty);
  const ProgramResult before = sweep({"--dry-run", "--threads", "1"});
  EXPECT_EQ(before.exit_code, 0) << before.err;
  EXPECT_THAT(before.out, HasSubstr("40 scenes, 0 of 40 done; 40 to run"));
  EXPECT_THAT(before.out, HasSubstr("one scene took"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  sweep({"--shard", "1/4"});
  const std::string before_looking = read_text_file(folder / "out" / "sweep.json");
  EXPECT_THAT(sweep({"--dry-run"}).out, HasSubstr("40 scenes, 10 of 40 done; 30 to run"));
  folder.write("box.toml", box_scene + "[newton]\ntolerance = 1e-9\n");
  EXPECT_EQ(sweep({"--dry-run"}).exit_code, 1);
  EXPECT_THAT(sweep({"--dry-run", "--update"}).out, HasSubstr("40 to run"));
  EXPECT_EQ(read_text_file(folder / "out" / "sweep.json"), before_looking);
}

TEST_F(SweepCommand, EndsWithTwoWhenScenesFail) {
  write("[parameters]\nbody.box.material.poissons_ratio = [0.3, 0.6]\n");
  const ProgramResult result = sweep();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("scene 1 (body.box.material.poissons_ratio = 0.6): refused"));
  EXPECT_THAT(result.out, HasSubstr("--retry-failed runs them again"));
  EXPECT_THAT(sweep({"--retry-failed"}).out, HasSubstr("1 run here"));
}

TEST_F(SweepCommand, RefusesInOneLine) {
  write("[parameters]\nbody.box.material.youngs_modulos = [1]\n");
  const ProgramResult key = sweep();
  EXPECT_EQ(key.exit_code, 1);
  EXPECT_THAT(key.err, HasSubstr("did you mean \"youngs_modulus\"?"));
  EXPECT_EQ(std::ranges::count(key.err, '\n'), 1) << key.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  write(forty);
  EXPECT_THAT(sweep({"--shard", "5/4"}).err, HasSubstr("i/n with i from 1 to n"));
  sweep({"--shard", "1/40"});
  write("[parameters]\nbody.box.scale = [1]\n");
  const ProgramResult other = sweep();
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("a folder of this sweep"));
  EXPECT_EQ(std::ranges::count(other.err, '\n'), 1) << other.err;
  EXPECT_EQ(sweep({"--update"}).exit_code, 0);
}

/// Killed again and again, at random moments, the sweep ends with the table of an unbroken one, and has run
/// no scene twice but those that a kill has met on their way.
TEST_F(SweepCommand, LosesNothingWhenItIsKilledAtAnyMoment) {
  write(forty + "\n");
  EXPECT_EQ(run_program(folder.path(), {"sweep", "sweep.toml", "--out", "whole", "--quiet"}).exit_code, 0);
  std::mt19937 random(7);
  int kills = 0;
  for (int i = 0; i < 200; ++i) {
    RunningProgram program(folder.path(), arguments({"--quiet"}));
    std::this_thread::sleep_for(std::chrono::milliseconds(std::uniform_int_distribution(1, 60)(random)));
    const bool was_running = program.is_running();
    program.kill(SIGKILL);
    program.finish();
    if (!was_running) break;
    ++kills;
  }
  EXPECT_GT(kills, 0);
  const ProgramResult end = sweep();
  EXPECT_EQ(end.exit_code, 0) << end.err;
  EXPECT_THAT(end.out, HasSubstr("40 of 40 done"));
  const auto unbroken = table("whole"), resumed = table("out");
  EXPECT_EQ(resumed, unbroken);
}

TEST_F(SweepCommand, ProcessesShareAFolder) {
  write(forty);
  RunningProgram first(folder.path(), arguments({})), second(folder.path(), arguments({}));
  const ProgramResult one = first.finish(), two = second.finish();
  EXPECT_EQ(one.exit_code, 0) << one.err;
  EXPECT_EQ(two.exit_code, 0) << two.err;
  std::size_t lines = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder / "out" / "rows")) {
    const std::string text = read_text_file(file.path());
    lines += static_cast<std::size_t>(std::ranges::count(text, '\n'));
  }
  EXPECT_EQ(lines, 40u);
  EXPECT_EQ(table().size(), 40u);
}

TEST_F(SweepCommand, StopsAtAnInterruptAndGoesOn) {
  write("[parameters]\nsimulation.kind = [\"dynamic\"]\nsimulation.end_time = [0.1, 1e5]\n");
  RunningProgram program(folder.path(), arguments({"--jobs", "1"}));
  while (!std::filesystem::exists(folder / "out" / "rows") && program.is_running())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  program.kill(SIGINT);
  const ProgramResult result = program.finish();
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_THAT(result.err, HasSubstr("stopped by the user"));
  EXPECT_THAT(result.err, HasSubstr("the same command continues"));
}

TEST_F(SweepCommand, SaysThatTheDiskIsFullAndKeepsWhatThereIs) {
  write(forty);
  const ProgramResult full =
      run_shell(folder.path(), "ulimit -f 16; \"$RESILIN\" sweep sweep.toml --out out --quiet");
  EXPECT_EQ(full.exit_code, 1) << full.out;
  EXPECT_THAT(full.err, HasSubstr("cannot be written"));
  const ProgramResult end = sweep();
  EXPECT_EQ(end.exit_code, 0) << end.err;
  EXPECT_THAT(end.out, HasSubstr("40 of 40 done"));
  EXPECT_EQ(table().size(), 40u);
}

}  // namespace
}  // namespace resilin::testing
