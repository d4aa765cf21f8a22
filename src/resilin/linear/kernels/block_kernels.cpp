// The inner loops of this module, compiled once for each instruction set (cmake/ResilinKernels.cmake):
// nothing of the standard library or of Eigen may come in here, whose inline functions the linker would share
// with the rest of the program.
#include "resilin/linear/kernels/block_kernels.hpp"

namespace resilin::detail {
namespace {

using Index = KernelIndex;
using Offset = KernelOffset;

template <class Real, int lanes>
struct Lanes {
  typedef Real type __attribute__((vector_size(sizeof(Real) * lanes)));
  typedef Real loadable __attribute__((vector_size(sizeof(Real) * lanes), aligned(sizeof(Real)), may_alias));
};

/// Registers that hold one row of a block: 4 lanes in 3D, the last without meaning; 2 in 2D.
template <class Real, int dim>
using Row = typename Lanes<Real, dim == 3 ? 4 : 2>::type;
template <class Real, int dim>
using LoadableRow = typename Lanes<Real, dim == 3 ? 4 : 2>::loadable;

#define RESILIN_INLINE inline __attribute__((always_inline))

/// Reads one number beyond the row in 3D.
template <int dim, class Real>
RESILIN_INLINE Row<Real, dim> load_row(const Real* from) {
  return *reinterpret_cast<const LoadableRow<Real, dim>*>(from);
}

/// Reads exactly dim numbers.
template <int dim, class Real>
RESILIN_INLINE Row<Real, dim> load_exactly(const Real* from) {
  if constexpr (dim == 3) {
    return Row<Real, 3>{from[0], from[1], from[2], Real(0)};
  } else {
    return load_row<2>(from);
  }
}

template <int dim, class Real>
RESILIN_INLINE void add_to(Real* to, Row<Real, dim> value) {
  for (int d = 0; d < dim; ++d) to[d] += value[d];
}

template <int dim, class Real>
RESILIN_INLINE Real sum_of(Row<Real, dim> value) {
  Real sum = value[0] + value[1];
  if constexpr (dim == 3) sum += value[2];
  return sum;
}

template <int dim>
void multiply_rows(const Offset* row_begin, const Index* columns, const Index* targets, const double* values,
                   const double* x, double* y, Index first, Index last) {
  constexpr int size = dim * dim;
  for (Index i = first; i < last; ++i) {
    const double* x_i = x + Offset(i) * dim;
    Row<double, dim> sum[dim];
    const Row<double, dim> own = load_exactly<dim>(x_i);
    const double* diagonal = values + row_begin[i] * size;
    for (int r = 0; r < dim; ++r) sum[r] = load_exactly<dim>(diagonal + r * dim) * own;
    for (Offset s = row_begin[i] + 1; s < row_begin[i + 1]; ++s) {
      const Row<double, dim> other = load_exactly<dim>(x + Offset(columns[s]) * dim);
      const double* block = values + s * size;
      Row<double, dim> transposed{};
      for (int r = 0; r < dim; ++r) {  // the row after the last one begins the next slot: there is always one
        const Row<double, dim> row = load_row<dim>(block + r * dim);
        sum[r] += row * other;
        transposed += row * x_i[r];
      }
      add_to<dim>(y + Offset(targets[s]) * dim, transposed);
    }
    for (int r = 0; r < dim; ++r) y[Offset(i) * dim + r] += sum_of<dim, double>(sum[r]);
  }
}

/// Rows of `upper` and `inverse_diagonal` are packed; both arrays are padded by one number in 3D.
template <int dim>
void solve_lower(const Offset* row_begin, const Index* columns, const float* upper, float* z, Index first,
                 Index last) {
  constexpr int size = dim * dim;
  for (Index i = first; i < last; ++i) {  // z_j -= W_ij^T z_i
    float z_i[dim];
    for (int r = 0; r < dim; ++r) z_i[r] = z[Offset(i) * dim + r];
    for (Offset s = row_begin[i]; s < row_begin[i + 1]; ++s) {
      Row<float, dim> transposed{};
      for (int r = 0; r < dim; ++r) transposed -= load_row<dim>(upper + s * size + r * dim) * z_i[r];
      add_to<dim>(z + Offset(columns[s]) * dim, transposed);
    }
  }
}

template <int dim>
void solve_upper(const Offset* row_begin, const Index* columns, const float* upper,
                 const float* inverse_diagonal, float* z, Index first, Index last) {
  constexpr int size = dim * dim;
  for (Index i = last - 1; i >= first; --i) {  // z_i = D_i^-1 z_i - sum W_ij z_j
    Row<float, dim> sum[dim];
    const Row<float, dim> own = load_exactly<dim>(z + Offset(i) * dim);
    for (int r = 0; r < dim; ++r) sum[r] = load_row<dim>(inverse_diagonal + Offset(i) * size + r * dim) * own;
    for (Offset s = row_begin[i]; s < row_begin[i + 1]; ++s) {
      const Row<float, dim> other = load_exactly<dim>(z + Offset(columns[s]) * dim);
      for (int r = 0; r < dim; ++r) sum[r] -= load_row<dim>(upper + s * size + r * dim) * other;
    }
    for (int r = 0; r < dim; ++r) z[Offset(i) * dim + r] = sum_of<dim, float>(sum[r]);
  }
}

template <int dim>
void eliminate_row(double* work, Offset row_begin, Offset row_end, const Index* slot_of_pair,
                   const double* inverse_diagonal) {
  constexpr int lanes = dim == 3 ? 4 : 2;
  constexpr int size = dim * lanes;
  const auto row_of = [work](Offset slot, int r) {
    return reinterpret_cast<LoadableRow<double, dim>*>(work + slot * size + r * lanes);
  };
  for (Offset k = row_begin; k < row_end; ++k) {
    Row<double, dim> scaled[dim];  // W_rk
    for (int r = 0; r < dim; ++r) {
      scaled[r] = Row<double, dim>{};
      for (int c = 0; c < dim; ++c) scaled[r] += inverse_diagonal[r * dim + c] * *row_of(k, c);
    }
    const Index* slot = slot_of_pair + (k - row_begin);
    for (Offset j = row_begin; j <= k; ++j) {
      const Offset target = *slot;
      slot += row_end - j - 1;
      if (target < 0) continue;
      for (int r = 0; r < dim; ++r) {
        Row<double, dim> row = *row_of(target, r);
        for (int c = 0; c < dim; ++c) row -= work[j * size + c * lanes + r] * scaled[c];
        *row_of(target, r) = row;
      }
    }
  }
  for (Offset k = row_begin; k < row_end; ++k) {
    Row<double, dim> scaled[dim];
    for (int r = 0; r < dim; ++r) {
      scaled[r] = Row<double, dim>{};
      for (int c = 0; c < dim; ++c) scaled[r] += inverse_diagonal[r * dim + c] * *row_of(k, c);
    }
    for (int r = 0; r < dim; ++r) *row_of(k, r) = scaled[r];
  }
}

double dot(const double* a, const double* b, Offset size) {
  typedef Lanes<double, 8> L;
  typename L::type sum0{}, sum1{};
  Offset k = 0;
  for (; k + 16 <= size; k += 16) {
    sum0 += *reinterpret_cast<const L::loadable*>(a + k) * *reinterpret_cast<const L::loadable*>(b + k);
    sum1 +=
        *reinterpret_cast<const L::loadable*>(a + k + 8) * *reinterpret_cast<const L::loadable*>(b + k + 8);
  }
  sum0 += sum1;
  double rest = 0;
  for (; k < size; ++k) rest += a[k] * b[k];
  for (int lane = 0; lane < 8; ++lane) rest += sum0[lane];
  return rest;
}

void axpy(double factor, const double* x, double* y, Offset size) {
  for (Offset k = 0; k < size; ++k) y[k] += factor * x[k];
}

void xpby(const double* x, double factor, double* y, Offset size) {
  for (Offset k = 0; k < size; ++k) y[k] = x[k] + factor * y[k];
}

constexpr BlockKernels kernels = {
    {multiply_rows<2>, multiply_rows<3>},
    {solve_lower<2>, solve_lower<3>},
    {solve_upper<2>, solve_upper<3>},
    {eliminate_row<2>, eliminate_row<3>},
    dot,
    axpy,
    xpby,
};

}  // namespace

template <InstructionSet>
const BlockKernels& compiled_block_kernels() {
  return kernels;
}
template const BlockKernels& compiled_block_kernels<InstructionSet::RESILIN_SIMD_NAMESPACE>();

}  // namespace resilin::detail
