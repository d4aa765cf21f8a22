// A modulus of each cell, found from markers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/io/vtu.hpp"
#include "scene_fit_files.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string sheet = R"(
[simulation]
kind = "static"
dimension = 2
[newton]
tolerance = 1e-10
[[body]]
name = "sheet"
mesh = { box = { kind = "quadrilaterals", size = [2, 1.2], cells = [20, 12] } }
material = { law = "neo_hookean", youngs_modulus = MODULUS, poissons_ratio = 0.3 }
[[fix]]
name = "grip"
where = { plane = { axis = "x", at = 0 } }
[[load]]
name = "pull"
kind = "traction"
value = [1e4, 2e3]
where = { plane = { axis = "x", at = 2 } }
)";

std::string sheet_with(const std::string& modulus) {
  std::string text = sheet;
  return text.replace(text.find("MODULUS"), 7, modulus);
}

/// A smooth hill and a hollow, by a factor of 2 each.
double true_modulus(double x, double y) {
  const double hill = std::exp(-((x - 0.6) * (x - 0.6) + (y - 0.7) * (y - 0.7)) / 0.15);
  const double hollow = std::exp(-((x - 1.5) * (x - 1.5) + (y - 0.4) * (y - 0.4)) / 0.15);
  return 1e5 * std::exp2(hill - hollow);
}

class FieldFit : public SceneFitFiles {
 protected:
  FieldFit() {
    std::string moduli;
    for (int j = 0; j < 12; ++j)
      for (int i = 0; i < 20; ++i) {
        truth.push_back(true_modulus(0.1 * i + 0.05, 0.1 * j + 0.05));
        moduli += format_number(truth.back()) + "\n";
      }
    folder.write("young.csv", moduli);
  }
  /// Markers at every vertex but those of the grip.
  void measure(double noise) {
    std::vector<Vector3> points;
    for (int j = 0; j <= 12; ++j)
      for (int i = 1; i <= 20; ++i) points.emplace_back(0.1 * i, 0.1 * j, 0);
    const Simulation run = run_to_the_end(scene(sheet_with("{ file = \"young.csv\" }")));
    folder.write("markers.csv", markers_csv(run, points, noise, random));
    scene(sheet_with("1.5e5"));
  }
  SceneFitReport fit_field(const std::string& sigma, const std::string& more = "") {
    return fit("[[experiment]]\nscene = \"scene.toml\"\nmarkers = { file = \"markers.csv\"" + sigma +
               " }\n[[parameter]]\nkey = \"body.sheet.material.youngs_modulus\"\nper = \"cell\"\n" + more);
  }
  double error_of_log(const std::vector<double>& values) const {
    double sum = 0;
    for (std::size_t c = 0; c < truth.size(); ++c) sum += std::pow(std::log(values[c] / truth[c]), 2);
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }

  std::vector<double> truth;
};

/// The error falls with the noise, the intervals hold the truth, and the misfit at the corner is that of the
/// noise.
TEST_F(FieldFit, FindsTheModulusOfEachCell) {
  double last = std::numeric_limits<double>::infinity();
  for (const double noise : {2e-3, 2e-4}) {
    measure(noise);
    const SceneFitReport report = fit_field(", sigma = " + format_number(noise));
    EXPECT_TRUE(report.is_converged) << report.why_not;
    EXPECT_LE(report.solves, 20);
    ASSERT_EQ(report.fields.size(), 1U);
    const FittedField& field = report.fields[0];
    ASSERT_EQ(field.values.size(), 240U);
    const double error = error_of_log(field.values);
    EXPECT_LT(error, 0.6 * last);
    EXPECT_LT(error, 0.25);  // the truth itself varies by 0.26
    last = error;
    EXPECT_NEAR(report.sum_of_squares / report.degrees_of_freedom, 1, 0.25);
    std::size_t held = 0;
    for (std::size_t c = 0; c < truth.size(); ++c)
      held += field.lower_95[c] <= truth[c] && truth[c] <= field.upper_95[c] ? 1 : 0;
    EXPECT_GE(held, 240 * 80 / 100) << noise;
    EXPECT_LT(report.regularised->point.freedom, 240);
    EXPECT_LT(std::abs(std::log10(report.regularised->strength / report.regularised->discrepancy)), 1.5);
  }
}

