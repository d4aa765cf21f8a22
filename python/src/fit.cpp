#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <exception>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "interruptible.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/fit/fit_output.hpp"
#include "resilin/fit/scene_fit.hpp"
#include "scene_value.hpp"

namespace resilin::python {
namespace {

/// Output of `resilin fit`, as texts.
nb::typed<nb::dict, nb::str, nb::str> fit(const FitDescription& description) {
  std::string json, text, material, page;
  {
    const nb::gil_scoped_release others_run;
    const FitReport report = fit_materials(description);
    json = fit_json_text(report);
    text = fit_text(report);
    material = material_toml(report);
    page = fit_page(report);
  }
  nb::dict result;
  result["json"] = json;
  result["text"] = text;
  result["material"] = material;
  result["page"] = page;
  return result;
}

/// Result of a fit of scenes, as texts and as `report`; `on_solve`, or None, is told a line for each solve.
nb::typed<nb::dict, nb::str, nb::any> fit_experiments(const SceneFitDescription& description,
                                                      const nb::object& on_solve) {
  SceneFitReport report;
  std::string json, text, material;
  Interruptible interruptible;
  std::exception_ptr failure;
  {
    const nb::gil_scoped_release others_run;
    try {
      report = fit_scenes(description, {.on_solve =
                                            [&](const SceneFitStep& step) {
                                              if (!on_solve.is_none())
                                                interruptible.call(on_solve, scene_fit_step_text(step));
                                            },
                                        .goes_on = [&] { return !interruptible.is_stopped(); }});
      json = scene_fit_json_text(report);
      text = scene_fit_text(report);
      material = scene_material_toml(report);
    } catch (...) {
      failure = std::current_exception();
    }
  }
  interruptible.rethrow();
  if (failure) std::rethrow_exception(failure);
  nb::dict result;
  result["json"] = json;
  result["text"] = text;
  result["material"] = material;
  result["report"] = nb::cast(std::move(report));
  return result;
}

/// Prony series of a relaxation, as texts.
nb::typed<nb::dict, nb::str, nb::str> fit_prony(const RelaxationDescription& description) {
  const RelaxationFit found = fit_relaxation(description);
  nb::dict result;
  result["json"] = relaxation_json_text(found);
  result["text"] = relaxation_text(found);
  result["material"] = relaxation_toml(found);
  result["page"] = relaxation_page(found);
  return result;
}

}  // namespace

void bind_fit(nb::module_& module) {
  nb::class_<SceneFitReport>(module, "SceneFitReport")
      .def(
          "save",
          [](const SceneFitReport& report, const std::string& folder) { write_scene_fit(report, folder); },
          nb::arg("folder"));
  module.def(
      "fit_file",
      [](const std::string& path, const std::vector<std::string>& overrides) {
        return fit(read_fit(path, overrides));
      },
      nb::arg("path"), nb::arg("overrides"));
  module.def(
      "fit_values",
      [](nb::handle values, const std::vector<std::string>& overrides) {
        return fit(read_fit_from_values(scene_value(values), "data", "", overrides));
      },
      nb::arg("values"), nb::arg("overrides"));
  module.def(
      "fit_relaxation_file",
      [](const std::string& path, const std::vector<std::string>& overrides) {
        return fit_prony(read_relaxation(path, overrides));
      },
      nb::arg("path"), nb::arg("overrides"));
  module.def(
      "fit_relaxation_values",
      [](nb::handle values, const std::vector<std::string>& overrides) {
        return fit_prony(read_relaxation_from_values(scene_value(values), "data", "", overrides));
      },
      nb::arg("values"), nb::arg("overrides"));
  module.def(
      "fit_scenes_file",
      [](const std::string& path, const std::vector<std::string>& overrides, const nb::object& on_solve) {
        return fit_experiments(read_scene_fit(path, overrides), on_solve);
      },
      nb::arg("path"), nb::arg("overrides"), nb::arg("on_solve").none());
  module.def(
      "fit_scenes_values",
      [](nb::handle values, const std::vector<std::string>& overrides, const nb::object& on_solve) {
        return fit_experiments(read_scene_fit_from_values(scene_value(values), "data", "", overrides),
                               on_solve);
      },
      nb::arg("values"), nb::arg("overrides"), nb::arg("on_solve").none());
}

}  // namespace resilin::python
