// Measurable quantities of a scene besides markers; and searches from many starts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "resilin/core/error.hpp"
#include "scene_fit_files.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class SceneMeasures : public SceneFitFiles {};

/// A block in the plane that a round indenter is pressed into.
const std::string pressed_block = R"(
[simulation]
kind = "static"
dimension = 2
load_steps = 2
gravity = [0, -9.81]
[newton]
tolerance = 1e-11
[[body]]
name = "block"
mesh = { box = { kind = "quadrilaterals", size = [0.2, 0.1], cells = [8, 4] } }
material = { law = "neo_hookean", youngs_modulus = 1e5, poissons_ratio = 0.3, density = 1000 }
[[fix]]
name = "table"
where = { plane = { axis = "y", at = 0 } }
[[collider]]
name = "indenter"
kind = "KIND"
displacement = [0.003, -0.02]
activation_distance = 0.004
stiffness = 1e5
[[section]]
name = "cut"
plane = { axis = "x", at = 0.06 }
)";

std::string pressed_by(const std::string& shape) {
  std::string text = pressed_block;
  return text.replace(text.find("kind = \"KIND\""), 13, shape);
}

/// Columns of the Jacobian against differences of what the model gives, forward and transposed: all kinds of
/// numbers that are not linear in places, by a constant, a density and the way of the indenter.
TEST_F(SceneMeasures, HaveSlopesThatAgreeWithDifferences) {
  for (const char* shape : {"kind = \"sphere\"\ncenter = [0.07, 0.154]\nradius = 0.05",
                            "kind = \"half_space\"\npoint = [0, 0.104]\nnormal = [0.1, -1]"}) {
    scene(pressed_by(shape));
    folder.write("forces.csv", "load,fx,fy\n0.5,0,1\n1,0,2\n");
    folder.write("stresses.csv", "X,Y,stress\n0.07,0.08,-1\n0.02,0.03,-1\n");
    std::string text = R"(
[[experiment]]
scene = "scene.toml"
reaction = [{ of = "indenter", file = "forces.csv", sigma = 1 }, { of = "table", value = [0, 1], sigma = 1 }]
section = { of = "cut", value = [0, 1], sigma = 1 }
moment = { of = "cut", value = 1, sigma = 1 }
energy = [{ value = 1, sigma = 1 }, { of = "block", kind = "elastic", value = 1, sigma = 1 }]
volume = { value = 0.02, sigma = 1 }
stress = [{ file = "stresses.csv", component = "von_mises", sigma = 1 }, { file = "stresses.csv", component = "yy", sigma = 1 }]
[[parameter]]
key = "body.block.material.youngs_modulus"
[[parameter]]
key = "body.block.density"
[[parameter]]
key = "collider.indenter.displacement.y"
)";
    const SceneFitDescription description = read_scene_fit(folder.write("fit.toml", text));
    const SceneModel model(description);
    const Eigen::Index num_values = 4 + 2 + 2 + 1 + 2 + 1 + 4;
    ASSERT_EQ(model.data().measured.size(), num_values);
    VectorX p(3);
    for (Eigen::Index i = 0; i < 3; ++i) p[i] = model.unknowns()[static_cast<std::size_t>(i)].start;
    const SceneModel::Solved solved = model.solve(p, {});
    const DenseMatrix J = model.slopes(solved);
    EXPECT_LT(solved.values[3], -1000);  // it presses [N]
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double h = 1e-5 * std::abs(p[i]);
      const VectorX more = model.solve(p + h * VectorX::Unit(3, i), {}).values;
      const VectorX less = model.solve(p - h * VectorX::Unit(3, i), {}).values;
      const VectorX difference = (more - less) / (2 * h);
      for (Eigen::Index k = 0; k < J.rows(); ++k)  // each number by its own size; forces balance to 1e-11
        EXPECT_NEAR(J(k, i), difference[k],
                    1e-4 * std::abs(difference[k]) + 1e-6 * std::abs(solved.values[k] / p[i]))
            << k << " by " << i << " " << shape;
    }
    // By a field the same comes out of transposed products: a change of all cells alike.
    text.replace(text.find("youngs_modulus\"\n"), 16, "youngs_modulus\"\nper = \"cell\"\n");
    const SceneFitDescription by_cells = read_scene_fit(folder.write("cells.toml", text));
    const SceneModel field(by_cells);
    ASSERT_EQ(field.unknowns().size(), 32U + 2);
    VectorX q(34);
    for (Eigen::Index i = 0; i < 34; ++i) q[i] = field.unknowns()[static_cast<std::size_t>(i)].start;
    const DenseMatrix K = field.slopes(field.solve(q, {}));
    const VectorX sum = K.leftCols(32).rowwise().sum();
    EXPECT_LT((sum - J.col(0)).norm(), 1e-6 * J.col(0).norm()) << shape;
    EXPECT_LT((K.rightCols(2) - J.rightCols(2)).norm(), 1e-6 * J.rightCols(2).norm()) << shape;
  }
}

