// Parameters of whole scenes, found from markers, reactions and probes.
#include "resilin/fit/scene_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "resilin/core/error.hpp"
#include "scene_fit_files.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

class SceneFit : public SceneFitFiles {};

const std::string two_moduli = R"(
[[experiment]]
scene = "scene.toml"
markers = { file = "markers.csv" MORE }
[[parameter]]
key = "body.bar.material.youngs_modulus"
name = ["root", "tip"]
start = [5e5, 5e5]
)";

std::string with_markers(const std::string& more) {
  std::string text = two_moduli;
  return text.replace(text.find("MORE"), 4, more);
}

TEST_F(SceneFit, FindsTwoModuliFromElevenMarkersInSixSolves) {
  folder.write("young.csv", moduli_csv(8e5, 3e5));
  const Simulation truth = run_to_the_end(scene(sagging_strip));
  folder.write("markers.csv", markers_csv(truth, middle_line(), 0, random));
  folder.write("young.csv", moduli_csv(6e5, 4e5));
  const SceneFitReport report = fit(with_markers(""));
  EXPECT_TRUE(report.is_converged);
  EXPECT_LE(report.solves, 6);
  ASSERT_EQ(report.parameters.size(), 2U);
  EXPECT_NEAR(report.parameters[0].value, 8e5, 1e-6 * 8e5);
  EXPECT_NEAR(report.parameters[1].value, 3e5, 1e-6 * 3e5);
  EXPECT_EQ(report.parameters[0].name, "root");
  EXPECT_EQ(report.parameters[0].start, 5e5);
  EXPECT_EQ(report.num_values, 22);
}

/// In 100 intervals of 95 % 90 to 99 hold the truth, of right ones in 98 of 100 experiments; with noise
/// of known and of unknown size.
TEST_F(SceneFit, GivesIntervalsThatHoldTheTruthAsOftenAsTheySay) {
  folder.write("young.csv", moduli_csv(8e5, 3e5));
  const Simulation truth = run_to_the_end(scene(sagging_strip));
  folder.write("young.csv", moduli_csv(6e5, 4e5));
  const double noise = 0.01 * displacement_at(truth, {1, 0.1, 0}).norm();
  for (const bool has_sigma : {true, false}) {
    int root = 0, tip = 0, most_solves = 0, model_errors = 0;
    for (int seed = 0; seed < 100; ++seed) {
      std::mt19937 own(static_cast<unsigned>(seed));
      folder.write("markers.csv", markers_csv(truth, middle_line(), noise, own));
      const SceneFitReport report =
          fit(with_markers(has_sigma ? ", sigma = " + format_number(noise) : std::string()));
      const auto holds = [&](std::size_t i, double value) {
        return report.parameters[i].lower_95 <= value && value <= report.parameters[i].upper_95;
      };
      root += holds(0, 8e5) ? 1 : 0;
      tip += holds(1, 3e5) ? 1 : 0;
      most_solves = std::max(most_solves, report.solves);
      model_errors += report.estimates.warnings.empty() ? 0 : 1;
    }
    EXPECT_GE(std::min(root, tip), 90) << has_sigma << " " << root << " " << tip;
    EXPECT_LE(std::max(root, tip), 99) << has_sigma << " " << root << " " << tip;
    EXPECT_LE(most_solves, 6) << has_sigma;
    EXPECT_LE(model_errors, 5) << has_sigma;  // one in a hundred
    RecordProperty(has_sigma ? "covered_with_sigma" : "covered",
                   std::to_string(root) + ", " + std::to_string(tip));
  }
}

