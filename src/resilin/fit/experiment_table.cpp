#include <algorithm>
#include <iterator>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/fit/marker_table.hpp"
#include "resilin/scene/scene.hpp"

namespace resilin {
namespace {

/// A table of measurements as it is written.
struct RawMeasurements {
  std::string of;
  std::string file;
  NumberTable table;
  std::optional<Vector3> value;
  std::optional<double> sigma, tolerance;
};

using Raw = RawMeasurements;

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

Key<Raw> file_key(const char* columns) {
  return key<Raw>({"file", "text", "", "required",
                   std::string("A CSV file whose first line names its columns: ") + columns},
                  [](const SceneNode& node, Raw& raw) {
                    raw.file = read_text(node);
                    raw.table = read_csv(read_path(node));
                  });
}

Key<Raw> sigma_key(const char* unit) {
  return key<Raw>({"sigma", "number > 0", unit, "none",
                   "Standard deviation of each number, unless the file has a column of it. Without any, the "
                   "residuals themselves tell their size."},
                  [](const SceneNode& node, Raw& raw) { raw.sigma = read_number(node, positive); });
}

Keys<Raw> marker_keys() {
  return {
      file_key("X, Y, Z (places at rest, in 2D without Z) and ux, uy, uz (displacements) or x, y, z (places "
               "after it), and sigma, load (the load factor at rest), time (in motion), id. Components that "
               "were not measured are left out; without load and time the end of the run is meant."),
      sigma_key("m"),
      text_key("of", &Raw::of, "the only body", "The body that carries the markers."),
      key<Raw>({"tolerance", "number >= 0", "m", "rounding",
                "How far outside the body's mesh a marker may be; it is carried by the nearest cell."},
               [](const SceneNode& node, Raw& raw) { raw.tolerance = read_number(node, not_negative); }),
  };
}

/// Of a reaction or a probe: one vector, or a file of them.
Keys<Raw> vector_keys(const char* of_what, const char* columns, const char* unit) {
  Key<Raw> file = file_key(columns);
  file.doc.default_text = "none";
  file.is_required = false;
  return {
      key<Raw>({"of", "text", "", "required", of_what},
               [](const SceneNode& node, Raw& raw) { raw.of = read_text(node); }),
      file,
      key<Raw>({"value", "vector", unit, "none", "The vector at the end of the run, in place of a file."},
               [](const SceneNode& node, Raw& raw) { raw.value = read_vector(node); }),
      sigma_key(unit),
  };
}

Keys<Raw> keys_of(MeasuredKind kind) {
  switch (kind) {
    case MeasuredKind::markers:
      return marker_keys();
    case MeasuredKind::reaction:
      return vector_keys("The support, by its name, whose force on the bodies was measured.",
                         "fx, fy, fz, and sigma, load, time.", "N");
    case MeasuredKind::probe:
      break;
  }
  return vector_keys("The probe, by its name, whose displacement was measured.",
                     "ux, uy, uz, and sigma, load, time.", "m");
}

MeasuredTable read_measurements(const SceneNode& node, MeasuredKind kind) {
  Raw raw;
  read_table(node, keys_of(kind), raw);
  MeasuredTable table;
  table.kind = kind;
  table.place = node.place();
  table.of = raw.of;
  table.tolerance = raw.tolerance;
  const int dim = node.context->dimension;
  if (raw.file.empty() != raw.value.has_value())
    throw InputError(node.place(), "a file or a value", raw.value ? "both" : "neither",
                     raw.value ? "leave one of them out" : "add file = \"forces.csv\"");
  if (raw.value) {
    MeasuredRow row;
    row.place = node.place();
    row.value = *raw.value;
    for (std::size_t i = 0; i < static_cast<std::size_t>(dim); ++i) row.is_measured[i] = true;
    table.rows.push_back(row);
  } else {
    table.rows = measured_rows(kind, raw.table, dim, node.context->is_dynamic, raw.file, node.place());
  }
  for (MeasuredRow& row : table.rows) {
    if (raw.sigma && row.sigma > 0)
      throw InputError(node.place() + ".sigma", "a number or a column", "both", "leave one of them out");
    if (raw.sigma) row.sigma = *raw.sigma;
  }
  return table;
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
      key<R>({"scene", "text", "", "required", "A scene file (.toml): the experiment as it was done."},
             [](const SceneNode& node, R& raw) {
               const std::filesystem::path path = read_path(node);
               Scene scene = read_scene(path, {.overrides = raw.overrides});
               node.context->dimension = scene.description.dimension;
               node.context->is_dynamic = scene.description.is_dynamic;
               for (const std::string& warning : scene.warnings) node.context->warnings.push_back(warning);
               raw.experiment.description = std::move(scene.description);
               if (raw.experiment.name.empty()) raw.experiment.name = path.stem().string();
             }),
      measured_key(MeasuredKind::markers, "Displacements of points of a body."),
      measured_key(MeasuredKind::reaction,
                   "Forces of a support on the bodies; a list where there are several."),
      measured_key(MeasuredKind::probe, "Displacements of a probe."),
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
  };
}

Keys<SceneFitDescription> scene_fit_keys() {
  using F = SceneFitDescription;
  return {
      number_key("tolerance", &F::tolerance, "", positive,
                 "The search ends when its next step is less than this part of every parameter, or than "
                 "a ten-thousandth of their standard errors."),
      integer_key("max_solves", &F::max_solves, at_least_one, "So often each scene is solved at most."),
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
  return {document("[[experiment]]", "A scene that was done in a laboratory, and what was measured.",
                   experiment_keys()),
          document("experiment.markers", "Points of a body.", keys_of(MeasuredKind::markers)),
          document("experiment.reaction", "The force of a support.", keys_of(MeasuredKind::reaction)),
          document("experiment.probe", "The vertex that a scene watches.", keys_of(MeasuredKind::probe)),
          document("[[parameter]]", "What is sought with experiments.", parameter_keys()),
          document("[fit] of experiments", "How it is sought.", scene_fit_keys())};
}

}  // namespace resilin
