#include "resilin/fit/fit_file.hpp"

#include <algorithm>
#include <memory>

#include "resilin/core/error.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/fit/law_choice.hpp"
#include "resilin/io/atomic_file.hpp"

namespace resilin {
namespace {

Keys<ConstantSetting> constant_setting_keys() {
  using C = ConstantSetting;
  return {
      key<C>({"start", "number", "Pa", "chosen by itself", "A further start of the search."},
             [](const SceneNode& node, C& c) { c.start = read_number(node); }),
      key<C>({"bounds", "list of 2 numbers", "Pa", "those of the law", "Bounds of the constant."},
             [](const SceneNode& node, C& c) {
               expect_list(node, "numbers", 2);
               c.lower = read_number(node.element(0));
               c.upper = read_number(node.element(1));
               if (!(c.lower < c.upper)) node.fail("the smaller one first");
             }),
      key<C>({"value", "number", "Pa", "none", "Fixed value of the constant."},
             [](const SceneNode& node, C& c) { c.value = read_number(node); }),
  };
}

/// One of several words, or a list of them.
void read_laws(const SceneNode& node, std::vector<std::string>& laws) {
  if (std::holds_alternative<std::string>(node.value->data))
    laws = {read_text(node)};
  else
    laws = read_choices(node, fit_law_names());
  if (laws != std::vector<std::string>{"all"} && !node.value->is_array())
    laws = {read_choice(node, fit_law_names())};
  if (laws.empty()) node.fail("the names of laws");
}

void read_constant_settings(const SceneNode& node, std::vector<ConstantSetting>& settings) {
  expect_table(node);
  for (const SceneMember& member : node.value->table()) {
    const SceneNode entry = node.child(member.key);
    expect_table(entry);
    ConstantSetting setting;
    setting.name = member.key;
    setting.place = entry.place();
    read_table(entry, constant_setting_keys(), setting);
    settings.push_back(setting);
  }
}

Keys<FitDescription> fit_keys() {
  using F = FitDescription;
  return {
      key<F>({"laws", "list of texts, or \"all\"", "", one_of(usual_fit_laws()),
              "The models to fit: names of [laws](laws.md), and ogden1, ogden2, ogden3 by number of terms."},
             [](const SceneNode& node, F& f) { read_laws(node, f.laws); }),
      choice_key(
          "residual", &F::residual,
          "The residual to minimise: stress difference, relative to the measured stress, or over sigma."),
      choice_key("stability", &F::stability,
                 "Drucker stability over the range of the data: required, only reported, or off."),
      choice_key("volume", &F::volume,
                 "Incompressible limit, or compressible with traction-free sides. auto: compressible if a "
                 "test changes the volume."),
      key<F>({"poissons_ratio", "number > 0 and < 0.5", "", default_text(F{}.poissons_ratio),
              "Poisson's ratio of the written material if the tests do not determine it."},
             [](const SceneNode& node, F& f) {
               f.poissons_ratio = read_number(node, {.min = 0, .min_is_allowed = false, .max = 0.4999999});
             }),
      key<F>({"parameters", "table", "", "none",
              "Settings by the name of a constant, or \"LAW.CONSTANT\" for one law: { limit = { bounds = "
              "[50, 200] } }; "
              "keys are start, bounds and value."},
             [](const SceneNode& node, F& f) { read_constant_settings(node, f.constants); }),
      key<F>(
          {"regularise", "table", "", "none", "For fits of scenes only: [fit.regularise](#fitregularise)."},
          [](const SceneNode& node, F&) {
            node.fail_with("homogeneous tests have no fields; use scenes: [[experiment]] and [[parameter]]");
          }),
  };
}

FitDescription read_fit_root(const SceneNode& root) {
  FitDescription fit;
  fit.place = root.place();
  refuse_unknown_keys(root, {"title", "test", "fit"});
  if (root.has("title")) fit.title = read_text(root.child("title"));
  if (root.has("fit")) read_table(root.child("fit"), fit_keys(), fit);
  if (!root.has("test"))
    root.fail_with(
        "there is no [[test]], with mode and file, and no [[experiment]], with scene and markers; a fit "
        "needs "
        "at least one");
  const SceneNode tests = root.child("test");
  if (!tests.value->is_array() || tests.value->array().empty())
    tests.fail("a list of tables, each headed [[test]]");
  for (std::size_t i = 0; i < tests.value->array().size(); ++i)
    fit.tests.push_back(read_material_test(tests.element(i)));
  return fit;
}

/// Tests of the same name are told apart by number.
void make_names_unique(std::vector<MaterialTest>& tests) {
  std::vector<std::string> names;
  for (const MaterialTest& test : tests) names.push_back(test.name);
  for (std::size_t i = 0; i < tests.size(); ++i)
    if (std::ranges::count(names, names[i]) > 1)
      tests[i].name +=
          " " + std::to_string(
                    std::count(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) + 1);
}

/// Refuses keys of a scene that a fit has not.
void refuse_scene(const SceneNode& root) {
  for (const char* key : {"body", "simulation"})
    if (root.has(key))
      root.fail_with(std::string("this is a scene, because it has \"") + key +
                     "\"; resilin run takes it, and resilin fit a file with [[experiment]] and scene = \"" +
                     "FILE\"");
}

AnyFit read_any_fit_from_values(SceneValue values, const std::string& name,
                                const std::filesystem::path& folder,
                                const std::vector<std::string>& overrides) {
  for (const std::string& assignment : overrides) apply_override(values, assignment);
  SceneContext context;
  context.folder = folder;
  values.source = std::make_shared<const std::string>(name);
  values.line = 0;
  const SceneNode root{&values, "", &context};
  refuse_scene(root);
  if (root.has("relaxation")) return read_relaxation_root(root);
  if (root.has("experiment")) {
    if (root.has("test"))
      throw InputError(root.place(), "[[test]] or [[experiment]]", "both",
                       "use separate files for homogeneous tests and whole scenes");
    SceneFitDescription fit = read_scene_fit_root(root);
    fit.warnings = std::move(context.warnings);
    return fit;
  }
  FitDescription fit = read_fit_root(root);
  make_names_unique(fit.tests);
  fit.warnings = std::move(context.warnings);
  return fit;
}

FitDescription of_tests(AnyFit fit) {
  if (auto* tests = std::get_if<FitDescription>(&fit)) return std::move(*tests);
  if (auto* relaxation = std::get_if<RelaxationDescription>(&fit))
    throw InputError(relaxation->place, "[[test]]", "[relaxation]",
                     "a relaxation is fitted by fit_relaxation, in Python resilin.fit_relaxation");
  throw InputError(std::get<SceneFitDescription>(fit).place, "[[test]]", "[[experiment]]",
                   "whole scenes are fitted by fit_scenes");
}

SceneFitDescription of_scenes(AnyFit fit) {
  if (auto* scenes = std::get_if<SceneFitDescription>(&fit)) return std::move(*scenes);
  if (auto* relaxation = std::get_if<RelaxationDescription>(&fit))
    throw InputError(relaxation->place, "[[experiment]]", "[relaxation]",
                     "a relaxation is fitted by fit_relaxation, in Python resilin.fit_relaxation");
  throw InputError(std::get<FitDescription>(fit).place, "[[experiment]]", "[[test]]",
                   "homogeneous tests are fitted by fit_materials, in Python resilin.fit");
}

RelaxationDescription of_relaxation(AnyFit fit) {
  if (auto* relaxation = std::get_if<RelaxationDescription>(&fit)) return std::move(*relaxation);
  const auto* tests = std::get_if<FitDescription>(&fit);
  throw InputError(tests ? tests->place : std::get<SceneFitDescription>(fit).place, "[relaxation]",
                   tests ? "[[test]]" : "[[experiment]]");
}

}  // namespace

RelaxationDescription read_relaxation(const std::filesystem::path& path,
                                      const std::vector<std::string>& overrides) {
  return of_relaxation(read_any_fit(path, overrides));
}

RelaxationDescription read_relaxation_from_values(SceneValue values, const std::string& name,
                                                  const std::filesystem::path& folder,
                                                  const std::vector<std::string>& overrides) {
  return of_relaxation(read_any_fit_from_values(std::move(values), name, folder, overrides));
}

FitDescription read_fit_from_values(SceneValue values, const std::string& name,
                                    const std::filesystem::path& folder,
                                    const std::vector<std::string>& overrides) {
  return of_tests(read_any_fit_from_values(std::move(values), name, folder, overrides));
}

SceneFitDescription read_scene_fit_from_values(SceneValue values, const std::string& name,
                                               const std::filesystem::path& folder,
                                               const std::vector<std::string>& overrides) {
  return of_scenes(read_any_fit_from_values(std::move(values), name, folder, overrides));
}

AnyFit read_any_fit(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  return read_any_fit_from_values(parse_toml(read_file(path), path.string()), path.string(),
                                  path.parent_path(), overrides);
}

FitDescription read_fit(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  return of_tests(read_any_fit(path, overrides));
}

SceneFitDescription read_scene_fit(const std::filesystem::path& path,
                                   const std::vector<std::string>& overrides) {
  return of_scenes(read_any_fit(path, overrides));
}

std::string fit_reference() {
  std::string page = R"(# The file of a fit

A fit is a TOML file of tests, of experiments that are whole scenes, or of a relaxation, read by `resilin fit` ([fit.md](fit.md)); `title` stands above its
results. Paths in it are beside the file; constants are in SI. A key that is not listed here is an error that names the nearest known one. Any value can
be set from the command line: `--set fit.residual=relative`.
This page is printed by `resilin fit --reference` from the table that reads the file.
)";
  for (const TableDoc& table :
       {material_test_doc(), document("[fit]", "Settings of the fit to tests.", fit_keys()),
        document("fit.parameters", "Settings of a constant, in the units of its law.",
                 constant_setting_keys())})
    page += reference_text(table);
  page += reference_text(relaxation_doc());
  for (const TableDoc& table : scene_fit_docs()) page += reference_text(table);
  return page;
}

}  // namespace resilin
