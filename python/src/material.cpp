#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/projection.hpp"
#include "resilin/material/law.hpp"

namespace resilin::python {
namespace {

using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using NumbersOut = nb::ndarray<double, nb::c_contig, nb::device::cpu>;

void require(bool is_so, const char* what) {
  if (!is_so) throw std::invalid_argument(what);
}

/// Own constants of a law for `count` states, (number of constants, count), from what the user gave: numbers,
/// or one for every state. A refusal names the law and, where values differ, the state.
void resolve_constants(const std::string& name, const std::map<std::string, Numbers>& given,
                       const NumbersOut& constants) {
  const LawInfo& law = require_law(name, "law");
  require(constants.ndim() == 2 && constants.shape(0) == law.constants.size(), "one row for each constant");
  const std::size_t count = constants.shape(1);
  std::map<std::string, double> values;
  for (const auto& [constant, numbers] : given)
    require(numbers.ndim() == 0 || numbers.size() == count, "one value of each constant for every state");
  for (std::size_t i = 0; i < count; ++i) {
    for (const auto& [constant, numbers] : given)
      values[constant] = numbers.data()[numbers.ndim() == 0 ? 0 : i];
    std::vector<double> own;
    try {
      own = resilin::resolve_constants(law, values, name);
    } catch (const InputError&) {
      if (count == 1) throw;
      own = resilin::resolve_constants(law, values, name + "[" + std::to_string(i) + "]");
    }
    for (std::size_t k = 0; k < own.size(); ++k) constants.data()[k * count + i] = own[k];
  }
}

void bind_law_info(nb::module_& module) {
  nb::class_<ConstantText>(module, "LawConstant")
      .def_ro("name", &ConstantText::name)
      .def_ro("unit", &ConstantText::unit)
      .def_ro("meaning", &ConstantText::meaning)
      .def_ro("above", &ConstantText::above)
      .def("__repr__", [](const ConstantText& constant) {
        return "LawConstant(" + std::string(constant.name) + " = " + std::string(constant.meaning) + " [" +
               std::string(constant.unit) + "])";
      });
  nb::class_<LawInfo>(module, "LawInfo")
      .def_ro("name", &LawInfo::name)
      .def_ro("formula", &LawInfo::formula)
      .def_ro("source", &LawInfo::source)
      .def_ro("inversion", &LawInfo::inversion)
      .def_ro("needs_positive_J", &LawInfo::needs_positive_J)
      .def_prop_ro("max_fibres", [](const LawInfo&) { return 0; })
      .def_prop_ro("is_small_strain", [](const LawInfo& law) { return law.kind == LawKind::small_strain; })
      .def_prop_ro("constants",
                   [](const LawInfo& law) {
                     return std::vector<ConstantText>(law.constants.begin(), law.constants.end());
                   })
      .def("__repr__", [](const LawInfo& law) {
        return "LawInfo(" + std::string(law.name) + ": Psi = " + std::string(law.formula) + ")";
      });
  module.def("laws", &laws, nb::rv_policy::reference);
  module.def("require_law", &require_law, nb::rv_policy::reference);
}

}  // namespace

void bind_material(nb::module_& module) {
  bind_law_info(module);
  module.def("resolve_constants", &resolve_constants);
  nb::enum_<Projection>(module, "Projection")
      .value("none", Projection::none)
      .value("clamp", Projection::clamp)
      .value("absolute", Projection::absolute);
}

}  // namespace resilin::python
