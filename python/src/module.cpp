#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>

#include "bindings.hpp"
#include "resilin/core/cpu.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/thread_count.hpp"
#include "resilin/linear/blas.hpp"
#include "resilin/results/build_info.hpp"

namespace nb = nanobind;

NB_MODULE(_core, module) {
  using namespace resilin;
  nb::set_leak_warnings(false);  // torch keeps what its graphs refer to until the interpreter has ended
  const nb::exception<InputError> input_error(module, "InputError", PyExc_ValueError);
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const std::bad_alloc& error) {
      PyErr_SetString(PyExc_MemoryError, out_of_memory_text(error).c_str());
    }
  });
  module.def(
      "input_error_text",
      [](const std::string& place, const std::string& expected, const std::string& got,
         const std::string& cure) { return std::string(InputError(place, expected, got, cure).what()); },
      nb::arg("place"), nb::arg("expected"), nb::arg("got"), nb::arg("cure"));
  module.def("version", [] { return std::string(version()); });
  module.def("max_threads", [] { return max_threads; });
  module.def("num_threads", &num_threads);
  module.def("set_num_threads", &set_num_threads, nb::arg("count"));
  module.def("available_instruction_sets", [] { return names(available_instruction_sets()); });
  module.def("choose_blas_kernel", &choose_blas_kernel);
  module.def("blas_kernel_name", &blas_kernel_name);
  python::bind_material(module);
  python::bind_batch_law(module);
  python::bind_curve(module);
  python::bind_fit(module);
  python::bind_mesh(module);
  python::bind_elastic(module);
  python::bind_picture(module);
  python::bind_simulation(module);
  python::bind_derivatives(module);
  python::bind_derivatives_batch(module);
  python::bind_sweep(module);
}
