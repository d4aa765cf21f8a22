#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

/// Motion long enough to be stopped on its way.
const std::vector<std::string> motion = {
    "run", "box.toml", "--quiet", "--set", "simulation.kind=dynamic", "--set", "simulation.end_time=0.6"};

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

struct RunCommand : ::testing::Test {
  TemporaryFolder folder;
  RunCommand() { folder.write("box.toml", box_scene); }
  std::filesystem::path out() const { return folder.path() / "out" / "box"; }
  nlohmann::json report(const std::string& name) const {
    return read_json(folder.path() / name / "report.json");
  }
};

TEST_F(RunCommand, LeavesReportFramesCheckpointAndLog) {
  const ProgramResult result = run_program(folder.path(), {"run", "box.toml", "--set", "body.0.element=P2"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, HasSubstr("done: reached load factor 1"));
  EXPECT_THAT(result.out, HasSubstr("out/box/report.json"));
  for (const char* name :
       {"report.json", "frames.pvd", "frames/0000.vtu", "frames/0001.vtu", "checkpoint.bin", "log.txt"}) {
    EXPECT_GT(std::filesystem::file_size(out() / name), 0u) << name;
  }
}

TEST_F(RunCommand, ChoosesAnElementAndReportsWhy) {
  const auto body_with = [this](const std::string& assignment) {
    const ProgramResult result =
        run_program(folder.path(), {"run", "box.toml", "--set", "body.0.element=auto", "--set", assignment});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_json(out() / "report.json")["bodies"][0];
  };
  const nlohmann::json still = body_with("title=still");
  EXPECT_EQ(still["element"], "P2");
  EXPECT_EQ(still["quadrature"], "4-point");
  EXPECT_EQ(still["vertices"], 45);
  EXPECT_EQ(still["unknowns"], 3 * 225);  // 180 edges
  EXPECT_THAT(std::string(still["element_reason"]), HasSubstr("quadratic"));
  EXPECT_EQ(body_with("body.0.material.poissons_ratio=0.49")["element"], "P2P0");
  EXPECT_EQ(body_with("body.0.mesh.box.kind=hexahedra")["element"], "Q1");
}

TEST_F(RunCommand, ReportsWhatTheContractNames) {
  ASSERT_EQ(run_program(folder.path(), {"run", "box.toml", "--threads", "1"}).exit_code, 0);
  const nlohmann::json report = read_json(out() / "report.json");
  EXPECT_EQ(report["status"], "done");
  EXPECT_EQ(report["title"], "A box");
  EXPECT_EQ(report["threads"], 1);
  for (const char* key : {"reason", "version", "frames", "bodies", "timing", "peak_memory_MiB"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  for (const char* key : {"total", "assembly", "solve", "estimate", "output"})
    EXPECT_TRUE(report["timing"].contains(key)) << key;
  const nlohmann::json& body = report["bodies"][0];
  EXPECT_EQ(body["law"], "neo_hookean");
  EXPECT_EQ(body["cells"], 96);
  EXPECT_EQ(body["vertices"], 45);
  EXPECT_EQ(body["unknowns"], 135);
  EXPECT_EQ(body["quadrature"], "1-point");
  EXPECT_NEAR(body["constants"]["shear_modulus"].get<double>(), 1e6 / 2.6, 1e-6);
  const nlohmann::json& frame = report["frames"].back();
  for (const char* key :
       {"step", "time", "load", "newton_iterations", "residual", "min_volume_ratio", "energy", "momentum"}) {
    EXPECT_TRUE(frame.contains(key)) << key;
  }
  EXPECT_LT(frame["probes"]["tip"]["displacement"][2].get<double>(), 0);
  // The wall carries the weight: 2 m^3 of 1000 kg/m^3. The residual of the equilibrium is far below 1e-6.
  EXPECT_NEAR(frame["reactions"]["wall"][2].get<double>(), 2 * 1000 * 9.81, 2e-2);
  // About the origin, which lies at the wall's edge: the weight's arm along x is 1 m, less what the beam
  // sags.
  EXPECT_NEAR(frame["reaction_moments"]["wall"][1].get<double>(), -2 * 1000 * 9.81, 600);
}

/// Whatever `check` warns of, `run` warns of too, and the report keeps it.
TEST_F(RunCommand, WarnsAsCheckDoes) {
  const std::vector<std::vector<std::string>> oddities = {
      {"--set", "body.0.scale=5000"},
      {"--set", "body.0.material.youngs_modulus=1e3"},
      {"--set", "simulation.gravity=[0, 0, 0]"},
      {"--set", "probe.0.at=[9, 9, 9]"},
      {"--set", "simulation.kind=dynamic", "--set", "simulation.time_step=1000", "--set",
       "simulation.end_time=2000"}};
  for (const std::vector<std::string>& changes : oddities) {
    const ProgramResult checked = run_program(folder.path(), with({"check", "box.toml"}, changes));
    EXPECT_EQ(checked.exit_code, 0);
    EXPECT_THAT(checked.err, HasSubstr("warning: ")) << changes[1];
    const ProgramResult result =
        run_program(folder.path(), with({"run", "box.toml", "--steps", "1"}, changes));
    EXPECT_EQ(result.err.substr(0, checked.err.size()), checked.err);
    const nlohmann::json report = read_json(out() / "report.json");
    ASSERT_FALSE(report["warnings"].empty());
    EXPECT_EQ("warning: " + report["warnings"][0].get<std::string>() + "\n",
              checked.err.substr(0, checked.err.find('\n') + 1));
  }
}

TEST_F(RunCommand, WarnsOfCellsInsideOutAtTheEnd) {
  const ProgramResult result =
      run_program(folder.path(), {"run", "box.toml", "--set", "body.0.material.law=linear_elastic", "--set",
                                  "simulation.gravity=[9000, 0, -9000]"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("inverted"));
  EXPECT_THAT(result.out, HasSubstr("inverted"));
  EXPECT_THAT(read_json(out() / "report.json")["warnings"].dump(), HasSubstr("inverted"));
}

TEST_F(RunCommand, SaysHowFarOffCoarseCellsMayBeAtRestAndInMotion) {
  const std::vector<std::string> still = {"run", "box.toml"};
  for (const std::vector<std::string>& kind :
       {still, with(still, {"--set", "simulation.kind=dynamic", "--set", "simulation.end_time=0.3"})}) {
    const ProgramResult coarse = run_program(folder.path(), kind);
    const double error = read_json(out() / "report.json")["bodies"][0]["discretisation_error"];
    EXPECT_GT(error, 0.1);
    EXPECT_THAT(coarse.err, HasSubstr("warning: box.toml: \"box\" has an estimated discretisation error of"));
    EXPECT_THAT(coarse.err, HasSubstr("element = \"P2\" or finer cells"));
    EXPECT_THAT(read_json(out() / "report.json")["warnings"].dump(),
                HasSubstr("has an estimated discretisation error of"));
    const ProgramResult finer = run_program(folder.path(), with(kind, {"--set", "body.0.element=auto"}));
    EXPECT_LT(read_json(out() / "report.json")["bodies"][0]["discretisation_error"].get<double>(), 0.03);
    EXPECT_EQ(finer.err, "");
    EXPECT_THAT(finer.out, HasSubstr("estimated discretisation error: "));
    const bool is_still = kind == still;
    EXPECT_EQ(read_json(out() / "report.json")["bodies"][0]["discretisation_error_by"],
              is_still ? "richer space" : "recovered stress");
    EXPECT_EQ(finer.out.find("(box, P2, by recovered stress)") == std::string::npos, is_still);
  }
}

TEST_F(RunCommand, NamesRecoveredStressForViscoelasticBodiesAtRest) {
  std::string scene(box_scene);
  const std::string law = "material = { ";
  const std::size_t found = scene.find(law);
  ASSERT_NE(found, std::string::npos);
  scene.insert(found + law.size(), "viscoelastic = { g = [0.3], tau = [0.1] }, ");
  folder.write("box.toml", scene);
  const ProgramResult result = run_program(folder.path(), {"run", "box.toml", "--set", "body.0.element=P2P0",
                                                           "--set", "body.0.material.law=neo_hookean_simo"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("(box, P2P0, by recovered stress)"));
  EXPECT_EQ(read_json(out() / "report.json")["bodies"][0]["discretisation_error_by"], "recovered stress");
}

TEST_F(RunCommand, PrintsNothingWhenQuiet) {
  const ProgramResult result =
      run_program(folder.path(), {"run", "box.toml", "--quiet", "--set", "body.0.element=P2"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out + result.err, "");
}

TEST_F(RunCommand, GivesTheSameFramesForOneAndTwoThreads) {
  for (const std::string threads : {"1", "2"}) {
    ASSERT_EQ(run_program(folder.path(), with(motion, {"--threads", threads, "--out", threads})).exit_code,
              0);
  }
  EXPECT_EQ(report("1")["frames"], report("2")["frames"]);
  EXPECT_EQ(read_text_file(folder.path() / "1/checkpoint.bin"),
            read_text_file(folder.path() / "2/checkpoint.bin"));
}

TEST_F(RunCommand, ResumesToTheBitsOfTheUnbrokenRun) {
  const std::vector<std::string> every = {"--set", "output.every=7"};
  ASSERT_EQ(run_program(folder.path(), with(with(motion, every), {"--out", "whole"})).exit_code, 0);
  const ProgramResult stopped =
      run_program(folder.path(), with(with(motion, every), {"--out", "parts", "--steps", "10"}));
  EXPECT_EQ(stopped.exit_code, 2);
  EXPECT_THAT(stopped.err, HasSubstr("stopped after 10 steps as asked"));
  EXPECT_EQ(report("parts")["status"], "budget");
  ASSERT_EQ(run_program(folder.path(), with(with(motion, every), {"--out", "parts", "--resume"})).exit_code,
            0);
  EXPECT_EQ(report("whole")["frames"], report("parts")["frames"]);
  EXPECT_EQ(read_text_file(folder.path() / "whole/checkpoint.bin"),
            read_text_file(folder.path() / "parts/checkpoint.bin"));
  EXPECT_EQ(read_text_file(folder.path() / "whole/frames/0003.vtu"),
            read_text_file(folder.path() / "parts/frames/0003.vtu"));
}

TEST_F(RunCommand, StopsAtAnInterruptWithACheckpointAndAReport) {
  const std::vector<std::string> endless =
      with(motion, {"--set", "simulation.end_time=1e6", "--out", "stopped"});
  const ProgramResult result =
      run_program_until(folder.path(), endless, "stopped", "frames/0005.vtu", SIGINT);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("stopped by the user at t = "));
  const nlohmann::json stopped = report("stopped");
  EXPECT_EQ(stopped["status"], "budget");
  EXPECT_GE(stopped["frames"].size(), 6u);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "stopped/checkpoint.bin"));
}

TEST_F(RunCommand, LeavesWholeFilesToResumeFromWhenItIsKilled) {
  ASSERT_EQ(run_program(folder.path(), with(motion, {"--out", "whole"})).exit_code, 0);
  const ProgramResult killed = run_program_until(folder.path(), with(motion, {"--out", "killed"}), "killed",
                                                 "frames/0010.vtu", SIGKILL);
  ASSERT_EQ(killed.exit_code, 128 + SIGKILL);
  EXPECT_EQ(report("killed")["status"], "running");
  ASSERT_EQ(run_program(folder.path(), with(motion, {"--out", "killed", "--resume"})).exit_code, 0);
  EXPECT_EQ(report("whole")["frames"], report("killed")["frames"]);
}

TEST_F(RunCommand, LeavesAnExistingResultAloneWhenTheSceneIsWrong) {
  ASSERT_EQ(run_program(folder.path(), {"run", "box.toml"}).exit_code, 0);
  const std::string before = read_text_file(out() / "report.json") + read_text_file(out() / "log.txt");
  ASSERT_EQ(
      run_program(folder.path(), {"run", "box.toml", "--set", "body.0.material.poissons_ratio=1"}).exit_code,
      1);
  EXPECT_EQ(read_text_file(out() / "report.json") + read_text_file(out() / "log.txt"), before);
}

}  // namespace
}  // namespace resilin::testing
