#include "interruptible.hpp"

#include <utility>

namespace resilin::python {
namespace {

constexpr auto between_looks = std::chrono::milliseconds(20);  // taking the GIL may wait for another thread

}  // namespace

bool Interruptible::is_stopped() {
  const auto now = std::chrono::steady_clock::now();
  if (error_ || now < next_look_) return error_.has_value();
  next_look_ = now + between_looks;
  const nb::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals() != 0) error_.emplace();  // takes over the exception that is set
  return error_.has_value();
}

void Interruptible::rethrow() {
  if (error_) throw nb::python_error(std::move(*error_));
}

}  // namespace resilin::python
