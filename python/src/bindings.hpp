#pragma once

#include <nanobind/nanobind.h>

/// One function for each module of the package. Bindings are thin: arrays in, arrays out; defaults,
/// conversions and help stand in the Python layer.
namespace resilin::python {

void bind_material(nanobind::module_& module);

}  // namespace resilin::python