/// The two moduli as those of the body and of a region, each found by its own key; no number for each cell.
TEST_F(SceneFit, FindsTheModulusOfARegion) {
  const auto strip_of = [](const std::string& root, const std::string& tip) {
    std::string strip = sagging_strip;
    strip.replace(strip.find("{ file = \"young.csv\" }"), 22, root);
    strip.insert(
        strip.find("[[fix]]"),
        "[[body.region]]\nname = \"tip\"\nwhere = { box = [[0.5, 0], [1, 0.2]] }\nmaterial = { law = "
        "\"neo_hookean\", poissons_ratio = 0.3, youngs_modulus = " +
            tip + " }\n");
    return strip;
  };
  const Simulation truth = run_to_the_end(scene(strip_of("8e5", "3e5")));
  folder.write("markers.csv", markers_csv(truth, middle_line(), 0, random));
  scene(strip_of("5e5", "5e5"));
  const std::string markers =
      "[[experiment]]\nscene = \"scene.toml\"\nmarkers = { file = \"markers.csv\" }\n";
  const SceneFitReport report = fit(markers +
                                    "[[parameter]]\nkey = \"body.bar.material.youngs_modulus\"\n"
                                    "[[parameter]]\nkey = \"body.bar.region.tip.material.youngs_modulus\"\n");
  EXPECT_NEAR(report.parameters[0].value, 8e5, 1e-4 * 8e5);
  EXPECT_NEAR(report.parameters[1].value, 3e5, 1e-4 * 3e5);
  EXPECT_EQ(report.parameters[1].unit, "Pa");
  EXPECT_THAT(scene_material_toml(report),
              HasSubstr("# Under the [[body.region]] \"tip\" of \"bar\":\nmaterial = "));
  for (const std::string key :
       {"body.bar.material.youngs_modulus", "body.bar.region.tip.material.youngs_modulus"})
    EXPECT_THAT(error_of(markers + "[[parameter]]\nkey = \"" + key + "\"\nper = \"cell\"\n"),
                HasSubstr("expected one number of a body with regions"));
}

/// Truth by quadratic triangles, the fit by few linear ones, which bend far too little.
TEST_F(SceneFit, ReportsAModelErrorWhereTheMeshIsTooCoarse) {
  std::string strip = sagging_strip;
  strip.replace(strip.find("kind = \"quadrilaterals\", "), 25, "");
  strip.insert(strip.find("name = \"bar\""), "element = \"P2\"\n");
  folder.write("young.csv", "");
  strip.replace(strip.find("{ file = \"young.csv\" }"), 22, "8e5");
  const Simulation truth = run_to_the_end(scene(strip));
  folder.write("markers.csv", markers_csv(truth, middle_line(), 1e-4, random));
  strip.replace(strip.find("\"P2\""), 4, "\"P1\"");
  scene(strip);
  const SceneFitReport report =
      fit("[[experiment]]\nscene = \"scene.toml\"\nmarkers = { file = \"markers.csv\", sigma = 1e-4 }\n"
          "[[parameter]]\nkey = \"body.bar.material.youngs_modulus\"\n");
  ASSERT_EQ(report.estimates.warnings.size(), 1U);
  EXPECT_THAT(report.estimates.warnings[0], AllOf(HasSubstr("model error"), HasSubstr("times as large")));
  EXPECT_GT(report.sum_of_squares, 10 * report.degrees_of_freedom);
  // By the sigmas alone the interval would be this much narrower.
  const FittedParameter& E = report.parameters[0];
  EXPECT_LT(E.value, 7e5);  // the mesh is too stiff
  EXPECT_GT((E.upper_95 - E.lower_95) / E.value, 0.001);
}

const std::string pulled_strip = R"(
[simulation]
kind = "static"
dimension = 2
load_steps = 2
[newton]
tolerance = 1e-11
[[body]]
name = "bar"
mesh = { box = { kind = "quadrilaterals", size = [1, 0.2], cells = [10, 2] } }
material = { law = "neo_hookean", youngs_modulus = 5e5, poissons_ratio = 0.3, density = 1000 }
[[fix]]
name = "wall"
where = { plane = { axis = "x", at = 0 } }
[[fix]]
name = "grip"
where = { plane = { axis = "x", at = 1 } }
displacement = [0.2, 0.01]
[[load]]
name = "wind"
kind = "body_force"
value = [0, -2e4]
[[probe]]
name = "middle"
at = [0.5, 0.1]
)";

