// One line for each mistake: where, what was expected, what came, what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "resilin/core/error.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/fit/fit_report.hpp"
#include "temporary_folder.hpp"

namespace resilin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class BadFitInput : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    std::ofstream file(folder.path() / name);
    file << text;
  }
  FitReport fit(const std::string& text) {
    write("data.toml", text);
    return fit_materials(read_fit(folder.path() / "data.toml"));
  }
  /// The message; it is one line.
  std::string error_of(const std::string& text) {
    try {
      fit(text);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "no error";
  }
  std::string error_of_csv(const std::string& csv, const std::string& more = "unit = \"MPa\"") {
    write("a.csv", csv);
    return error_of("[[test]]\nmode = \"uniaxial\"\nfile = \"a.csv\"\n" + more);
  }

  testing::TemporaryFolder folder;
};

const std::string good_test =
    "[[test]]\nmode = \"uniaxial\"\nunit = \"MPa\"\nstretch = [1.2, 1.5, 2, 3]\nnominal_stress = [0.2, 0.4, "
    "0.7, 1.1]\n";

TEST_F(BadFitInput, IsNoneInAGoodFile) {
  EXPECT_EQ(error_of(good_test + "[fit]\nlaws = [\"neo_hookean\"]"), "no error");
}

TEST_F(BadFitInput, NamesTheNearestOfWhatItDoesNotKnow) {
  EXPECT_THAT(error_of("[[tests]]"), HasSubstr("did you mean \"test\""));
  EXPECT_THAT(error_of(good_test + "[fit]\nlaws = [\"neo_hokean\"]"),
              HasSubstr("did you mean \"neo_hookean\""));
  EXPECT_THAT(error_of(good_test + "[fit]\nlaws = [\"ogden4\"]"), HasSubstr("ogden3"));
  EXPECT_THAT(error_of("[[test]]\nmode = \"uniaxal\""), HasSubstr("did you mean \"uniaxial\""));
  EXPECT_THAT(error_of("[[test]]\nmode = \"uniaxial\"\nunit = \"MPA\""), HasSubstr("did you mean \"MPa\""));
  EXPECT_THAT(error_of(good_test + "[fit]\nlaws = [\"gent\"]\nparameters = { limt = { value = 80 } }"),
              HasSubstr("did you mean \"limit\""));
  EXPECT_THAT(error_of(good_test + "[fit]\nresiduals = \"absolute\""),
              HasSubstr("did you mean \"residual\""));
}

TEST_F(BadFitInput, WantsATestAndItsMode) {
  EXPECT_THAT(error_of("title = \"a\""), HasSubstr("no [[test]]"));
  EXPECT_THAT(error_of("[[test]]\nfile = \"a.csv\""), HasSubstr("\"mode\" is missing"));
  EXPECT_THAT(error_of("[[test]]\nmode = \"planar\""), HasSubstr("add file"));
  EXPECT_THAT(error_of("[[test]]\nmode = \"planar\"\nfile = \"none.csv\""), HasSubstr("no such file"));
}

TEST_F(BadFitInput, IsFoundInColumns) {
  EXPECT_THAT(error_of_csv("strech,nominal_stress\n1.1,0.2\n"),
              HasSubstr("did you mean \"stretch\" by \"strech\""));
  EXPECT_THAT(error_of_csv("u,P\n1.1,0.2\n"), HasSubstr("columns = { stretch = \"u\" }"));
  EXPECT_THAT(error_of_csv("stretch\n1.1\n"), HasSubstr("nominal_stress or force"));
  EXPECT_THAT(error_of_csv("stretch,strain,stress\n1.1,0.1,0.2\n"), HasSubstr("both"));
  EXPECT_THAT(error_of_csv("displacement,force\n1.1,2\n"), HasSubstr("\"length\""));
  EXPECT_THAT(error_of_csv("displacement,force\n1.1,2\n", "length = 10\nlength_unit = \"mm\""),
              HasSubstr("\"area\""));
  EXPECT_THAT(error_of_csv("a,b\n1.1,2\n", "columns = { stretch = \"aa\", nominal_stress = \"b\" }"),
              HasSubstr("did you mean \"a\""));
  EXPECT_THAT(error_of_csv("stretch,stress [psi]\n1.1,2\n"), HasSubstr("psi"));
}

