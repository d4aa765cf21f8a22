#pragma once

#include <chrono>
#include <optional>
#include <utility>

#include "bindings.hpp"

namespace resilin::python {

/// Lets Ctrl-C, and exceptions of Python functions, end a long computation that runs without the GIL.
class Interruptible {
 public:
  /// True from the first signal or exception on. To be called without the GIL, as often as one likes.
  bool is_stopped();

  /// Calls a Python function; its exception stops the computation.
  template <class... Arguments>
  void call(const nb::object& function, const Arguments&... arguments) {
    const nb::gil_scoped_acquire acquire;
    try {
      function(arguments...);
    } catch (nb::python_error& error) {
      error_.emplace(std::move(error));
    }
  }

  /// Raises what stopped the computation, if anything did. To be called with the GIL.
  void rethrow();

 private:
  std::optional<nb::python_error> error_;
  std::chrono::steady_clock::time_point next_look_;
};

}  // namespace resilin::python