/// Columns of the Jacobian against differences of what the model gives: all kinds of measurements, at several
/// loads, and all kinds of parameters.
TEST_F(SceneFit, HasSlopesThatAgreeWithDifferences) {
  scene(pulled_strip);
  folder.write("markers.csv", "load,X,Y,uy\n0.5,0.33,0.07,0\n1,0.71,0.15,0\n");
  folder.write("forces.csv", "load,fx,fy\n0.5,1,1\n1,2,1\n");
  const SceneFitDescription description = read_scene_fit(folder.write("fit.toml", R"(
[[experiment]]
scene = "scene.toml"
markers = { file = "markers.csv", sigma = 1 }
reaction = [{ of = "grip", file = "forces.csv", sigma = 1 }, { of = "wall", value = [1, 2], sigma = 1 }]
probe = { of = "middle", value = [0.1, 0.0], sigma = 1 }
[[parameter]]
key = "body.bar.material.youngs_modulus"
[[parameter]]
key = "body.bar.material.poissons_ratio"
[[parameter]]
key = "load.wind.value.y"
[[parameter]]
key = "fix.grip.displacement.x"
)"));
  const SceneModel model(description);
  ASSERT_EQ(model.data().measured.size(), 2 + 4 + 2 + 2);
  VectorX p(4);
  for (Eigen::Index i = 0; i < 4; ++i) p[i] = model.unknowns()[static_cast<std::size_t>(i)].start;
  EXPECT_EQ(p[3], 0.2);
  EXPECT_TRUE(model.unknowns()[0].is_positive);
  EXPECT_FALSE(model.unknowns()[1].is_positive);
  const DenseMatrix J = model.slopes(model.solve(p, {}));
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double h = 1e-4 * std::abs(p[i]);
    const VectorX more = model.solve(p + h * VectorX::Unit(4, i), {}).values;
    const VectorX less = model.solve(p - h * VectorX::Unit(4, i), {}).values;
    const VectorX difference = (more - less) / (2 * h);
    for (Eigen::Index k = 0; k < J.rows(); ++k)  // central differences: their error is of the square of 1e-4
      EXPECT_NEAR(J(k, i), difference[k], 1e-6 * J.col(i).cwiseAbs().maxCoeff()) << k << " by " << i;
  }
}

/// A reaction tells the modulus, markers tell Poisson's ratio; two experiments share both.
TEST_F(SceneFit, SharesParametersAmongExperiments) {
  folder.write("pull.toml", pulled_strip);
  const auto measured = [&](const std::string& change) {
    const std::string set = "load.wind.value=" + change;
    return run_to_the_end(read_scene(folder / "pull.toml", {.overrides = {set}}).description);
  };
  const Simulation a = measured("[0, -2e4]"), b = measured("[0, 3e4]");
  folder.write("a.csv", markers_csv(a, middle_line(), 0, random));
  folder.write("b.csv", markers_csv(b, middle_line(), 0, random));
  const auto force = [](const Simulation& run) {
    const Vector3 f = run.frame().reactions[1].second;
    return "[" + format_number(f[0]) + ", " + format_number(f[1]) + "]";
  };
  const std::string text =
      "[[experiment]]\nname = \"down\"\nscene = \"pull.toml\"\nmarkers = { file = \"a.csv\", sigma = 1e-4 }\n"
      "reaction = { of = \"grip\", value = " +
      force(a) +
      ", sigma = 10 }\n"
      "[[experiment]]\nname = \"up\"\nscene = \"pull.toml\"\nset = [\"load.wind.value=[0, 1e4]\"]\n"
      "markers = { file = \"b.csv\", sigma = 1e-4 }\nreaction = { of = \"grip\", value = " +
      force(b) +
      ", sigma = 10 }\n"
      "[[parameter]]\nkey = \"body.bar.material.youngs_modulus\"\nstart = 2e5\n"
      "[[parameter]]\nkey = \"body.bar.material.poissons_ratio\"\nstart = 0.1\n"
      "[[parameter]]\nkey = \"load.wind.value.y\"\nexperiment = \"up\"\n";
  const SceneFitReport report = fit(text);
  EXPECT_TRUE(report.is_converged);
  EXPECT_NEAR(report.parameters[0].value, 5e5, 1e-6 * 5e5);
  EXPECT_NEAR(report.parameters[1].value, 0.3, 1e-6);
  EXPECT_NEAR(report.parameters[2].value, 3e4, 1e-6 * 3e4);
  ASSERT_EQ(report.tables.size(), 4U);
  EXPECT_EQ(report.tables[3].name, "up: reaction of grip");
  EXPECT_THAT(scene_fit_text(report), HasSubstr("of each of the 2 scenes"));
}

