#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

/// Arrays of a few numbers, for which the way into the core costs more than the work: read and made by
/// Python's own means, at a fifth of what nb::ndarray takes.
namespace resilin::python {

namespace nb = nanobind;

/// Handles of numpy that are used again and again; kept until the process ends.
struct Numpy {
  nb::object array_type = nb::module_::import_("numpy").attr("ndarray");
  nb::object empty = nb::module_::import_("numpy").attr("empty");
  nb::object float64 = nb::module_::import_("numpy").attr("float64");
  nb::object float32 = nb::module_::import_("numpy").attr("float32");
  nb::object dtype64 = nb::module_::import_("numpy").attr("dtype")(float64);
  nb::object dtype32 = nb::module_::import_("numpy").attr("dtype")(float32);

  template <class Real>
  nb::handle scalar() const {
    return std::is_same_v<Real, double> ? float64 : float32;
  }
  template <class Real>
  nb::handle dtype() const {
    return std::is_same_v<Real, double> ? dtype64 : dtype32;
  }
};
inline const Numpy& numpy() {
  static const auto* const kept = new Numpy();
  return *kept;
}

/// A C-contiguous numpy array of float64 or float32 in the order of this machine, or nothing: anything else
/// goes the long way, which converts or refuses it.
class PlainArray {
 public:
  static constexpr int max_axes = 8;

  explicit PlainArray(nb::handle array, bool is_written = false) {
    if (reinterpret_cast<PyObject*>(Py_TYPE(array.ptr())) != numpy().array_type.ptr()) return;
    const int flags = PyBUF_ND | PyBUF_FORMAT | (is_written ? PyBUF_WRITABLE : 0);
    if (PyObject_GetBuffer(array.ptr(), &view_, flags) != 0) {
      PyErr_Clear();
      return;
    }
    has_view_ = true;
    const char* const format = view_.format;
    const bool is_one_letter = format != nullptr && format[0] != '\0' && format[1] == '\0';
    const bool is_aligned = reinterpret_cast<std::uintptr_t>(view_.buf) % alignof(double) == 0;
    if (is_one_letter && is_aligned && view_.ndim <= max_axes) letter_ = format[0];
  }
  ~PlainArray() {
    if (has_view_) PyBuffer_Release(&view_);
  }
  PlainArray(const PlainArray&) = delete;
  PlainArray& operator=(const PlainArray&) = delete;

  template <class Real>
  bool holds() const {
    return letter_ == (std::is_same_v<Real, double> ? 'd' : 'f');
  }
  template <class Real>
  Real* data() const {
    return static_cast<Real*>(view_.buf);
  }
  int num_axes() const { return view_.ndim; }
  Py_ssize_t length(int axis) const { return view_.shape[axis]; }

  /// Whether it holds matrices (..., d, d) with d of 2 or 3, one at least.
  bool holds_square_matrices() const {
    if (letter_ == '\0' || num_axes() < 2) return false;
    const Py_ssize_t dim = length(num_axes() - 1);
    return dim == length(num_axes() - 2) && (dim == 2 || dim == 3) && view_.len > 0;
  }
  std::size_t dim() const { return static_cast<std::size_t>(length(num_axes() - 1)); }
  /// The first `num_axes` axes of both are of one length.
  bool begins_like(const PlainArray& other, int num_axes) const {
    for (int axis = 0; axis < num_axes; ++axis)
      if (length(axis) != other.length(axis)) return false;
    return true;
  }

 private:
  Py_buffer view_{};
  bool has_view_ = false;
  char letter_ = '\0';
};

/// Lengths of axes: some of an array, then others.
struct Shape {
  std::array<Py_ssize_t, PlainArray::max_axes + 4> lengths{};
  int num_axes = 0;

  Shape(const PlainArray& array, int leading_axes) : num_axes(leading_axes) {
    for (int axis = 0; axis < leading_axes; ++axis)
      lengths[static_cast<std::size_t>(axis)] = array.length(axis);
  }
  Shape& with(std::size_t length) {
    lengths[static_cast<std::size_t>(num_axes++)] = static_cast<Py_ssize_t>(length);
    return *this;
  }
};

/// numpy.empty(shape, dtype).
template <class Real>
nb::object new_array(const Shape& shape) {
  const nb::object axes = nb::steal(PyTuple_New(shape.num_axes));
  if (!axes.is_valid()) nb::raise_python_error();
  for (int axis = 0; axis < shape.num_axes; ++axis)
    PyTuple_SetItem(axes.ptr(), axis, PyLong_FromSsize_t(shape.lengths[static_cast<std::size_t>(axis)]));
  PyObject* const arguments[] = {axes.ptr(), numpy().dtype<Real>().ptr()};
  PyObject* const array = PyObject_Vectorcall(numpy().empty.ptr(), arguments, 2, nullptr);
  if (array == nullptr) nb::raise_python_error();
  return nb::steal(array);
}

}  // namespace resilin::python
