// Ties and linear constraints, from the scene file to the report.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

/// Two blocks, one on the other, whose meshes do not match, stretched by their outer faces.
const std::string blocks = R"(
[[body]]
name = "lower"
mesh = { box = { size = [1, 1, 0.5], cells = [2, 3, 2] } }
element = "P1"
material = { law = "neo_hookean", youngs_modulus = 1, poissons_ratio = 0.3 }

[[body]]
name = "upper"
mesh = { box = { size = [1, 1, 0.5], cells = [4, 3, 2] } }
element = "P1"
translate = [0, 0, 0.5]
material = { law = "neo_hookean", youngs_modulus = 1, poissons_ratio = 0.3 }

[[fix]]
name = "foot"
body = "lower"
where = { group = "z_min" }
components = "z"

[[fix]]
name = "side of the lower"
body = "lower"
where = { group = "x_min" }
components = "x"

[[fix]]
name = "back of the lower"
body = "lower"
where = { group = "y_min" }
components = "y"

[[fix]]
name = "pull"
body = "upper"
where = { group = "z_max" }
components = "z"
displacement = [0, 0, 0.2]

[[tie]]
name = "glue"
surfaces = [{ body = "upper", where = { group = "z_min" } }, { body = "lower", where = { group = "z_max" } }]

[newton]
tolerance = 1e-12

[[probe]]
name = "middle"
body = "upper"
at = [0.5, 0.3333333333333333, 0.5]

[[probe]]
name = "far"
body = "upper"
at = [1, 1, 0.75]
)";

struct Ties : ::testing::Test {
  TemporaryFolder folder;
  Ties() { folder.write("blocks.toml", blocks); }

  nlohmann::json last_frame(const std::vector<std::string>& settings) const {
    std::vector<std::string> arguments = {"run", "blocks.toml", "--quiet", "--set", "output.formats=[]"};
    for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
    const ProgramResult result = run_program(folder.path(), arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_json(folder / "out/blocks/report.json")["frames"].back();
  }
  std::string error_with(const std::string& setting) const {
    const ProgramResult result = run_program(folder.path(), {"check", "blocks.toml", "--set", setting});
    EXPECT_EQ(result.exit_code, 1) << setting;
    return result.err;
  }
};

TEST_F(Ties, PassHomogeneousTensionOn) {
  for (const std::string element : {"P1", "P2"}) {
    SCOPED_TRACE(element);
    const nlohmann::json frame = last_frame({"body.0.element=" + element, "body.1.element=" + element});
    const auto middle = frame["probes"]["middle"]["displacement"],
               far = frame["probes"]["far"]["displacement"];
    EXPECT_NEAR(double(middle[2]), 0.1, 1e-10);
    EXPECT_NEAR(double(far[2]), 0.15, 1e-10);
    EXPECT_NEAR(double(middle[0]), 0.5 * double(far[0]), 1e-10);
    EXPECT_NEAR(double(far[0]), double(far[1]), 1e-10);
    const double pull = frame["reactions"]["pull"][2];
    EXPECT_GT(pull, 0.15);
    EXPECT_NEAR(double(frame["reactions"]["glue"][2]), -pull, 1e-10);
    EXPECT_NEAR(double(frame["reactions"]["foot"][2]), -pull, 1e-10);
  }
}

TEST_F(Ties, HoldBlocksTogetherThatFallFreely) {
  for (const std::string integrator : {"backward_euler", "bdf2", "tr_bdf2", "newmark", "midpoint"}) {
    SCOPED_TRACE(integrator);
    const nlohmann::json frame =
        last_frame({"simulation.kind=dynamic", "simulation.integrator=" + integrator,
                    "simulation.time_step=0.1", "simulation.gravity=[0,0,-10]",
                    "body.lower.material.density=1", "body.upper.material.density=1", "fix.pull.components=x",
                    "fix.pull.displacement=[0,0,0]", "fix.foot.components=y", "simulation.end_time=0.5"});
    EXPECT_NEAR(double(frame["momentum"]["linear"][2]), -5, 1e-9);
    EXPECT_NEAR(double(frame["probes"]["middle"]["velocity"][2]), -5, 1e-9);
    EXPECT_NEAR(double(frame["reactions"]["glue"][2]), 0, 1e-7);
  }
}

TEST_F(Ties, RefuseWhatTheyCannotDo) {
  EXPECT_THAT(error_with("body.upper.translate=[0,0,2]"), HasSubstr("m apart, got 1.5 m near"));
  EXPECT_THAT(error_with("body.upper.translate=[0.5,0,0.5]"), HasSubstr("face nothing within"));
  EXPECT_THAT(error_with(R"(tie.0.surfaces=[{body="upper"}, {body="upper"}])"), HasSubstr("another body"));
  EXPECT_THAT(error_with(R"(tie.0.surfaces=[{body="upper"}, {body="uper"}])"),
              HasSubstr("one of lower, upper"));
}

}  // namespace
}  // namespace resilin::testing
