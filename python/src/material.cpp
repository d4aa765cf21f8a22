#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

#include "bindings.hpp"
#include "resilin/material/law.hpp"

namespace resilin::python {

void bind_material(nanobind::module_& module) {
  module.def("law_names", [] {
    std::vector<std::string> names;
    for (const LawInfo* law : laws()) names.emplace_back(law->name);
    return names;
  });
}

}  // namespace resilin::python