/// Where all motion is prescribed markers feel no modulus, and of two only their ratio.
TEST_F(SceneFit, SaysWhatTheMeasurementsDoNotTell) {
  std::string strip = pulled_strip;
  strip.replace(strip.find("[0, -2e4]"), 9, "[0, 0]");
  const Simulation truth = run_to_the_end(scene(strip));
  folder.write("markers.csv", markers_csv(truth, middle_line(), 1e-4, random));
  const std::string experiment =
      "[[experiment]]\nscene = \"scene.toml\"\nmarkers = { file = \"markers.csv\" }\n";
  const std::string modulus = "[[parameter]]\nkey = \"body.bar.material.youngs_modulus\"\n";
  EXPECT_THAT(error_of(experiment + modulus), AllOf(HasSubstr("no effect of"), HasSubstr("a reaction does")));
  folder.write("young.csv", moduli_csv(5e5, 4e5));
  strip.replace(strip.find("youngs_modulus = 5e5"), 20, "youngs_modulus = { file = \"young.csv\" }");
  scene(strip);
  const SceneFitReport report = fit(experiment + modulus + "name = [\"a\", \"b\"]\n");
  ASSERT_EQ(report.estimates.warnings.size(), 1U);
  EXPECT_THAT(report.estimates.warnings[0], HasSubstr("only log a - log b is determined"));
  EXPECT_FALSE(std::isfinite(report.parameters[0].standard_error));
  EXPECT_NEAR(report.parameters[0].value / report.parameters[1].value, 1, 0.05);
}

TEST_F(SceneFit, HoldsABoundAndSaysSo) {
  folder.write("young.csv", moduli_csv(8e5, 3e5));
  const Simulation truth = run_to_the_end(scene(sagging_strip));
  folder.write("markers.csv", markers_csv(truth, middle_line(), 1e-4, random));
  const SceneFitReport report = fit(with_markers("") + "bounds = [1e5, 7.9e5]\n");
  EXPECT_TRUE(report.is_converged);
  EXPECT_TRUE(report.parameters[0].is_held);
  EXPECT_EQ(report.parameters[0].value, 7.9e5);
  EXPECT_FALSE(report.parameters[1].is_held);
  ASSERT_FALSE(report.estimates.warnings.empty());
  EXPECT_THAT(report.estimates.warnings.back(), HasSubstr("root is at its bound, 790000"));
}

/// A far start: without a solution there, or with one that is worse, steps are shortened.
TEST_F(SceneFit, GoesAroundPlacesWithoutASolution) {
  folder.write("young.csv", moduli_csv(8e5, 3e5));
  const Simulation truth = run_to_the_end(scene(sagging_strip));
  folder.write("markers.csv", markers_csv(truth, middle_line(), 0, random));
  std::string text = with_markers("");
  text.replace(text.find("[5e5, 5e5]"), 10, "[4e6, 1e5]");
  const SceneFitReport report = fit(text);
  EXPECT_TRUE(report.is_converged);
  EXPECT_NEAR(report.parameters[0].value, 8e5, 1e-5 * 8e5);
  EXPECT_NEAR(report.parameters[1].value, 3e5, 1e-5 * 3e5);
}

/// Where "auto" would change the element on the way, the sum of squares does not jump.
TEST_F(SceneFit, KeepsTheElementsOfTheStart) {
  folder.write("young.csv", moduli_csv(3e5, 3e5));
  Description true_scene = scene(sagging_strip);
  true_scene.bodies[0].element = "Q1";
  true_scene.bodies[0].material.constants["poissons_ratio"] = 0.46;
  folder.write("markers.csv", markers_csv(run_to_the_end(true_scene), middle_line(), 0, random));
  const SceneFitReport report =
      fit("[[experiment]]\nscene = \"scene.toml\"\nmarkers = { file = \"markers.csv\" }\n"
          "[[parameter]]\nkey = \"body.bar.material.poissons_ratio\"\nbounds = [0, 0.49]\n");
  EXPECT_TRUE(report.is_converged);
  EXPECT_NEAR(report.parameters[0].value, 0.46, 1e-6);
  EXPECT_THAT(report.estimates.warnings, Contains(HasSubstr("bar: the fit kept element = \"Q1\"")));
}

