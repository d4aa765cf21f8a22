#include <algorithm>
#include <iterator>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/fit/measurement_table.hpp"
#include "resilin/scene/scene.hpp"

namespace resilin {
namespace {

/// Reads one value, or each of a list of them, by `read`.
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
      key<R>({"set", "list of texts", "", "none",
              "Values of the scene to change first, as after --set, so that experiments under several loads "
              "share one scene."},
             [](const SceneNode& node, R& raw) {
               expect_list(node, "texts");
               raw.overrides = read_one_or_more(node, read_text);
             }),
      key<R>(
          {"scene", "text", "", "required", "A scene file (.toml) of the experiment. In Python also a dict."},
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
      measured_key(MeasuredKind::markers, "Measured displacements of points of a body."),
      measured_key(MeasuredKind::reaction,
                   "Measured forces of a boundary condition or a collider, such as an indenter, on the "
                   "bodies; a list if there are several."),
      measured_key(MeasuredKind::probe, "Measured displacements of a probe."),
      measured_key(MeasuredKind::section, "Measured forces through a section of the scene."),
      measured_key(MeasuredKind::moment, "Measured moments in a section of the scene."),
      measured_key(MeasuredKind::energy, "Energies."),
      measured_key(MeasuredKind::volume, "Measured deformed volumes of a body, such as a bladder."),
      measured_key(MeasuredKind::stress, "Measured stresses at points of a body."),
  };
}

Keys<SceneParameter> parameter_keys() {
  using P = SceneParameter;
  return {
      key<P>({"key", "text", "", "required",
              "The parameter, by its key in the scenes: `body.NAME.material.youngs_modulus`, "
              "`load.NAME.value.y` "
              "([gradients.md](gradients.md#parameters)). A constant with cell values has one unknown for "
              "each different value."},
             [](const SceneNode& node, P& p) { p.key = read_text(node); }),
      key<P>({"name", "text or list of texts", "", "the key",
              "Name in the results; a list for several unknowns."},
             [](const SceneNode& node, P& p) { p.names = read_one_or_more(node, read_text); }),
      key<P>({"start", "number or list of numbers", "SI", "as in the scene", "Start of the search."},
             [](const SceneNode& node, P& p) {
               p.start = read_one_or_more(node, [](const SceneNode& one) { return read_number(one); });
             }),
      key<P>({"bounds", "list of 2 numbers", "SI", "those of the law", "Bounds."},
             [](const SceneNode& node, P& p) {
               expect_list(node, "numbers", 2);
               p.lower = read_number(node.element(0));
               p.upper = read_number(node.element(1));
               if (!(p.lower < p.upper)) node.fail("the smaller one first");
             }),
      key<P>({"experiment", "text", "", "all", "Name of the only experiment with this parameter."},
             [](const SceneNode& node, P& p) { p.experiment = read_text(node); }),
      choice_key("per", &P::per,
                 "Unknowns of a material constant: one for each different value of the scene (value), for "
                 "each cell group of the mesh (group), or for each cell (cell), a regularised field."),
  };
}

Keys<Regularisation> regularise_keys() {
  using R = Regularisation;
  return {
      choice_key("kind", &R::kind,
                 "Penalty on fields: smooth is the mean square of the gradient times the body's size; "
                 "tikhonov is the mean square of the distance from the start; both is their sum. Positive "
                 "values enter by their logarithm."),
      key<R>({"strength", "number > 0, or " + one_of(all_spellings<StrengthRule>()), "", "\"l_curve\"",
              "Regularisation weight: a number, the corner of the L-curve, or that of the discrepancy "
              "principle (misfit as large as the sigmas)."},
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
                 "The search ends when every parameter would change by less than this fraction, or than a "
                 "ten-thousandth of its standard error."),
      integer_key("max_solves", &F::max_solves, at_least_one, "Limit of solves of each scene, per start."),
      integer_key("starts", &F::starts, at_least_one,
                  "Number of starts; the best result counts. The first is that of the parameters; the others "
                  "lie between their bounds, or within a factor of 10. A field is scaled as a whole."),
      key<F>({"regularise", "[fit.regularise](#fitregularise)", "", "",
              "Regularisation of fields (per = \"cell\")."},
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
    node.fail_with("there are no measurements; add markers = { file = \"markers.csv\" }, reaction or probe");
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
        "there is no [[parameter]]; add the unknown: [[parameter]] with key = "
        "\"body.NAME.material.youngs_modulus\"");
  const SceneNode parameters = list_of(root, "parameter");
  for (std::size_t i = 0; i < parameters.value->array().size(); ++i)
    fit.parameters.push_back(read_scene_parameter(parameters.element(i)));
  return fit;
}

std::vector<TableDoc> scene_fit_docs() {
  std::vector<TableDoc> docs = measurement_docs();
  docs.insert(docs.begin(),
              document("[[experiment]]", "A laboratory experiment as a scene, with its measurements.",
                       experiment_keys()));
  docs.push_back(document("[[parameter]]", "An unknown parameter.", parameter_keys()));
  docs.push_back(document("[fit] of experiments", "Settings of the search.", scene_fit_keys()));
  docs.push_back(document("fit.regularise", "Regularisation of fields.", regularise_keys()));
  return docs;
}

}  // namespace resilin
