// Runs that are short of address space answer soon: with the result of an unlimited one, or in one line.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

struct ShortMemory : ::testing::Test {
  TemporaryFolder folder;
  int num_results = 0, num_refusals = 0;

  void SetUp() override { folder.write("box.toml", box_scene); }

  ProgramResult run_limited(const std::string& megabytes, const std::string& options) const {
    const std::string limit = megabytes == "unlimited" ? megabytes : megabytes + "000";
    return run_shell(folder.path(),
                     "rm -rf out; ulimit -v " + limit +
                         "; exec timeout -s KILL 60 \"$RESILIN\" run box.toml --quiet --out out " + options);
  }
  /// Words of the last frame, and whether its bits are those of the solver that was asked for.
  std::pair<std::string, bool> outcome() const {
    const bool is_same_solver =
        read_text_file(folder / "out/log.txt").find("solves instead") == std::string::npos;
    std::string frames;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "out/frames"))
      frames = std::max(frames, entry.path().string());
    return {read_text_file(frames), is_same_solver};
  }
  void expect_an_answer(const std::string& megabytes, const std::string& options, const std::string& wanted) {
    SCOPED_TRACE(options + " in " + megabytes + " MB");
    const ProgramResult result = run_limited(megabytes, options);
    if (result.exit_code == 0) {
      ++num_results;
      const auto [frame, is_same_solver] = outcome();
      EXPECT_TRUE(!is_same_solver || frame == wanted);
    } else if (result.exit_code == 1) {
      ++num_refusals;
      EXPECT_THAT(result.err, MatchesRegex("resilin: out of memory: [^\n]+\n"));
    } else {
      EXPECT_EQ(result.exit_code, 127);  // the system could not load the program
      EXPECT_THAT(result.err, HasSubstr("error while loading shared libraries"));
    }
  }
};

TEST_F(ShortMemory, EndsInTheSameResultOrInOneLine) {
  const std::string statics, moving = "--set simulation.kind=dynamic --set simulation.end_time=0.05 ",
                             modes = "--set simulation.kind=modes --set simulation.gravity=[0,0,0] ";
  for (const std::string& kind : {statics, moving, modes}) {
    for (const std::string solver : {"auto", "cholesky", "multifrontal", "ldlt", "cg_amg", "cg_ic0"}) {
      const std::string options = kind + "--set solver.kind=" + solver;
      ASSERT_EQ(run_limited("unlimited", options).exit_code, 0);
      const std::string wanted = outcome().first;
      for (const std::string megabytes : {"60", "150", "200", "260", "400", "700", "1500"})
        expect_an_answer(megabytes, options, wanted);
    }
  }
  EXPECT_GT(num_results, 0);
  EXPECT_GT(num_refusals, 0);
}

/// The memory of a large mesh is known before it is taken, so that the answer is there before a step is.
TEST_F(ShortMemory, IsForeseenForLargeMeshesAndSaysWhatWouldFit) {
  folder.write("box.toml",
               std::regex_replace(box_scene, std::regex(R"(cells = \[4, 2, 2\])"), "cells = [60, 30, 30]"));
  int num_foreseen = 0;
  for (const std::string solver : {"cg_amg", "cg_ic0"})
    for (const std::string megabytes : {"250", "290", "330"}) {
      SCOPED_TRACE(solver + " in " + megabytes + " MB");
      const ProgramResult result = run_limited(megabytes, "--threads 1 --set solver.kind=" + solver);
      if (result.exit_code == 0) continue;
      EXPECT_EQ(result.exit_code, 1);
      EXPECT_THAT(result.err, MatchesRegex("resilin: out of memory: [^\n]+\n"));
      if (result.err.find(" would fit: take fewer") != std::string::npos) ++num_foreseen;
    }
  EXPECT_GT(num_foreseen, 0);
}

/// So is what a box of very many cells needs before there are equations: its cells, their surface, the body.
TEST_F(ShortMemory, IsForeseenForBoxesAndBodiesThatAreTooLarge) {
  const auto refusal = [&](const std::string& cells, const std::string& element,
                           const std::string& megabytes) {
    folder.write("box.toml", std::regex_replace(box_scene, std::regex(R"(cells = \[4, 2, 2\])"),
                                                "cells = [" + cells + "]"));
    const ProgramResult result = run_limited(megabytes, "--threads 1 --set body.box.element=" + element);
    EXPECT_EQ(result.exit_code, 1) << cells;
    EXPECT_THAT(result.err, MatchesRegex("resilin: out of memory: [^\n]+\n"));
    EXPECT_THAT(result.err, HasSubstr(" cells would fit"));
    return result.err;
  };
  EXPECT_THAT(refusal("240, 60, 60", "P1", "150"), HasSubstr("a box of 5184000 cells needs "));
  EXPECT_THAT(refusal("160, 40, 40", "P1", "200"), HasSubstr("finding the surface of 1536000 cells needs "));
  EXPECT_THAT(refusal("40, 20, 20", "P2", "200"), HasSubstr("a body of 96000 cells of P2 needs "));
}

}  // namespace
}  // namespace resilin::testing
