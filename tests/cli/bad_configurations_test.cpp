#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "program.hpp"
#include "shared_data.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

/// An entry of "configurations" in tests/data/bad_inputs/index.json in our words.
struct Configuration {
  std::vector<std::string> settings;  ///< --set on the box scene
  int exit_code = 1;
  std::vector<std::string> named;  ///< parts of the message
};

const std::map<std::string, Configuration>& configurations() {
  static const std::map<std::string, Configuration> table = {
      {"rho_zero", {{"simulation.kind=dynamic", "body.0.material.density=0"}, 1, {"density"}}},
      {"rho_negative", {{"body.0.material.density=-1000"}, 1, {"density", "-1000"}}},
      {"E_zero", {{"body.0.material.youngs_modulus=0"}, 1, {"youngs_modulus"}}},
      {"nu_half", {{"body.0.material.poissons_ratio=0.5"}, 1, {"poissons_ratio", "(-1, 0.5)"}}},
      {"nu_below_minus_one", {{"body.0.material.poissons_ratio=-1.2"}, 1, {"poissons_ratio", "-1.2"}}},
      {"nu_auxetic",
       {{"body.0.material.poissons_ratio=-0.4", "body.0.material.law=stable_neo_hookean"}, 0, {}}},
      {"nu_zero", {{"body.0.material.poissons_ratio=0", "body.0.material.law=stable_neo_hookean"}, 0, {}}},
      {"no_supports_static", {{"fix=[]"}, 1, {"not constrained", "6 of 6 rigid-body motions"}}},
      {"conflicting_dirichlet",
       {{"fix=[{where={group=\"x_min\"}},{where={group=\"z_min\"},displacement=[0,0,1]}]"},
        1,
        {"vertex 0", "fix[0]", "fix[1]"}}},
      {"dirichlet_unknown_group", {{"fix.0.where={group=\"lefft\"}"}, 1, {"lefft", "x_min", "x_max"}}},
      {"unknown_key",
       {{"body.0.material.youngs_modulos=1"}, 1, {"youngs_modulos", "did you mean \"youngs_modulus\"?"}}},
      {"unknown_material",
       {{"body.0.material.law=rubber_x"}, 1, {"rubber_x", "neo_hookean", "linear_elastic"}}},
      {"dt_zero", {{"simulation.kind=dynamic", "simulation.time_step=0.0"}, 1, {"time_step", "> 0"}}},
      {"gravity_two_components", {{"simulation.gravity=[0,-9.81]"}, 1, {"gravity", "dimension"}}},
      {"friction_negative", {{"contact.friction=-0.1"}, 1, {"contact.friction", "-0.1"}}},
      {"initial_interpenetration",
       {{"body=[{name=\"a\",mesh={box={size=[1,1,1],cells=[1,1,1]}}},"
         "{name=\"b\",mesh={box={size=[1,1,1],cells=[1,1,1]}},translate=[0.5,0,0]}]",
         "fix=[{body=\"a\",where={group=\"x_min\"}}]", "load=[]", "probe=[]"},
        1,
        {"contact: expected bodies that start apart", "of \"a\" and cell", "move \"b\" by (0.5"}}},
      {"output_dir_missing", {{}, 0, {}}},
      {"mesh_missing", {{"body.0.mesh=nowhere/bar.msh"}, 1, {"nowhere/bar.msh", "no such file"}}},
      {"locale_de", {{}, 0, {}}},
      {"no_convergence", {{"simulation.gravity=[0,0,-1e12]"}, 2, {"load factor"}}},
  };
  return table;
}

std::vector<std::string> arguments_of(const Configuration& configuration, const std::string& command) {
  std::vector<std::string> arguments = {command, "box.toml"};
  for (const std::string& setting : configuration.settings) {
    arguments.emplace_back("--set");
    arguments.push_back(setting);
  }
  return arguments;
}

struct BadConfigurations : ::testing::Test {
  TemporaryFolder folder;
  BadConfigurations() { folder.write("box.toml", box_scene); }
};

