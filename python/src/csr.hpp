#pragma once

#include <tuple>
#include <vector>

#include "bindings.hpp"
#include "resilin/linear/block_matrix.hpp"

namespace resilin::python {

/// The whole symmetric matrix by rows of single unknowns, columns ascending, as scipy keeps it.
struct Csr {
  std::vector<Index> row_begin;
  std::vector<Index> columns;
  std::vector<double> values;
};

/// @throws InputError for more entries than 32-bit numbers count
Csr to_csr(const BlockMatrix& matrix);

/// (values, columns, row_begin)
using CsrArrays = std::tuple<NumpyArray<double>, NumpyArray<Index>, NumpyArray<Index>>;
CsrArrays arrays_of(Csr csr);

}  // namespace resilin::python
