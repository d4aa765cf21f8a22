// Output that cannot be written: words and exit code 1, whoever refuses to take it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Output : ::testing::Test {
  TemporaryFolder folder;
  Output() { folder.write("box.toml", box_scene); }
  ProgramResult sh(const std::string& script) const { return run_shell(folder.path(), script); }
};

// By P2, since a run by P1 warns of its few cells.
const std::vector<std::string> commands = {"--help",
                                           "--version",
                                           "info",
                                           "info --json",
                                           "materials",
                                           "run --help",
                                           "check box.toml",
                                           "run box.toml --set body.0.element=P2",
                                           "materials ogden --curve uniaxial",
                                           "mesh --help"};

TEST_F(Output, ThatNobodyTakesIsAnErrorOfEveryCommand) {
  const std::vector<std::pair<std::string, std::string>> ways = {{"> /dev/full", "the disk is full"},
                                                                 {">&-", "Bad file descriptor"}};
  for (const std::string& command : commands) {
    for (const auto& [way, reason] : ways) {
      const ProgramResult result = sh("\"$RESILIN\" " + command + " " + way);
      EXPECT_EQ(result.exit_code, 1) << command << way;
      EXPECT_EQ(result.err, "resilin: standard output: cannot be written: " + reason + "\n")
          << command << way;
    }
    const ProgramResult piped =
        sh("(sleep 0.2; \"$RESILIN\" " + command + "; echo $? > code) | true; cat code");
    EXPECT_EQ(piped.out, "1\n") << command;
    EXPECT_EQ(piped.err, "resilin: standard output: cannot be written: Broken pipe\n") << command;
  }
  // A full disk behind the messages is no reason to lose the results.
  EXPECT_EQ(read_json(folder / "out/box/report.json")["status"], "done");
}

TEST_F(Output, ThatHeadHasCutOffEndsARunWithACheckpoint) {
  const ProgramResult result =
      sh("(\"$RESILIN\" run box.toml --set body.0.element=P2 --set simulation.kind=dynamic --set "
         "simulation.end_time=1e5; echo $? > code) | head -1; cat code");
  EXPECT_THAT(result.out, AllOf(StartsWith("A box: 1 body"), EndsWith("\n1\n")));
  EXPECT_EQ(result.err, "resilin: standard output: cannot be written: Broken pipe\n");
  const nlohmann::json report = read_json(folder / "out/box/report.json");
  EXPECT_EQ(report["status"], "budget");
  EXPECT_THAT(std::string(report["reason"]), HasSubstr("stopped by a closed pipe"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/box/checkpoint.bin"));
}

/// Every limit on the size of a file, from none at all to just enough for some of them.
/// A wall that bursts under a thousandth of its load is looked at for hundreds of iterations.
TEST_F(Output, TellsOfAStepThatLastsWhileItGoesOn) {
  folder.write("wall.toml", R"([[body]]
name = "wall"
mesh = { box = { size = [0.02, 0.02, 0.001], cells = [24, 24, 1] } }
material = { law = "neo_hookean", youngs_modulus = 1e6, poissons_ratio = 0.49 }
[[fix]]
where = { group = "x_min" }
[[load]]
kind = "pressure"
value = 1e7
where = { group = "z_min" }
)");
  RunningProgram program(folder.path(), {"run", "wall.toml"});
  const std::string line =
      "  0 %  step 1, from load factor 0 by [0-9.e-]+ at most, Newton iteration [0-9]+, residual .* "
      "\\(tolerance 1e-08\\)";
  EXPECT_THAT(program.wait_for(line), ::testing::ContainsRegex(line));
  program.kill(SIGINT);
  EXPECT_EQ(program.finish().exit_code, 2);
}

TEST_F(Output, ThatIsLongerThanAllowedNamesTheFileAndTheLimit) {
  int refused = 0;
  for (const int blocks : {0, 1, 2, 4, 8, 16, 32, 64, 256}) {
    const ProgramResult result =
        sh("ulimit -f " + std::to_string(blocks) + "; exec \"$RESILIN\" run box.toml --quiet 2> /dev/null");
    if (result.exit_code == 0) continue;
    ++refused;
    EXPECT_EQ(result.exit_code, 1) << blocks;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
      EXPECT_EQ(entry.path().string().find(".partial"), std::string::npos) << entry.path();
  }
  EXPECT_GT(refused, 4);
  const ProgramResult told = sh("(ulimit -f 2; \"$RESILIN\" run box.toml --quiet) 2>&1 | cat");
  EXPECT_THAT(told.out,
              HasSubstr("cannot be written: it would be larger than this process may write (ulimit -f)"));
  EXPECT_EQ(told.out.find('\n'), told.out.size() - 1) << told.out;
}

TEST_F(Output, IntoAFullDeviceSaysThatTheDiskIsFullAndIntoALockedFolderDoesNot) {
  const ProgramResult full =
      sh("ln -s /dev/full full.msh; \"$RESILIN\" mesh full.msh --box 1 1 1 --cells 2 2 2");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_THAT(full.err, HasSubstr("full.msh: cannot be written: the disk is full"));
  folder.write("file", "");
  const ProgramResult locked = sh("\"$RESILIN\" run box.toml --out file/out");
  EXPECT_EQ(locked.exit_code, 1);
  EXPECT_EQ(locked.err.find("disk"), std::string::npos) << locked.err;
}

}  // namespace
}  // namespace resilin::testing