TEST_F(BadFitInput, IsFoundInNumbers) {
  EXPECT_THAT(error_of_csv("stretch,stress\n0,0\n1.1,2\n"),
              AllOf(HasSubstr("row 1"), HasSubstr("engineering strain")));
  EXPECT_THAT(error_of_csv("strain,stress\n-1.5,2\n"), HasSubstr("a stretch above 0"));
  EXPECT_THAT(error_of_csv("stretch,stress\n1.1,nan\n"),
              AllOf(HasSubstr("a.csv:2"), HasSubstr("leave rows without")));
  EXPECT_THAT(error_of_csv("stretch,stress\n1.1,inf\n"), HasSubstr("a.csv:2"));
  EXPECT_THAT(error_of_csv("stretch,stress\n1.1,\n"), HasSubstr("leave rows without"));
  EXPECT_THAT(error_of_csv("stretch,stress\n1,1\n"), HasSubstr("points at nonzero strain"));
  EXPECT_THAT(error_of_csv(""), HasSubstr("rows of numbers"));
  EXPECT_THAT(error_of_csv("stretch,stress\n"), HasSubstr("rows of numbers"));
  EXPECT_THAT(error_of_csv("stretch,stress\n1.1,0\n1.2,0\n"), HasSubstr("stresses other than 0"));
  EXPECT_THAT(error_of("[[test]]\nmode = \"uniaxial\"\nstretch = [1.1, 1.2]\nnominal_stress = [1]"),
              HasSubstr("as many as there are loads"));
  EXPECT_THAT(error_of("[[test]]\nmode = \"uniaxial\"\nstretch = [1.1, nan]\nnominal_stress = [1, 2]"),
              HasSubstr("a number"));
}

TEST_F(BadFitInput, SuggestsTheFactorOfWrongUnits) {
  const std::string rubber = "stretch,stress\n1.24,2.3\n1.9,5.1\n3.02,8.8\n4.03,12.5\n";
  EXPECT_THAT(error_of_csv(rubber, ""), HasSubstr("kgf/cm2 read as Pa, a factor of 98066.5"));
  EXPECT_EQ(error_of_csv(rubber, "unit = \"kgf/cm2\"\n[fit]\nlaws = [\"neo_hookean\"]"), "no error");
  EXPECT_EQ(error_of_csv(rubber, "unit = \"Pa\"\n[fit]\nlaws = [\"neo_hookean\"]"), "no error");
  EXPECT_THAT(error_of_csv("stretch,stress\n1.24,0.23\n1.9,0.51\n", ""), HasSubstr("MPa read as Pa"));
  // Two tests of one material.
  const FitReport report =
      fit("[[test]]\nmode = \"uniaxial\"\nunit = \"MPa\"\nstretch = [1.2, 2]\nnominal_stress = [0.2, 0.7]\n"
          "[[test]]\nmode = \"planar\"\nunit = \"MPa\"\nstretch = [1.2, 2]\nnominal_stress = [2.4, 8.0]\n"
          "[fit]\nlaws = [\"neo_hookean\"]");
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_THAT(report.warnings.front(), HasSubstr("times less than planar"));
}

TEST_F(BadFitInput, HasTooFewPoints) {
  const std::string two =
      "[[test]]\nmode = \"uniaxial\"\nunit = \"MPa\"\nstretch = [1.2, 2]\nnominal_stress = [0.2, 0.7]\n";
  EXPECT_THAT(error_of(two + "[fit]\nlaws = [\"yeoh\"]"), HasSubstr("at least 3 points"));
  const FitReport report = fit(two);  // the usual laws: those that can be
  EXPECT_EQ(report.not_fitted.size(), 2U);
  EXPECT_EQ(report.laws.size(), 4U);
}

