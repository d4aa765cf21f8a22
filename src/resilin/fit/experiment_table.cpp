#include <algorithm>
#include <iterator>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/fit/measurement_table.hpp"
#include "resilin/scene/scene.hpp"

namespace resilin {
namespace {

/// What `read` makes of one value, or of each of a list of them.
template <class Read>
auto read_one_or_more(const SceneNode& node, const Read& read) {
  std::vector<decltype(read(node))> all;
  if (!node.value->is_array()) {
    all.push_back(read(node));
    return all;
  }
  for (std::size_t i = 0; i < node.value->array().size(); ++i) all.push_back(read(node.element(i)));
  return all;
}

struct RawExperiment {
  SceneExperiment experiment;
  std::vector<std::string> overrides;
};

Key<RawExperiment> measured_key(MeasuredKind kind, const char* text) {
  const std::string name = spelling(kind);
  return key<RawExperiment>(
      {name, "[experiment." + name + "](#experiment" + name + ")", "", "none", text},
      [kind](const SceneNode& node, RawExperiment& raw) {
        std::ranges::move(
            read_one_or_more(node, [kind](const SceneNode& one) { return read_measurements(one, kind); }),
            std::back_inserter(raw.experiment.tables));
      });
}

Keys<RawExperiment> experiment_keys() {
  using R = RawExperiment;
  return {
      key<R>({"name", "text", "", "that of the scene's file", "Shown with the results."},
             [](const SceneNode& node, R& raw) { raw.experiment.name = read_text(node); }),
      key<R>(
          {"set", "list of texts", "", "none",
           "Values of the scene to change first, as after --set: one scene serves experiments under several "
           "loads."},
          [](const SceneNode& node, R& raw) {
            expect_list(node, "texts");
            raw.overrides = read_one_or_more(node, read_text);
          }),
      key<R>({"scene", "text", "", "required",
              "A scene file (.toml): the experiment as it was done. In Python a dict, too."},
             [](const SceneNode& node, R& raw) {
               const bool is_here = node.value->is_table();
               const std::filesystem::path path = is_here ? std::filesystem::path("scene") : read_path(node);
               const SceneOptions options{.overrides = raw.overrides};
               Scene scene =
                   is_here ? read_scene_from_values(*node.value, node.place(), node.context->folder, options)
                           : read_scene(path, options);
               node.context->dimension = scene.description.dimension;
               node.context->is_dynamic = scene.description.is_dynamic;
               for (const std::string& warning : scene.warnings) node.context->warnings.push_back(warning);
               raw.experiment.description = std::move(scene.description);
               if (raw.experiment.name.empty()) raw.experiment.name = path.stem().string();
             }),
      measured_key(MeasuredKind::markers, "Displacements of points of a body."),
      measured_key(
          MeasuredKind::reaction,
          "Forces of a support or a collider, such as an indenter, on the bodies; a list where there are "
          "several."),
      measured_key(MeasuredKind::probe, "Displacements of a probe."),
      measured_key(MeasuredKind::section, "Forces through a section of the scene."),
      measured_key(MeasuredKind::moment, "Moments in a section of the scene."),
      measured_key(MeasuredKind::energy, "Energies."),
      measured_key(MeasuredKind::volume, "Volumes of a body as it is deformed, such as that of a bladder."),
      measured_key(MeasuredKind::stress, "Stresses at places of a body."),
  };
}

Keys<SceneParameter> parameter_keys() {
  using P = SceneParameter;
  return {
      key<P>({"key", "text", "", "required",
              "What is sought, by its key in the scenes: `body.NAME.material.youngs_modulus`, "
              "`load.NAME.value.y` "
              "([gradients.md](gradients.md#parameters)). A constant that the scene has for each cell is "
              "sought for each of its different values."},
             [](const SceneNode& node, P& p) { p.key = read_text(node); }),
      key<P>({"name", "text or list of texts", "", "the key", "In results; a list where several are sought."},
             [](const SceneNode& node, P& p) { p.names = read_one_or_more(node, read_text); }),
      key<P>({"start", "number or list of numbers", "SI", "as in the scene", "Where the search starts."},
             [](const SceneNode& node, P& p) {
               p.start = read_one_or_more(node, [](const SceneNode& one) { return read_number(one); });
             }),
      key<P>({"bounds", "list of 2 numbers", "SI", "those of the law", "It stays between them."},
             [](const SceneNode& node, P& p) {
               expect_list(node, "numbers", 2);
               p.lower = read_number(node.element(0));
               p.upper = read_number(node.element(1));
               if (!(p.lower < p.upper)) node.fail("the smaller one first");
             }),
      key<P>({"experiment", "text", "", "all", "The only experiment, by its name, whose scene has it."},
             [](const SceneNode& node, P& p) { p.experiment = read_text(node); }),
      choice_key(
          "per", &P::per,
          "Of a constant of a body's material: value seeks one number for each different value that the "
          "scene has, "
          "group one for each group of cells of the mesh, cell one for each cell, a field with a prior."),
  };
}

Keys<Regularisation> regularise_keys() {
  using R = Regularisation;
  return {
      choice_key(
          "kind", &R::kind,
          "What is asked of fields: smooth, the mean square of their gradient times the body's size; "
          "tikhonov, the "
          "mean square of their way from the start; both, the sum. Of logarithms where values are positive."),
      key<R>({"strength", "number > 0, or " + one_of(all_spellings<StrengthRule>()), "", "\"l_curve\"",
              "Its weight beside the sum of squares: a number, the corner of the L-curve, or the one that "
              "leaves the "
              "misfit which the sigmas expect."},
             [](const SceneNode& node, R& r) {
               if (std::holds_alternative<std::string>(node.value->data))
                 r.rule = *find_spelled<StrengthRule>(read_choice(node, all_spellings<StrengthRule>()));
               else
                 r.strength = read_number(node, positive);
             }),
  };
}

Keys<SceneFitDescription> scene_fit_keys() {
  using F = SceneFitDescription;
  return {
      number_key("tolerance", &F::tolerance, "", positive,
                 "The search ends when its next step is less than this part of every parameter, or than "
                 "a ten-thousandth of their standard errors."),
      integer_key("max_solves", &F::max_solves, at_least_one,
                  "So often each scene is solved at most, from each start."),
      integer_key(
          "starts", &F::starts, at_least_one,
          "From so many starts the search is made; the best end counts. The first is that of the "
          "parameters, the "
          "others lie between their bounds, or within a factor of 10 of it; a field is moved as a whole."),
      key<F>({"regularise", "[fit.regularise](#fitregularise)", "", "", "Of fields: parameters per cell."},
             [](const SceneNode& node, F& f) {
               f.regularise.place = node.place();
               read_table(node, regularise_keys(), f.regularise);
             }),
  };
}

SceneNode list_of(const SceneNode& root, const char* key) {
  const SceneNode list = root.child(key);
  if (!list.value->is_array() || list.value->array().empty())
    list.fail(std::string("a list of tables, each headed [[") + key + "]]");
  return list;
}

SceneExperiment read_experiment(const SceneNode& node) {
  RawExperiment raw;
  raw.experiment.place = node.place();
  read_table(node, experiment_keys(), raw);
  if (raw.experiment.tables.empty())
    node.fail_with("nothing was measured; add markers = { file = \"markers.csv\" }, reaction or probe");
  return std::move(raw.experiment);
}

SceneParameter read_scene_parameter(const SceneNode& node) {
  SceneParameter parameter;
  parameter.place = node.place();
  read_table(node, parameter_keys(), parameter);
  return parameter;
}

}  // namespace

SceneFitDescription read_scene_fit_root(const SceneNode& root) {
  SceneFitDescription fit;
  fit.place = root.place();
  refuse_unknown_keys(root, {"title", "fit", "experiment", "parameter"});
  if (root.has("title")) fit.title = read_text(root.child("title"));
  if (root.has("fit")) read_table(root.child("fit"), scene_fit_keys(), fit);
  const SceneNode experiments = list_of(root, "experiment");
  for (std::size_t i = 0; i < experiments.value->array().size(); ++i) {
    fit.experiments.push_back(read_experiment(experiments.element(i)));
    const auto has_name = [&](const SceneExperiment& other) {
      return other.name == fit.experiments.back().name;
    };
    if (std::ranges::count_if(fit.experiments, has_name) > 1)
      fit.experiments.back().name += " " + std::to_string(i + 1);
  }
  if (!root.has("parameter"))
    root.fail_with(
        "there is no [[parameter]]; say what is sought: [[parameter]] with key = "
        "\"body.NAME.material.youngs_modulus\"");
  const SceneNode parameters = list_of(root, "parameter");
  for (std::size_t i = 0; i < parameters.value->array().size(); ++i)
    fit.parameters.push_back(read_scene_parameter(parameters.element(i)));
  return fit;
}

std::vector<TableDoc> scene_fit_docs() {
  std::vector<TableDoc> docs = measurement_docs();
  docs.insert(docs.begin(),
              document("[[experiment]]", "A scene that was done in a laboratory, and what was measured.",
                       experiment_keys()));
  docs.push_back(document("[[parameter]]", "What is sought with experiments.", parameter_keys()));
  docs.push_back(document("[fit] of experiments", "How it is sought.", scene_fit_keys()));
  docs.push_back(document("fit.regularise", "What is asked of fields besides.", regularise_keys()));
  return docs;
}

}  // namespace resilin