/// Without sigmas the noise is told by the residuals.
TEST_F(FieldFit, TellsTheNoiseWithoutSigmas) {
  measure(1e-3);
  const SceneFitReport report = fit_field("");
  EXPECT_TRUE(report.is_converged);
  EXPECT_NEAR(report.noise, 1e-3, 0.2e-3);
  EXPECT_LT(error_of_log(report.fields[0].values), 0.2);
  EXPECT_THAT(scene_fit_text(report), HasSubstr("cross validation takes"));
}

TEST_F(FieldFit, TakesTheWeightThatItIsGiven) {
  measure(1e-3);
  const SceneFitReport stiff = fit_field(", sigma = 1e-3", "[fit]\nregularise = { strength = 1e9 }\n");
  const std::vector<double>& values = stiff.fields[0].values;
  EXPECT_LT(std::ranges::max(values) / std::ranges::min(values), 1.001);  // all alike
  EXPECT_NEAR(stiff.regularised->point.freedom, 1, 0.01);
  EXPECT_THAT(stiff.estimates.warnings, ::testing::Contains(HasSubstr("discrepancy principle")));
  const SceneFitReport by_noise =
      fit_field(", sigma = 1e-3", "[fit]\nregularise = { strength = \"discrepancy\", kind = \"both\" }\n");
  const double left = by_noise.degrees_of_freedom;
  EXPECT_NEAR(by_noise.sum_of_squares, left + 2 * std::sqrt(2 * left), 0.02 * left);
}

/// Cells that no marker feels are known as little as the prior says.
TEST_F(FieldFit, SaysWhatIsNotDetermined) {
  measure(1e-3);
  // Markers on the half at the grip alone: the other half hangs on it and is not felt.
  std::string csv = folder.read("markers.csv"), near = csv.substr(0, csv.find('\n') + 1);
  for (std::size_t at = near.size(); at < csv.size();) {
    const std::size_t end = csv.find('\n', at) + 1;
    if (std::stod(csv.substr(at)) < 0.65) near += csv.substr(at, end - at);
    at = end;
  }
  folder.write("markers.csv", near);
  const SceneFitReport report = fit_field(", sigma = 1e-3");
  const FittedField& field = report.fields[0];
  const auto width = [&](std::size_t cell) { return field.upper_95[cell] / field.lower_95[cell]; };
  EXPECT_GT(std::log(width(6 * 20 + 19)), 1.5 * std::log(width(6 * 20 + 3)));
  EXPECT_GT(field.resolution[6 * 20 + 19], 3 * field.resolution[6 * 20 + 3]);
  const SceneFitReport loose = fit_field(", sigma = 1e-3", "[fit]\nregularise = { strength = 0.3 }\n");
  EXPECT_GT(loose.fields[0].num_loose, 60);
  EXPECT_LT(loose.fields[0].num_loose, 240);
  EXPECT_THAT(loose.estimates.warnings, ::testing::Contains(HasSubstr("known to no better than")));
}

/// Together with a number that is no field; and a field between bounds stays there.
TEST_F(FieldFit, FindsOtherNumbersBesides) {
  measure(2e-4);
  const SceneFitReport report = fit_field(
      ", sigma = 2e-4",
      "bounds = [3e4, 4e5]\n[[parameter]]\nkey = \"body.sheet.material.poissons_ratio\"\nstart = 0.2\n");
  EXPECT_TRUE(report.is_converged);
  ASSERT_EQ(report.parameters.size(), 1U);
  EXPECT_LT(report.parameters[0].lower_95, 0.3);
  EXPECT_GT(report.parameters[0].upper_95, 0.3);
  EXPECT_LT(report.parameters[0].upper_95 - report.parameters[0].lower_95, 0.1);
  EXPECT_THAT(report.fields[0].lower_95, Each(::testing::Ge(3e4)));
  EXPECT_THAT(report.fields[0].upper_95, Each(::testing::Le(4e5)));
}

