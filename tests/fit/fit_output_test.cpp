#include "resilin/fit/fit_output.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "resilin/core/text.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/scene/scene.hpp"
#include "resilin/simulation/simulation.hpp"
#include "shared_data.hpp"
#include "temporary_folder.hpp"

namespace resilin {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const FitReport& report_of_example() {
  static const FitReport report =
      fit_materials(read_fit(testing::source_folder() / "examples" / "fit_rubber.toml"));
  return report;
}

TEST(FitOutput, RanksTheLawsOfTheExample) {
  const FitReport& report = report_of_example();
  EXPECT_EQ(report.laws.front().name, "ogden3");  // the law of the data
  const std::string text = fit_text(report);
  EXPECT_THAT(
      text,
      HasSubstr("absolute residuals, P_model - P_measured; every point weighs the same; incompressible"));
  for (const LawFit& fit : report.laws) EXPECT_THAT(text, HasSubstr("\n" + fit.name + ": Psi = "));
}

TEST(FitOutput, IsJsonWithoutNumbersThatAreNone) {
  const nlohmann::json json = nlohmann::json::parse(fit_json_text(report_of_example()));
  ASSERT_EQ(json["laws"].size(), report_of_example().laws.size());
  const LawFit& best = report_of_example().laws.front();
  EXPECT_EQ(json["laws"][0]["constants"][0]["value"].get<double>(), best.constants[0].value);
  EXPECT_TRUE(json["laws"][0]["bulk_modulus"].is_null());  // infinite in the incompressible limit
}

TEST(FitOutput, IsOnePageWithoutANetwork) {
  const std::string page = fit_page(report_of_example());
  EXPECT_THAT(page, Not(HasSubstr("{{")));
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
  std::size_t circles = 0;
  for (std::size_t at = page.find("<circle"); at != std::string::npos; at = page.find("<circle", at + 1))
    ++circles;
  std::size_t points = 0;
  for (const MaterialTest& test : report_of_example().description.tests) points += test.num_points();
  EXPECT_EQ(circles, points);
}

// Mooney and Rivlin with c01 < 0 loses stability: dashed there.
TEST(FitOutput, DashesUnstableCurves) {
  FitDescription description;
  MaterialTest test;
  test.mode = TestMode::uniaxial;
  test.name = "<uniaxial> & \"more\"";
  test.place = "test";
  test.has_unit = true;
  for (const double l : {1.2, 1.5, 2.0, 3.0, 5.0, 7.0}) {
    test.load.push_back(l);
    test.stress.push_back(2e5 * (l - 1 / (l * l)) * (1 + 0.01 * l * l));
  }
  description.tests = {test};
  description.laws = {"mooney_rivlin"};
  description.stability = StabilityRule::report;
  const FitReport report = fit_materials(description);
  const std::string page = fit_page(report);
  EXPECT_THAT(page, HasSubstr("law-0 unstable"));
  EXPECT_THAT(page, HasSubstr("&lt;uniaxial&gt; &amp; &quot;more&quot;"));
  description.stability = StabilityRule::required;
  description.laws = {"yeoh"};
  EXPECT_THAT(fit_page(fit_materials(description)), Not(HasSubstr("law-0 unstable")));
}

// Each law's line is taken by a scene, which then answers with the fitted Young's modulus.
TEST(FitOutput, IsAMaterialThatScenesTake) {
  for (const LawFit& fit : report_of_example().laws) {
    FitReport one = report_of_example();
    one.laws = {fit};
    const std::string text =
        "[[body]]\nname = \"bar\"\nmesh = { box = { size = [1, 1, 1], cells = [1, 1, 1] } }\nelement = "
        "\"P2\"\n" +
        material_toml(one) +
        "[[fix]]\nname = \"left\"\nbody = \"bar\"\nwhere = { plane = { axis = \"x\", at = 0 } }\ncomponents "
        "= \"x\"\n"
        "[[fix]]\nname = \"right\"\nbody = \"bar\"\nwhere = { plane = { axis = \"x\", at = 1 } }\ncomponents "
        "= "
        "\"x\"\ndisplacement = [1e-4, 0, 0]\n"
        "[[fix]]\nname = \"y\"\nbody = \"bar\"\nwhere = { plane = { axis = \"y\", at = 0 } }\ncomponents = "
        "\"y\"\n"
        "[[fix]]\nname = \"z\"\nbody = \"bar\"\nwhere = { plane = { axis = \"z\", at = 0 } }\ncomponents = "
        "\"z\"\n";
    Simulation simulation(World(read_scene_from_text(text, "bar.toml", ".").description));
    while (!simulation.is_finished())
      ASSERT_EQ(simulation.step().status, StepReport::Status::converged) << fit.name;
    double force = 0;
    for (const auto& [name, reaction] : simulation.frame().reactions)
      if (name == "right") force = reaction.x();
    // 3 mu in the limit, 2 mu (1 + nu) with nu = 0.495; and the strain of 1e-4 is not infinitely small.
    EXPECT_NEAR(force / 1e-4, fit.youngs_modulus * (2 * 1.495 / 3), 1e-3 * fit.youngs_modulus) << fit.name;
  }
}

TEST(FitOutput, HasEveryKeyOnThePageOfItsFile) {
  EXPECT_EQ(read_file(testing::source_folder() / "docs" / "fit_keys.md"), fit_reference())
      << "run: resilin fit --reference > docs/fit_keys.md";
}

TEST(FitOutput, IsWrittenIntoAFolder) {
  const testing::TemporaryFolder folder;
  write_fit(report_of_example(), folder.path() / "a" / "b");
  for (const char* name : {"fit.json", "fit.html", "material.toml"})
    EXPECT_FALSE(read_file(folder.path() / "a" / "b" / name).empty());
}

TEST(FitOutput, ShowsSoManyDigitsAsAreKnown) {
  EXPECT_EQ(value_text(0.123456789, 0.01), "0.12346");
  EXPECT_EQ(value_text(0.123456789, 1e-7), "0.123456789");
  EXPECT_EQ(value_text(0, 0.1), "0");
}

// A free optimum that is no solid is told, and commented out.
TEST(FitOutput, LeavesOutWhatNoSceneTakes) {
  FitDescription description;
  MaterialTest test;
  test.place = test.name = "pulled";
  test.has_unit = true;
  for (const double l : {1.5, 2.0, 4.0, 6.0}) {
    test.load.push_back(l);
    test.stress.push_back(2e5 * (l - 1 / (l * l)) * (0.4 - 1 / l));
  }
  description.tests = {test};
  description.laws = {"mooney_rivlin", "neo_hookean"};
  description.stability = StabilityRule::report;
  const FitReport report = fit_materials(description);
  EXPECT_FALSE(report.laws[0].is_usable && report.laws[1].is_usable);
  const std::string text = material_toml(report);
  EXPECT_THAT(text, HasSubstr("# material = { law = \"mooney_rivlin\""));
  EXPECT_THAT(text, HasSubstr("\nmaterial = { law = \"neo_hookean\""));
  EXPECT_THAT(fit_page(report), HasSubstr("no scene takes these constants"));
}

// The same numbers, whatever was fitted before and after.
TEST(FitOutput, IsTheSameEachTime) {
  const FitReport again = fit_materials(read_fit(testing::source_folder() / "examples" / "fit_rubber.toml"));
  EXPECT_EQ(fit_json_text(again), fit_json_text(report_of_example()));
}

}  // namespace
}  // namespace resilin
