// Runs that are told to end, are killed, or meet one another: nothing is lost, and nobody is in the way.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;
using Words = std::vector<std::string>;

struct Signals : ::testing::Test {
  TemporaryFolder folder;
  Signals() { folder.write("box.toml", box_scene); }

  static Words motion(const std::string& end_time, const std::string& out, const Words& more = {}) {
    Words words = {"run",
                   "box.toml",
                   "--quiet",
                   "--set",
                   "simulation.kind=dynamic",
                   "--set",
                   "simulation.end_time=" + end_time,
                   "--out",
                   out};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  void wait_for_file(const std::string& name, const RunningProgram& program) const {
    while (!std::filesystem::exists(folder / name) && program.is_running())
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  /// Whole files and nothing else.
  void expect_clean(const std::string& out) const {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / out)) {
      const std::string name = entry.path().filename().string();
      EXPECT_EQ(name.find(".partial"), name.npos) << entry.path();
      EXPECT_NE(name, "run.lock");
      EXPECT_NE(name, ".probe");
    }
  }
};

TEST_F(Signals, EndARunWithACheckpointAReportAndExitCodeTwo) {
  const std::vector<std::pair<int, std::string>> signals = {
      {SIGINT, "the user"}, {SIGTERM, "SIGTERM"}, {SIGHUP, "SIGHUP"}};
  for (const auto& [number, words] : signals) {
    for (const int times : {1, 2}) {  // `timeout` and closing terminals send theirs twice
      SCOPED_TRACE(words + " x " + std::to_string(times));
      RunningProgram program(folder.path(), motion("1e5", "out"));
      wait_for_file("out/frames/0003.vtu", program);
      for (int i = 0; i < times; ++i) {
        program.kill(number);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      const ProgramResult result = program.finish();
      EXPECT_EQ(result.exit_code, 2) << result.err;
      EXPECT_THAT(result.err, HasSubstr("stopped by " + words + " at t = "));
      const nlohmann::json report = read_json(folder / "out/report.json");
      EXPECT_EQ(report["status"], "budget");
      EXPECT_THAT(std::string(report["reason"]), HasSubstr("stopped by " + words));
      EXPECT_TRUE(std::filesystem::exists(folder / "out/checkpoint.bin"));
      expect_clean("out");
      std::filesystem::remove_all(folder / "out");
    }
  }
}

TEST_F(Signals, OfAClosedTerminalDoNotEndARunThatWasStartedToIgnoreThem) {
  const ProgramResult result = run_shell(
      folder.path(),
      "trap '' HUP; \"$RESILIN\" run box.toml --quiet --set simulation.kind=dynamic --set "
      "simulation.end_time=1e5 "
      "--out out & p=$!; while [ ! -e out/frames/0002.vtu ]; do sleep 0.05; done; kill -HUP $p; sleep 0.3; "
      "kill -0 $p && echo goes on; kill -TERM $p; wait $p; echo code $?");
  EXPECT_EQ(result.out, "goes on\ncode 2\n") << result.err;
}

/// Whatever ends a run, and whenever: it goes on to the same bits.
TEST_F(Signals, AtRandomTimesLoseNothing) {
  ASSERT_EQ(run_program(folder.path(), motion("0.8", "whole")).exit_code, 0);
  std::mt19937 random(8);
  constexpr std::array signals = {SIGKILL, SIGKILL, SIGTERM, SIGHUP, SIGINT};
  for (int round = 0; round < 6; ++round) {
    const std::string out = "out" + std::to_string(round);
    for (int part = 0; part < 4; ++part) {
      RunningProgram program(folder.path(), motion("0.8", out, {"--resume"}));
      std::this_thread::sleep_for(std::chrono::milliseconds(random() % 400));
      const int number = signals[random() % signals.size()];
      program.kill(number);
      const int code = program.finish().exit_code;
      // It was not there yet to listen, it had ended already, or it did as it was told.
      EXPECT_TRUE(code == 0 || code == 2 || code == 128 + number) << code << " by " << number;
    }
    const ProgramResult rest = run_program(folder.path(), motion("0.8", out, {"--resume"}));
    ASSERT_EQ(rest.exit_code, 0) << rest.err;
    EXPECT_EQ(read_json(folder / out / "report.json")["frames"],
              read_json(folder / "whole/report.json")["frames"]);
    EXPECT_EQ(folder.read(out + "/checkpoint.bin"), folder.read("whole/checkpoint.bin"));
    EXPECT_EQ(folder.read(out + "/frames/0080.vtu"), folder.read("whole/frames/0080.vtu"));
    expect_clean(out);
  }
}

TEST_F(Signals, TwoRunsIntoOneFolderAreOneTooMany) {
  RunningProgram first(folder.path(), motion("1e5", "out"));
  wait_for_file("out/frames/0002.vtu", first);
  TemporaryFolder elsewhere;  // its output would go where that of the first does
  elsewhere.write("box.toml", box_scene);
  for (const Words& more : {Words{}, Words{"--resume"}}) {
    const ProgramResult second = run_program(elsewhere.path(), motion("1", (folder / "out").string(), more));
    EXPECT_EQ(second.exit_code, 1);
    EXPECT_THAT(second.err, HasSubstr("process " + std::to_string(first.process()) + " on "));
    EXPECT_THAT(second.err, HasSubstr("wait until it ends"));
    EXPECT_EQ(second.err.find('\n'), second.err.size() - 1);
  }
  EXPECT_TRUE(first.is_running());
  first.kill(SIGKILL);
  first.finish();
  EXPECT_TRUE(std::filesystem::exists(folder / "out/run.lock"));
  EXPECT_EQ(run_program(elsewhere.path(), motion("0.05", (folder / "out").string())).exit_code, 0);
  EXPECT_THAT(folder.read("out/log.txt"), HasSubstr("which did not end its run"));
  expect_clean("out");
}

}  // namespace
}  // namespace resilin::testing