/// A scene takes the mesh with the field, and the file of values; the page draws it.
TEST_F(FieldFit, IsWrittenForScenes) {
  measure(1e-3);
  const SceneFitReport report = fit_field(", sigma = 1e-3");
  write_scene_fit(report, folder / "out");
  std::string strip = sheet_with("{ cell_field = \"youngs_modulus\" }");
  const std::size_t begin = strip.find("mesh ="), end = strip.find('\n', begin);
  strip.replace(begin, end - begin, "mesh = \"sheet_youngs_modulus.vtu\"");
  folder.write("out/scene.toml", strip);
  const Description found = read_scene(folder / "out/scene.toml").description;
  EXPECT_EQ(found.bodies[0].material.cell_constants.at("youngs_modulus"), report.fields[0].values);
  EXPECT_EQ(read_vtu(folder / "out/sheet_youngs_modulus.vtu").cell_data.size(), 4U);
  folder.write("out/scene.toml", sheet_with("{ file = \"sheet_youngs_modulus.csv\" }"));
  EXPECT_EQ(read_scene(folder / "out/scene.toml")
                .description.bodies[0]
                .material.cell_constants.at("youngs_modulus"),
            report.fields[0].values);
  const std::string page = folder.read("out/fit.html");
  EXPECT_THAT(page,
              AllOf(HasSubstr("the L-curve"), HasSubstr("<polygon"), HasSubstr("discrepancy principle")));
  EXPECT_THAT(page, AllOf(Not(HasSubstr("nan")), Not(HasSubstr("{{")), Not(HasSubstr("http"))));
}

/// A swinging strip seen over some periods: fields that are far too stiff swing out of step, and no small
/// change makes that better. Where ends have weights of their own, they are compared at one.
TEST_F(FieldFit, EscapesALocalMinimumByMoreStarts) {
  write_swinging_strip();
  const std::string text =
      "[[experiment]]\nscene = \"scene.toml\"\nprobe = { of = \"tip\", file = \"tip.csv\", sigma = 1e-4 }\n"
      "[[parameter]]\nkey = \"body.bar.material.youngs_modulus\"\nper = \"cell\"\nstart = 6e6\n"
      "bounds = [1e6, 1e7]\n[fit]\nregularise = { strength = 1e5 }\n";
  const SceneFitReport caught = fit(text);
  EXPECT_GT(caught.sum_of_squares, 1e4);  // the local minimum is one
  ASSERT_EQ(caught.ends.size(), 1U);
  EXPECT_DOUBLE_EQ(caught.ends[0].start[0], 6e6);
  const SceneFitReport report = fit(text + "starts = 6\n");
  EXPECT_TRUE(report.is_converged) << report.why_not;
  for (const double value : report.fields[0].values) EXPECT_NEAR(value, 2e6, 0.01 * 2e6);
  ASSERT_EQ(report.ends.size(), 6U);
  EXPECT_EQ(report.ends[0].sum_of_squares, caught.sum_of_squares);
  EXPECT_EQ(report.ends[0].found, caught.ends[0].found);
  const SearchEnd& best = *std::ranges::min_element(report.ends, {}, &SearchEnd::objective);
  EXPECT_EQ(&best, &report.ends[report.best_end]);
  EXPECT_EQ(best.sum_of_squares, report.sum_of_squares);
  EXPECT_EQ(best.objective, best.sum_of_squares + report.regularised->strength * best.roughness);
  int solves = 0;
  for (const SearchEnd& end : report.ends) {
    solves += end.solves;
    EXPECT_EQ(end.found.size(), 1);
    EXPECT_GE(end.start[0], 1e6);
    EXPECT_LE(end.start[0], 1e7);
  }
  EXPECT_EQ(report.solves, solves);
  EXPECT_THAT(scene_fit_text(report), HasSubstr("of 6 starts ended with this sum of squares and prior"));
  EXPECT_THAT(scene_fit_page(report), HasSubstr("Where each start has ended"));
}