/// The force that an indenter needs tells the modulus, which places of a body pressed by a prescribed way
/// hardly do.
TEST_F(SceneMeasures, FindAModulusFromTheForceOfAnIndenter) {
  const std::string block = pressed_by("kind = \"sphere\"\ncenter = [0.1, 0.154]\nradius = 0.05");
  const Simulation truth = run_to_the_end(scene(block));
  const auto& reactions = truth.frame().reactions;
  ASSERT_EQ(reactions.back().first, "indenter");
  folder.write("force.csv", "fy\n" + format_number(reactions.back().second.y()) + "\n");
  const SceneFitReport report =
      fit("[[experiment]]\nscene = \"scene.toml\"\nreaction = { of = \"indenter\", file = \"force.csv\", "
          "sigma = 0.1 }\n"
          "[[parameter]]\nkey = \"body.block.material.youngs_modulus\"\nstart = 3e4\n");
  EXPECT_TRUE(report.is_converged);
  EXPECT_NEAR(report.parameters[0].value, 1e5, 1e-4 * 1e5);
  EXPECT_EQ(report.tables[0].name, "scene: reaction of indenter");
}

TEST_F(SceneMeasures, AreRefusedInWords) {
  const std::string block = pressed_by("kind = \"sphere\"\ncenter = [0.1, 0.154]\nradius = 0.05");
  scene(block);
  const auto with = [&](const std::string& table) {
    return error_of("[[experiment]]\nscene = \"scene.toml\"\n" + table +
                    "\n[[parameter]]\nkey = \"body.block.material.youngs_modulus\"\n");
  };
  EXPECT_THAT(with("reaction = { of = \"indentor\", value = [0, 1] }"),
              HasSubstr("did you mean \"indenter\""));
  EXPECT_THAT(with("section = { of = \"cot\", value = [0, 1] }"), HasSubstr("did you mean \"cut\""));
  EXPECT_THAT(with("energy = { kind = \"elstic\", value = 1 }"), HasSubstr("did you mean \"elastic\""));
  EXPECT_THAT(with("energy = { kind = \"kinetic\", value = 1 }"), HasSubstr("a static one"));
  EXPECT_THAT(with("volume = { of = \"blok\", value = 1 }"), HasSubstr("did you mean \"block\""));
  EXPECT_THAT(with("volume = { value = 1 }\nenergy = { value = 1 }"), HasSubstr("J, m^3 are weighed"));
  folder.write("stress.csv", "X,Y,stress\n0.5,0.08,-1\n");
  EXPECT_THAT(with("stress = { file = \"stress.csv\", component = \"xx\" }"), HasSubstr("0.3 m outside"));
  EXPECT_THAT(with("stress = { file = \"stress.csv\" }"), HasSubstr("component"));
  EXPECT_THAT(with("moment = { of = \"cut\", value = [0, 1] }"), HasSubstr("number"));
  std::string rubbing = block;
  rubbing.insert(rubbing.find("activation_distance"), "friction = 0.3\n");
  scene(rubbing);
  EXPECT_THAT(with("reaction = { of = \"indenter\", value = [0, 1] }"),
              AllOf(HasSubstr("friction = 0.3"), HasSubstr("leave its friction out")));
}

/// A swinging strip seen over some periods: a stiffness that is far off swings out of step, and no small
/// change makes that better.
TEST_F(SceneMeasures, EscapeALocalMinimumByMoreStarts) {
  write_swinging_strip();
  const std::string text =
      "[[experiment]]\nscene = \"scene.toml\"\nprobe = { of = \"tip\", file = \"tip.csv\", sigma = 1e-4 }\n"
      "[[parameter]]\nkey = \"body.bar.material.youngs_modulus\"\nstart = 6e6\nbounds = [1e6, 1e7]\n";
  const SceneFitReport caught = fit(text);
  EXPECT_GT(std::abs(caught.parameters[0].value / 2e6 - 1), 0.1);  // the local minimum is one
  EXPECT_GT(caught.sum_of_squares, 1e4);
  const SceneFitReport report = fit(text + "[fit]\nstarts = 6\n");
  EXPECT_TRUE(report.is_converged);
  EXPECT_NEAR(report.parameters[0].value, 2e6, 1e-5 * 2e6);
  ASSERT_EQ(report.ends.size(), 6U);
  EXPECT_EQ(report.ends[0].sum_of_squares, caught.sum_of_squares);
  int solves = 0;
  for (const SearchEnd& end : report.ends) solves += end.solves;
  EXPECT_EQ(report.solves, solves);
  EXPECT_EQ(report.steps.size(), static_cast<std::size_t>(solves));
  EXPECT_THAT(scene_fit_text(report), HasSubstr("of 6 starts ended with this sum of squares"));
}

}  // namespace
}  // namespace resilin::testing