/// A strip that swings: its density and modulus from where the probe is at several times.
TEST_F(SceneFit, FollowsMotion) {
  std::string strip = sagging_strip;
  strip.replace(strip.find("kind = \"static\""), 15,
                "kind = \"dynamic\"\ntime_step = 0.01\nend_time = 0.1\nintegrator = \"bdf2\"");
  strip.replace(strip.find("{ file = \"young.csv\" }"), 22, "5e5");
  strip.insert(strip.find("[[fix]]"), "damping = { stiffness = 0.01 }\n");
  Simulation truth{scene(strip)};
  std::string csv = "time,ux,uy\n";
  while (!truth.is_finished()) {
    truth.step();
    if (truth.state().step % 3 != 0) continue;
    const Vector3 u = displacement_at(truth, {1, 0.1, 0});
    csv += format_number(truth.state().time) + "," + format_number(u[0]) + "," + format_number(u[1]) + "\n";
  }
  folder.write("tip.csv", csv);
  const SceneFitReport report =
      fit("[[experiment]]\nscene = \"scene.toml\"\nprobe = { of = \"tip\", file = \"tip.csv\" }\n"
          "[[parameter]]\nkey = \"body.bar.material.youngs_modulus\"\nstart = 4e5\n"
          "[[parameter]]\nkey = \"body.bar.damping.stiffness\"\nstart = 0.02\n");
  EXPECT_TRUE(report.is_converged);
  EXPECT_NEAR(report.parameters[0].value, 5e5, 1e-5 * 5e5);
  EXPECT_NEAR(report.parameters[1].value, 0.01, 1e-5);
}

TEST_F(SceneFit, WritesWhatASceneTakes) {
  folder.write("young.csv", moduli_csv(8e5, 3e5));
  const Simulation truth = run_to_the_end(scene(sagging_strip));
  folder.write("markers.csv", markers_csv(truth, middle_line(), 1e-4, random));
  const SceneFitReport report = fit(with_markers(", sigma = 1e-4"));
  write_scene_fit(report, folder / "out");
  const nlohmann::json json = nlohmann::json::parse(folder.read("out/fit.json"));
  EXPECT_EQ(json["parameters"][1]["value"].get<double>(), report.parameters[1].value);
  EXPECT_EQ(json["tables"][0]["measured"].size(), 22U);
  const std::string material = folder.read("out/material.toml");
  std::string strip = sagging_strip;
  const std::size_t begin = strip.find("material ="), end = strip.find('\n', begin);
  strip.replace(begin, end - begin, material.substr(material.find("material =")));
  folder.write("out/scene.toml", strip);
  const Description found = read_scene(folder / "out/scene.toml").description;
  EXPECT_EQ(found.bodies[0].material.cell_constants.at("youngs_modulus").front(), report.parameters[0].value);
  EXPECT_EQ(found.bodies[0].material.cell_constants.at("youngs_modulus").back(), report.parameters[1].value);
}

TEST_F(SceneFit, StopsWhenItIsTold) {
  folder.write("young.csv", moduli_csv(8e5, 3e5));
  const Simulation truth = run_to_the_end(scene(sagging_strip));
  folder.write("markers.csv", markers_csv(truth, middle_line(), 0, random));
  int solves = 0;
  const auto begin = [&] {
    fit_scenes(read_scene_fit(folder.write("fit.toml", with_markers(""))),
               {.on_solve = [&](const SceneFitStep& step) { solves = step.solve; },
                .goes_on = [&] { return solves < 2; }});
  };
  EXPECT_THROW(begin(), Interrupted);
  EXPECT_EQ(solves, 2);
  const SceneFitReport report = fit(with_markers("") + "[fit]\nmax_solves = 2\n");
  EXPECT_FALSE(report.is_converged);
  EXPECT_THAT(report.estimates.warnings.front(), HasSubstr("raise max_solves"));
}

}  // namespace
}  // namespace resilin::testing