TEST_F(FieldFit, RefusesWhatIsNoField) {
  measure(1e-3);
  const auto with = [&](const std::string& parameter, const std::string& more = "") {
    return error_of(
        "[[experiment]]\nscene = \"scene.toml\"\nmarkers = { file = \"markers.csv\" }\n[[parameter]]\n" +
        parameter + more);
  };
  EXPECT_THAT(with("key = \"load.pull.value.x\"\nper = \"cell\"\n"),
              HasSubstr("a constant of a body's material"));
  EXPECT_THAT(with("key = \"body.sheet.material.youngs_modulus\"\nper = \"group\"\n"),
              AllOf(HasSubstr("groups of cells"), HasSubstr("per = \"cell\"")));
  EXPECT_THAT(with("key = \"body.sheet.material.youngs_modulus\"\nper = \"cels\"\n"),
              HasSubstr("did you mean"));
  EXPECT_THAT(with("key = \"body.sheet.material.youngs_modulus\"\nper = \"cell\"\n",
                   "[fit]\nregularise = { strength = \"discrepancy\" }\n"),
              HasSubstr("add sigma"));
  EXPECT_THAT(with("key = \"body.sheet.material.youngs_modulus\"\nper = \"cell\"\n",
                   "[fit]\nregularise = { strength = -1 }\n"),
              HasSubstr("> 0"));
  EXPECT_THAT(with("key = \"body.sheet.material.youngs_modulus\"\nper = \"cell\"\nbounds = [1.5e5, 2e5]\n"),
              HasSubstr("between the bounds"));
}

/// One number for each group of the mesh.
TEST_F(FieldFit, SeeksOneNumberForEachGroup) {
  Description description = scene(sheet_with("{ file = \"young.csv\" }"));
  const BodyDescription& body = description.bodies[0];
  Mesh mesh = body.mesh;
  std::vector<Index> left;
  for (Index c = 0; c < 240; ++c)
    if (c % 20 < 10) left.push_back(c);
  mesh.groups.push_back({.name = "left", .cells = {left}, .vertices = {}});
  std::vector<double>& moduli = description.bodies[0].material.cell_constants.at("youngs_modulus");
  for (std::size_t c = 0; c < moduli.size(); ++c) moduli[c] = c % 20 < 10 ? 1e5 : 3e5;
  const Simulation run = run_to_the_end(description);
  SceneFitDescription asked{};
  SceneExperiment experiment;
  experiment.place = experiment.name = "pull";
  experiment.description = scene(sheet_with("2e5"));
  experiment.description.bodies[0].mesh = mesh;
  MeasuredTable table;
  table.kind = MeasuredKind::markers;
  table.place = "markers";
  for (const Vector3& at : {Vector3(1, 0.6, 0), Vector3(2, 0.6, 0), Vector3(2, 0, 0)})
    table.rows.push_back({.place = "",
                          .at = at,
                          .value = displacement_at(run, at),
                          .is_measured = {true, true, false},
                          .moment = {}});
  experiment.tables.push_back(table);
  asked.experiments.push_back(experiment);
  asked.parameters.emplace_back();
  asked.parameters[0].key = "body.sheet.material.youngs_modulus";
  asked.parameters[0].per = SoughtPer::group;
  const SceneFitReport report = fit_scenes(asked);
  EXPECT_TRUE(report.is_converged);
  ASSERT_EQ(report.parameters.size(), 2U);
  EXPECT_EQ(report.parameters[0].name, "left");
  EXPECT_EQ(report.parameters[1].name, "others");
  EXPECT_NEAR(report.parameters[0].value, 1e5, 1);
  EXPECT_NEAR(report.parameters[1].value, 3e5, 3);
}

}  // namespace
}  // namespace resilin::testing
