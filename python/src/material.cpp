#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/projection.hpp"
#include "resilin/material/law.hpp"

namespace resilin::python {
namespace {

using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using NumbersOut = nb::ndarray<double, nb::c_contig, nb::device::cpu>;

void require(bool is_so, const char* what) {
  if (!is_so) throw std::invalid_argument(what);
}

double number_at(const Numbers& numbers, std::size_t i) {
  return numbers.data()[numbers.ndim() == 0 ? 0 : i];
}

void require_count(const Numbers& numbers, std::size_t count) {
  require(numbers.ndim() == 0 || numbers.size() == count, "one value of each constant for every state");
}

/// Own constants of a law for `count` states, (number of constants, count),
/// from what the user gave: numbers, or one for every state. A refusal names
/// the law and, where values differ, the first state that is wrong.
void resolve_constants(const std::string& name, const std::map<std::string, Numbers>& given,
                       const NumbersOut& constants) {
  const LawInfo& law = require_law(name, "law");
  require(constants.ndim() == 2 && constants.shape(0) == law.constants.size(), "one row for each constant");
  const std::size_t count = constants.shape(1), num_constants = law.constants.size();
  std::map<std::string, Column> columns;
  for (const auto& [constant, numbers] : given) {
    require_count(numbers, count);
    columns[constant] = {numbers.data(), numbers.ndim() == 0 ? 0u : 1u};
  }
  const auto name_of = [count](std::size_t i) {
    return count == 1 ? std::string() : std::string("[").append(std::to_string(i)).append("]");
  };
  std::vector<double> own;
  {
    const nb::gil_scoped_release others_run;
    own = resilin::resolve_constants(law, columns, count, name, name_of);
  }
  for (std::size_t i = 0; i < own.size(); ++i)
    constants.data()[i % num_constants * count + i / num_constants] = own[i];
}

/// Own constants, (number of constants, count), of the small-strain solid of
/// these constants [Pa] beside the law's free constants, in their order.
/// Nothing is checked.
void convert_constants(const LawInfo& law, double mu, double lambda, const std::vector<Numbers>& free,
                       const NumbersOut& constants) {
  require(constants.ndim() == 2 && constants.shape(0) == law.constants.size(), "one row for each constant");
  const std::size_t count = constants.shape(1);
  for (const Numbers& numbers : free) require_count(numbers, count);
  std::vector<double> values(free.size());
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < free.size(); ++k) values[k] = number_at(free[k], i);
    const std::vector<double> own = law.convert({mu, lambda}, values);
    for (std::size_t k = 0; k < own.size(); ++k) constants.data()[k * count + i] = own[k];
  }
}

/// Number, or none for anything that is not a number.
std::optional<double> number_or_none(double value) {
  return std::isnan(value) ? std::nullopt : std::optional<double>(value);
}

void bind_law_info(nb::module_& module) {
  nb::class_<ConstantText>(module, "LawConstant")
      .def_ro("name", &ConstantText::name)
      .def_ro("unit", &ConstantText::unit)
      .def_ro("meaning", &ConstantText::meaning)
      .def_prop_ro("range", &range_text)
      .def_ro("is_free", &ConstantText::is_free)
      .def_prop_ro("fallback", [](const ConstantText& constant) { return number_or_none(constant.fallback); })
      .def("__repr__", [](const ConstantText& constant) {
        std::string text("LawConstant(");
        text.append(constant.name).append(" = ").append(constant.meaning);
        return text.append(" [").append(constant.unit).append("])");
      });
  nb::class_<LawInfo>(module, "LawInfo")
      .def_ro("name", &LawInfo::name)
      .def_ro("title", &LawInfo::title)
      .def_ro("formula", &LawInfo::formula)
      .def_ro("source", &LawInfo::source)
      .def_ro("inversion", &LawInfo::inversion)
      .def_ro("needs_positive_J", &LawInfo::needs_positive_J)
      .def_ro("max_fibres", &LawInfo::max_fibres)
      .def_prop_ro("only_poissons_ratio",
                   [](const LawInfo& law) { return number_or_none(law.only_poissons_ratio); })
      .def_prop_ro("is_small_strain", [](const LawInfo& law) { return law.kind == LawKind::small_strain; })
      .def_prop_ro("constants",
                   [](const LawInfo& law) {
                     return std::vector<ConstantText>(law.constants.begin(), law.constants.end());
                   })
      .def("__repr__", [](const LawInfo& law) {
        return std::string("LawInfo(").append(law.name).append(": Psi = ").append(law.formula).append(")");
      });
  module.def("laws", &laws, nb::rv_policy::reference);
  module.def("require_law", &require_law, nb::rv_policy::reference);
}

}  // namespace

void bind_material(nb::module_& module) {
  bind_law_info(module);
  module.def("resolve_constants", &resolve_constants);
  module.def("convert_constants", &convert_constants);
  nb::enum_<Projection>(module, "Projection")
      .value("none", Projection::none)
      .value("clamp", Projection::clamp)
      .value("absolute", Projection::absolute);
}

}  // namespace resilin::python
