#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

#include "resilin/core/types.hpp"

/// One function for each module of the package. Bindings are thin: arrays in, arrays out; defaults,
/// conversions and help stand in the Python layer.
namespace resilin::python {

namespace nb = nanobind;

void bind_material(nb::module_& module);
void bind_batch_law(nb::module_& module);
void bind_curve(nb::module_& module);
void bind_fit(nb::module_& module);
void bind_mesh(nb::module_& module);
void bind_elastic(nb::module_& module);
void bind_picture(nb::module_& module);
void bind_simulation(nb::module_& module);
void bind_derivatives(nb::module_& module);
void bind_derivatives_batch(nb::module_& module);
void bind_sweep(nb::module_& module);

// C-contiguous arrays: the Python layer has seen to that.
template <class T>
using Vector1d = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <class T>
using Array2d = nb::ndarray<const T, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
template <class T>
using NumpyArray = nb::ndarray<nb::numpy, T>;

/// A numpy array of this shape that owns `values`.
template <class T>
NumpyArray<T> numpy_array(std::vector<T> values, std::initializer_list<std::size_t> shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  T* const data = kept->data();
  nb::capsule owner(kept.release(), [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return NumpyArray<T>(data, shape, owner);
}

/// Unknowns of an array (N, dim), node by node.
inline VectorX unknowns(const Array2d<double>& array) {
  return Eigen::Map<const VectorX>(array.data(), static_cast<Eigen::Index>(array.size()));
}

/// Rows (N, 3) as vectors.
inline std::vector<Vector3> vectors(const Array2d<double>& rows) {
  std::vector<Vector3> vectors(rows.shape(0));
  for (std::size_t i = 0; i < vectors.size(); ++i)
    vectors[i] = Eigen::Map<const Vector3>(rows.data() + 3 * i);
  return vectors;
}

/// An array (N, dim) of unknowns.
inline NumpyArray<double> node_array(const VectorX& unknowns, int dim) {
  const auto columns = static_cast<std::size_t>(dim);
  return numpy_array(std::vector<double>(unknowns.begin(), unknowns.end()),
                     {static_cast<std::size_t>(unknowns.size()) / columns, columns});
}

}  // namespace resilin::python