TEST_F(BadFitInput, AsksForWhatResidualsNeed) {
  EXPECT_THAT(error_of(good_test + "[fit]\nresidual = \"sigma\""), HasSubstr("add sigma"));
  EXPECT_THAT(
      error_of("[[test]]\nmode = \"uniaxial\"\nunit = \"MPa\"\nstretch = [1.2, 2]\nnominal_stress = [0, "
               "0.7]\n[fit]\nresidual = \"relative\""),
      HasSubstr("leave the point out"));
}

TEST_F(BadFitInput, IsABoundOutOfTheRange) {
  const auto with = [&](const std::string& setting) {
    return error_of(good_test + "[fit]\nlaws = [\"gent\"]\nparameters = { limit = { " + setting + " } }");
  };
  EXPECT_THAT(with("bounds = [-5, 100]"), HasSubstr("above 0"));
  EXPECT_THAT(with("bounds = [100, 50]"), HasSubstr("the smaller one first"));
  EXPECT_THAT(with("value = -1"), HasSubstr("above 0"));
  EXPECT_THAT(with("start = 0"), HasSubstr("above 0"));
  EXPECT_EQ(with("bounds = [30, 100]"), "no error");
}

TEST_F(BadFitInput, SaysWhyALawCannotBeFitted) {
  const auto with = [&](const std::string& law) {
    return error_of(good_test + "[fit]\nlaws = [\"" + law + "\"]");
  };
  EXPECT_THAT(with("holzapfel_gasser_ogden"), HasSubstr("fibres"));
  EXPECT_THAT(with("linear_elastic"), HasSubstr("small strain"));
  EXPECT_THAT(with("saint_venant_kirchhoff"), HasSubstr("volume = \"compressible\""));
  EXPECT_THAT(
      error_of("[[test]]\nmode = \"confined\"\nunit = \"MPa\"\nstretch = [0.9, 0.8]\nnominal_stress = [-1, "
               "-3]\n[fit]\nvolume = \"incompressible\""),
      HasSubstr("keeps the volume"));
}

TEST_F(BadFitInput, IsToldWhereItIsOdd) {
  const FitReport report =
      fit("[[test]]\nmode = \"uniaxial\"\nunit = \"MPa\"\nstretch = [1, 1.2, 2]\nnominal_stress = "
          "[0.1, 0.3, 0.8]\n[fit]\nlaws = [\"neo_hookean\"]");
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_THAT(report.warnings.front(), HasSubstr("preload"));
}

TEST_F(BadFitInput, ConvertsForcesAndHeadings) {
  write("a.csv", "\"Displacement\";\"Force (N)\"\n5;1\n10;2\n");
  const FitDescription d = [&] {
    write("data.toml",
          "[[test]]\nmode = \"uniaxial\"\nfile = \"a.csv\"\nlength = 10\narea = 4\nlength_unit = \"mm\"");
    return read_fit(folder.path() / "data.toml");
  }();
  EXPECT_DOUBLE_EQ(d.tests[0].load[0], 1.5);
  EXPECT_DOUBLE_EQ(d.tests[0].load[1], 2);
  EXPECT_NEAR(d.tests[0].stress[0], 2.5e5, 1e-9);
  write("b.csv", "strain,Engineering stress [kgf/cm2]\n0.5,2\n");
  write("data.toml", "[[test]]\nmode = \"planar\"\nfile = \"b.csv\"");
  EXPECT_DOUBLE_EQ(read_fit(folder.path() / "data.toml").tests[0].stress[0], 2 * 98066.5);
  write("c.csv", "volume_ratio,pressure [MPa]\n0.9,200\n");
  write("data.toml", "[[test]]\nmode = \"volumetric\"\nfile = \"c.csv\"");
  const MaterialTest volumetric = read_fit(folder.path() / "data.toml").tests[0];
  EXPECT_NEAR(volumetric.load[0], std::cbrt(0.9), 1e-15);
  EXPECT_NEAR(volumetric.stress[0], -2e8 * std::pow(0.9, 2.0 / 3), 1e-6);
}

}  // namespace
}  // namespace resilin
