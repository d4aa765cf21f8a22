#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

#include "bindings.hpp"
#include "resilin/fit/fit_file.hpp"
#include "resilin/fit/fit_output.hpp"
#include "scene_value.hpp"

namespace resilin::python {
namespace {

/// What `resilin fit` writes, as texts.
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

}  // namespace

void bind_fit(nb::module_& module) {
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
}

}  // namespace resilin::python
