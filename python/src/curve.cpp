#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "resilin/material/curve.hpp"

namespace resilin::python {
namespace {

void set_fibres(Material& material, const Array2d<double>& fibres) {
  for (std::size_t i = 0; i < fibres.shape(0); ++i)
    material.fibres.emplace_back(fibres(i, 0), fibres(i, 1), fibres(i, 2));
}

nb::list limits(const StretchCurve& curve) {
  nb::list all;
  for (const StabilityLimit& limit : curve.limits) {
    nb::dict entry;
    entry["loss"] = std::string(name(limit.loss));
    entry["side"] = limit.above ? "above" : "below";
    entry["stretch"] = limit.stretch;
    entry["volume_ratio"] = limit.volume_ratio;
    all.append(entry);
  }
  return all;
}

/// Everything that the Python layer shows of a curve.
/// @param fibres  (families, 3), unit vectors; no row for an isotropic law
nb::typed<nb::dict, nb::str, nb::any> stretch_curve(const std::string& law, std::vector<double> constants,
                                                    const Array2d<double>& fibres,
                                                    const std::string& load_case,
                                                    const Vector1d<double>& stretches) {
  Material material{};
  material.law = &require_law(law, "law");
  material.constants = std::move(constants);
  set_fibres(material, fibres);
  const StretchCurve curve = [&] {
    const LoadCase chosen = require_load_case(load_case, "kind");
    const nb::gil_scoped_release others_run;
    return resilin::stretch_curve(material, chosen, {stretches.data(), stretches.size()});
  }();
  const std::size_t count = curve.stretch.size();
  std::vector<double> diagonals;
  nb::list stability;
  for (std::size_t i = 0; i < count; ++i) {
    diagonals.insert(diagonals.end(), curve.stretches[i].begin(), curve.stretches[i].end());
    stability.append(std::string(name(curve.stability[i])));
  }
  nb::dict result;
  result["stretch"] = numpy_array(curve.stretch, {count});
  result["nominal_stress"] = numpy_array(curve.nominal_stress, {count});
  result["cauchy_stress"] = numpy_array(curve.cauchy_stress, {count});
  result["volume_ratio"] = numpy_array(curve.volume_ratio, {count});
  result["energy_density"] = numpy_array(curve.energy_density, {count});
  result["stretches"] = numpy_array(std::move(diagonals), {count, 3});
  result["stability"] = stability;
  result["limits"] = limits(curve);
  result["stability_text"] = stability_text(material, curve);
  result["csv"] = curve_csv(curve);
  return result;
}

}  // namespace

void bind_curve(nb::module_& module) {
  module.def("stretch_curve", &stretch_curve, nb::arg("law"), nb::arg("constants"), nb::arg("fibres"),
             nb::arg("kind"), nb::arg("stretches"));
  module.def(
      "usual_range",
      [](const std::string& load_case) {
        const LoadRange range = usual_range(require_load_case(load_case, "kind"));
        return std::pair(range.from, range.to);
      },
      nb::arg("kind"));
}

}  // namespace resilin::python