TEST_F(BadConfigurations, EachGetsTheAnswerThatTheIndexAsksFor) {
  const nlohmann::json index = read_json(source_folder() / "tests/data/bad_inputs/index.json");
  ASSERT_FALSE(index["configurations"].empty());
  for (const nlohmann::json& entry : index["configurations"]) {
    const std::string id = entry["id"];
    SCOPED_TRACE(id + ": " + entry["expected"].get<std::string>());
    const auto found = configurations().find(id);
    if (found == configurations().end()) {
      ADD_FAILURE() << "the index has an entry that this test does not know";
      continue;
    }
    const ProgramResult result = run_program(folder.path(), arguments_of(found->second, "run"));
    EXPECT_EQ(result.exit_code, found->second.exit_code) << result.err;
    for (const std::string& part : found->second.named) EXPECT_THAT(result.err, HasSubstr(part));
    if (result.exit_code == 0) continue;
    // One line that is no warning.
    const std::string lines = "\n" + result.err;
    std::size_t errors = 0;
    for (std::size_t at = 0; at + 1 < lines.size(); at = lines.find('\n', at + 1))
      if (lines.compare(at, 9, "\nwarning:") != 0) ++errors;
    EXPECT_EQ(errors, 1U) << result.err;
    if (result.exit_code == 1) {
      const ProgramResult check = run_program(folder.path(), arguments_of(found->second, "check"));
      EXPECT_EQ(check.exit_code, 1);
      EXPECT_EQ(check.err, result.err);
    }
  }
}

TEST_F(BadConfigurations, NoDensityIsFineInStaticsWithoutGravity) {
  EXPECT_EQ(run_program(folder.path(), {"run", "box.toml", "--set", "simulation.gravity=[0,0,0]", "--set",
                                        "body.0.material.density=0", "--set",
                                        "load=[{kind=\"traction\",where={group=\"x_max\"},value=[10,0,0]}]"})
                .exit_code,
            0);
}

TEST_F(BadConfigurations, AFolderForResultsIsMadeOrNamedWhenItCannotBe) {
  EXPECT_EQ(run_program(folder.path(), {"run", "box.toml", "--out", "some/new/folder"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "some/new/folder/report.json"));
  const ProgramResult blocked = run_program(folder.path(), {"run", "box.toml", "--out", "box.toml/inside"});
  EXPECT_EQ(blocked.exit_code, 1);
  EXPECT_THAT(blocked.err, HasSubstr("box.toml/inside"));
}

TEST_F(BadConfigurations, ALostEquilibriumKeepsWhatWasReached) {
  const ProgramResult result = run_program(
      folder.path(),
      {"run", "box.toml", "--set", "simulation.gravity=[0,0,-1e7]", "--set", "newton.max_iterations=3"});
  const nlohmann::json report = read_json(folder.path() / "out/box/report.json");
  if (result.exit_code == 2) {
    EXPECT_EQ(report["status"], "not_converged");
    EXPECT_THAT(report["reason"].get<std::string>(), HasSubstr("load factor"));
  } else {
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(report["status"], "done");
  }
  EXPECT_FALSE(report["frames"].empty());
}

/// A German locale made here, for most machines have none. Empty when this machine cannot make one.
std::vector<std::string> german_environment(const std::filesystem::path& folder) {
  const std::string made = (folder / "de_DE.UTF-8").string();
  const std::string command = "localedef -i de_DE -f UTF-8 '" + made + "' > /dev/null 2>&1";
  if (std::system(command.c_str()) != 0 || !std::filesystem::exists(made)) return {};
  return {"LOCPATH=" + folder.string(), "LC_ALL=de_DE.UTF-8"};
}

TEST_F(BadConfigurations, AGermanLocaleGivesTheSameNumbers) {
  const std::vector<std::string> german = german_environment(folder.path());
  if (german.empty()) GTEST_SKIP() << "localedef cannot make a German locale here";
  ASSERT_EQ(run_program(folder.path(), {"run", "box.toml", "--out", "c"}, {"LC_ALL=C"}).exit_code, 0);
  ASSERT_EQ(run_program(folder.path(), {"run", "box.toml", "--out", "de"}, german).exit_code, 0);
  EXPECT_EQ(read_json(folder.path() / "c/report.json")["frames"],
            read_json(folder.path() / "de/report.json")["frames"]);
  EXPECT_EQ(read_text_file(folder.path() / "c/frames.pvd"), read_text_file(folder.path() / "de/frames.pvd"));
}

}  // namespace
}  // namespace resilin::testing
