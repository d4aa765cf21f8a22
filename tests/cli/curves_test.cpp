// `resilin materials LAW --curve ...`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Curves : ::testing::Test {
  TemporaryFolder folder;
  ProgramResult run(const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"materials"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return run_program(folder.path(), all);
  }
  nlohmann::json run_json(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    return nlohmann::json::parse(run(arguments).out);
  }
};

/// Small-strain elasticity has P11 = E (l - 1) with free sides.
TEST_F(Curves, TellStressesAtTheStretchesAskedFor) {
  const nlohmann::json curve = run_json({"linear_elastic", "--curve", "uniaxial", "--from", "0.75", "--to",
                                         "1.25", "--points", "3", "--youngs-modulus", "2e5"});
  ASSERT_EQ(curve["points"].size(), 3u);
  const double stresses[] = {-5e4, 0, 5e4};
  for (std::size_t i = 0; i < 3; ++i) {
    const nlohmann::json& point = curve["points"][i];
    EXPECT_EQ(point["stretch"], 0.75 + 0.25 * static_cast<double>(i));
    EXPECT_NEAR(point["nominal_stress"].get<double>(), stresses[i], 1e-9);
    EXPECT_EQ(point["stability"], "stable");
  }
  EXPECT_EQ(curve["limits"].size(), 0u);
}

TEST_F(Curves, TakeTheConstantsOfTheLaw) {
  const nlohmann::json curve = run_json({"stable_neo_hookean", "--curve", "shear", "--points", "4", "--set",
                                         "shear_modulus=1e5", "--set", "lame_lambda=3e5"});
  EXPECT_EQ(curve["constants"]["lame_lambda"], 3e5);
  EXPECT_NEAR(curve["points"][3]["nominal_stress"].get<double>(), 1.5e5, 1e-9);  // mu times the shear
}

TEST_F(Curves, AreTablesAndCsvFiles) {
  const ProgramResult result =
      run({"neo_hookean", "--curve", "planar", "--points", "5", "--csv", "curve.csv"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, HasSubstr("nominal stress [Pa]"));
  const std::string csv = read_text_file(folder.path() / "curve.csv");
  EXPECT_THAT(csv, StartsWith("stretch,nominal_stress [Pa],cauchy_stress [Pa],volume_ratio,"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 6);
  EXPECT_THAT(csv, HasSubstr("\n0.5,-"));
}

TEST_F(Curves, WarnInOneLineWhereStabilityIsLost) {
  const ProgramResult result =
      run({"saint_venant_kirchhoff", "--curve", "uniaxial", "--from", "0.4", "--to", "2.2", "--points", "7"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  EXPECT_THAT(result.err, StartsWith("warning: saint_venant_kirchhoff, uniaxial: the nominal stress drops "
                                     "below stretch 0.57735 "));
  EXPECT_THAT(result.err, HasSubstr("no state beyond stretch 2.08167"));
  EXPECT_THAT(result.out, HasSubstr("unstable: stress_drops"));
  EXPECT_THAT(result.out, HasSubstr("2.2      no state\n"));
  const nlohmann::json json = run_json({"saint_venant_kirchhoff", "--curve", "uniaxial", "--to", "2.2"});
  EXPECT_TRUE(json["points"].back()["nominal_stress"].is_null());
  EXPECT_EQ(json["limits"].back()["loss"], "no_state");
}

TEST_F(Curves, ThatCannotBeAreRefusedInOneLine) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"--curve", "uniaxial"},
           {"--set", "shear_modulus=1"},
           {"neo_hookean", "--from", "0.5"},
           {"neo_hookean", "--csv", "curve.csv"},
           {"neo_hookean", "--curve", "uniaxal"},
           {"neo_hookean", "--curve", "uniaxial", "--from", "0"},
           {"neo_hookean", "--curve", "uniaxial", "--from", "nan"},
           {"neo_hookean", "--curve", "uniaxial", "--to", "0.1"},
           {"neo_hookean", "--curve", "uniaxial", "--points", "1"},
           {"neo_hookean", "--curve", "uniaxial", "--csv", "no_such_folder/curve.csv"},
           {"neo_hookean", "--set", "shear_modulus"},
           {"neo_hookean", "--set", "shear_modulus=stiff"},
           {"neo_hookean", "--set", "shear_modulus=1e5"},
           {"neo_hookean", "--set", "shear_modulus=-1", "--set", "lame_lambda=1"},
           {"neo_hookean", "--fibre", "1", "0", "0"},
           {"neo_hookean", "--fibre", "1", "0"},
           {"neo_hookean", "--poissons-ratio", "0.5"}}) {
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 1) << ::testing::PrintToString(arguments);
    EXPECT_THAT(result.err, StartsWith("resilin: "));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
  }
  EXPECT_THAT(run({"neo_hookean", "--curve", "uniaxal"}).err, HasSubstr("did you mean \"uniaxial\"?"));
}

}  // namespace
}  // namespace resilin::testing
