#include "bindings.hpp"

NB_MODULE(_core, module) {
  module.attr("__version__") = RESILIN_VERSION;
  resilin::python::bind_material(module);
}
