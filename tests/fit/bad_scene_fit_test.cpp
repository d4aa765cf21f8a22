// One line for each mistake in a fit of scenes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "resilin/core/error.hpp"
#include "scene_fit_files.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class BadSceneFit : public SceneFitFiles {
 protected:
  BadSceneFit() {
    folder.write("young.csv", moduli_csv(6e5, 4e5));
    folder.write("scene.toml", sagging_strip);
    folder.write("good.csv", "X,Y,ux,uy\n0.5,0.1,0,-0.1\n1,0.1,0,-0.3\n");
  }
  std::string with(const std::string& csv, const std::string& parameter = modulus) {
    folder.write("markers.csv", csv);
    return error_of("[[experiment]]\nscene = \"scene.toml\"\nmarkers = { file = \"markers.csv\" }\n" +
                    parameter);
  }
  std::string of_parameter(const std::string& parameter) {
    return with("X,Y,ux,uy\n0.5,0.1,0,-0.1\n1,0.1,0,-0.3\n", parameter);
  }
  static const std::string modulus;
};
const std::string BadSceneFit::modulus = "[[parameter]]\nkey = \"body.bar.material.youngs_modulus\"\n";

TEST_F(BadSceneFit, IsFoundInMarkers) {
  EXPECT_EQ(of_parameter(modulus), "no error");
  EXPECT_THAT(with("X,Y,ux,uy\n0.5,0.1,0,0\n1.25,0.1,0,0\n"),
              AllOf(HasSubstr("row 2"), HasSubstr("inside bar"), HasSubstr("0.25 m outside")));
  EXPECT_THAT(with("X,ux,uy\n0.5,0,0\n"), HasSubstr("a column Y"));
  EXPECT_THAT(with("X,Y\n0.5,0\n"), HasSubstr("what was measured"));
  EXPECT_THAT(with("X,Y,ux,vy\n0.5,0,0,0\n"), HasSubstr("\"vy\""));
  EXPECT_THAT(with("X,Y,ux,uy\n0.5,0.1,nan,0\n"), AllOf(HasSubstr("markers.csv:2"), HasSubstr("leave rows")));
  EXPECT_THAT(with("0.5,0.1,0,0\n"), HasSubstr("names the columns"));
  EXPECT_THAT(with("X,Y,ux,uy,sigma\n0.5,0.1,0,0,0\n"), HasSubstr("a sigma above 0"));
  EXPECT_THAT(with("time,X,Y,ux,uy\n1,0.5,0.1,0,0\n"), HasSubstr("the scene is static"));
  EXPECT_THAT(with("load,X,Y,ux,uy\n0.3,0.5,0.1,0,0\n"),
              AllOf(HasSubstr("load 0.3"), HasSubstr("simulation.load_steps")));
  EXPECT_THAT(with("X,Y,ux\n0.5,0.1,0\n"), AllOf(HasSubstr("at least 2"), HasSubstr("got 1")));
}

TEST_F(BadSceneFit, IsFoundInParameters) {
  EXPECT_THAT(of_parameter("[[parameter]]\nkey = \"body.bar.material.young_modulus\"\n"),
              HasSubstr("did you mean \"body.bar.material.youngs_modulus\""));
  EXPECT_THAT(of_parameter("[[parameter]]\nkey = \"simulation.gravity\"\n"),
              HasSubstr("simulation.gravity.y"));
  EXPECT_THAT(of_parameter("[[parameter]]\nkey = \"body.bar.rest_positions\"\n"), HasSubstr("fields"));
  EXPECT_THAT(of_parameter(modulus + "start = [1e5]\n"), "no error");
  EXPECT_THAT(of_parameter(modulus + "start = [1e5, 2e5, 3e5]\n"), HasSubstr("2, one for each"));
  EXPECT_THAT(of_parameter(modulus + "start = -1\n"), HasSubstr("start"));
  EXPECT_THAT(of_parameter(modulus + "bounds = [1e5, 2e5]\n"), HasSubstr("a start from 1e+05 to 2e+05"));
  EXPECT_THAT(of_parameter(modulus + "bounds = [-1, 2e6]\n"), HasSubstr("bounds"));
  EXPECT_THAT(of_parameter(modulus + modulus), HasSubstr("twice"));
  EXPECT_THAT(of_parameter(modulus + "experiment = \"scne\"\n"), HasSubstr("did you mean \"scene\""));
  EXPECT_THAT(of_parameter(""), HasSubstr("[[parameter]]"));
}

TEST_F(BadSceneFit, IsFoundInExperiments) {
  const auto with_table = [&](const std::string& table) {
    return error_of("[[experiment]]\nscene = \"scene.toml\"\n" + table + "\n" + modulus);
  };
  EXPECT_THAT(with_table(""), HasSubstr("there are no measurements"));
  EXPECT_THAT(with_table("reaction = { of = \"wal\", value = [1, 2] }"), HasSubstr("did you mean \"wall\""));
  EXPECT_THAT(with_table("reaction = { of = \"wall\" }"), HasSubstr("a file or a value"));
  EXPECT_THAT(with_table("probe = { of = \"tipp\", value = [1, 2] }"), HasSubstr("did you mean \"tip\""));
  EXPECT_THAT(with_table("markers = { file = \"good.csv\" }\nreaction = { of = \"wall\", value = [1, 2] }"),
              HasSubstr("weighed"));
  EXPECT_THAT(
      with_table(
          "markers = { file = \"good.csv\", sigma = 1 }\nreaction = { of = \"wall\", value = [1, 2] }"),
      HasSubstr("as other measurements have one"));
  EXPECT_THAT(error_of("[[experiment]]\nscene = \"none.toml\"\n"), HasSubstr("none.toml"));
  EXPECT_THAT(error_of("[[experiment]]\nscene = \"scene.toml\"\n[[test]]\nmode = \"planar\"\n"),
              HasSubstr("both"));
  EXPECT_THAT(
      error_of("[[experiment]]\nscene = \"scene.toml\"\nmarkers = { file = \"good.csv\" }\n[fit]\nlaws = "
               "\"all\"\n" +
               modulus),
      HasSubstr("laws"));
  EXPECT_THAT(error_of(sagging_strip), HasSubstr("this is a scene"));
}

TEST(AFileOfAFit, IsRefusedAsAScene) {
  const TemporaryFolder folder;
  try {
    read_scene(folder.write("a.toml", "[[test]]\nmode = \"planar\"\n"));
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("this is a fit file"), HasSubstr("resilin fit")));
  }
}

}  // namespace
}  // namespace resilin::testing
