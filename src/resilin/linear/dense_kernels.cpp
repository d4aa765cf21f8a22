#include "resilin/linear/dense_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "resilin/core/parallel.hpp"

extern "C" {
void dpotrf_(const char*, const int*, double*, const int*, int*);
void dtrsm_(const char*, const char*, const char*, const char*, const int*, const int*, const double*,
            const double*, const int*, double*, const int*);
void dsyrk_(const char*, const char*, const int*, const int*, const double*, const double*, const int*,
            const double*, double*, const int*);
void dgemm_(const char*, const char*, const int*, const int*, const int*, const double*, const double*,
            const int*, const double*, const int*, const double*, double*, const int*);
void dtrsv_(const char*, const char*, const char*, const int*, const double*, const int*, double*,
            const int*);
void dgemv_(const char*, const int*, const int*, const double*, const double*, const int*, const double*,
            const int*, const double*, double*, const int*);
}

namespace resilin::detail {
namespace {

constexpr double one = 1, minus_one = -1, zero = 0;
constexpr int step = 1;
/// Large fronts are cut into pieces of this size, whatever the number of threads.
constexpr int piece = 384;
/// Columns that the factorisation of an indefinite front takes at a time.
constexpr int block = 48;

/// L S L^T of a small dense block, lower triangle; the first column without a pivot, or -1.
int signed_cholesky_block(int size, double* A, int stride, double smallest_pivot, double* signs) {
  const auto at = [=](int i, int j) -> double& { return A[static_cast<Offset>(j) * stride + i]; };
  for (int j = 0; j < size; ++j) {
    const double pivot = at(j, j);
    if (!(std::abs(pivot) > smallest_pivot)) return j;
    signs[j] = pivot > 0 ? 1 : -1;
    at(j, j) = std::sqrt(std::abs(pivot));
    for (int i = j + 1; i < size; ++i) at(i, j) *= signs[j] / at(j, j);
    for (int k = j + 1; k < size; ++k) {
      const double factor = signs[j] * at(k, j);
      for (int i = k; i < size; ++i) at(i, k) -= factor * at(i, j);
    }
  }
  return -1;
}

/// rows S, as a matrix of its own.
std::vector<double> times_signs(int num_rows, int num_columns, const double* rows, int stride,
                                const double* signs) {
  std::vector<double> product(static_cast<std::size_t>(num_rows) * static_cast<std::size_t>(num_columns));
  for (int j = 0; j < num_columns; ++j)
    for (int i = 0; i < num_rows; ++i)
      product[static_cast<std::size_t>(static_cast<Offset>(j) * num_rows + i)] =
          signs[j] * rows[static_cast<Offset>(j) * stride + i];
  return product;
}

}  // namespace

int cholesky_panel(int num_columns, int num_rows, double* panel, int stride) {
  int info = 0;
  dpotrf_("L", &num_columns, panel, &stride, &info);
  if (info > 0) return info - 1;
  if (num_rows == 0) return -1;
  const int num_pieces = (num_rows + piece - 1) / piece;
  parallel_tasks(static_cast<std::size_t>(num_pieces), [&](std::size_t k) {
    const int first = static_cast<int>(k) * piece, rows = std::min(piece, num_rows - first);
    dtrsm_("R", "L", "T", "N", &rows, &num_columns, &one, panel, &stride, panel + num_columns + first,
           &stride);
  });
  return -1;
}

int signed_cholesky_panel(int num_columns, int num_rows, double* panel, int stride, double smallest_pivot,
                          double* signs) {
  // Few fronts hold a negative pivot: the others go the quick way.
  std::vector<double> diagonal(static_cast<std::size_t>(num_columns) * static_cast<std::size_t>(num_columns));
  for (int j = 0; j < num_columns; ++j)
    std::copy_n(panel + static_cast<Offset>(j) * stride, num_columns,
                diagonal.data() + static_cast<Offset>(j) * num_columns);
  std::fill(signs, signs + num_columns, 1.0);
  if (cholesky_panel(num_columns, num_rows, panel, stride) < 0) return -1;
  for (int j = 0; j < num_columns; ++j)
    std::copy_n(diagonal.data() + static_cast<Offset>(j) * num_columns, num_columns,
                panel + static_cast<Offset>(j) * stride);

  const int height = num_columns + num_rows;
  for (int first = 0; first < num_columns; first += block) {
    const int width = std::min(block, num_columns - first), end = first + width, below = height - end;
    double* corner = panel + static_cast<Offset>(first) * stride + first;
    const int failed = signed_cholesky_block(width, corner, stride, smallest_pivot, signs + first);
    if (failed >= 0) return first + failed;
    if (below == 0) break;
    double* lower = corner + width;
    dtrsm_("R", "L", "T", "N", &below, &width, &one, corner, &stride, lower, &stride);
    // `lower` is L21 S by now.
    const std::vector<double> factor = times_signs(below, width, lower, stride, signs + first);
    for (int column = end; column < num_columns; column += block) {
      const int columns = std::min(block, num_columns - column), rows = height - column;
      dgemm_("N", "T", &rows, &columns, &width, &minus_one, lower + (column - end), &stride,
             factor.data() + (column - end), &below, &one,
             panel + static_cast<Offset>(column) * stride + column, &stride);
    }
    for (int j = 0; j < width; ++j)
      std::copy_n(factor.data() + static_cast<Offset>(j) * below, below,
                  lower + static_cast<Offset>(j) * stride);
  }
  return -1;
}

void outer_product(int num_rows, int num_columns, const double* rows, int stride, double* update) {
  const int num_pieces = (num_rows + piece - 1) / piece;
  parallel_tasks(static_cast<std::size_t>(num_pieces), [&](std::size_t k) {
    const int first = static_cast<int>(k) * piece, width = std::min(piece, num_rows - first);
    const int below = num_rows - first - width;
    double* diagonal = update + static_cast<Offset>(first) * num_rows + first;
    dsyrk_("L", "N", &width, &num_columns, &minus_one, rows + first, &stride, &zero, diagonal, &num_rows);
    if (below > 0)
      dgemm_("N", "T", &below, &width, &num_columns, &minus_one, rows + first + width, &stride, rows + first,
             &stride, &zero, diagonal + width, &num_rows);
  });
}

void signed_outer_product(int num_rows, int num_columns, const double* rows, int stride, const double* signs,
                          double* update) {
  if (std::all_of(signs, signs + num_columns, [](double sign) { return sign > 0; }))
    return outer_product(num_rows, num_columns, rows, stride, update);
  const std::vector<double> signed_rows = times_signs(num_rows, num_columns, rows, stride, signs);
  const int num_pieces = (num_rows + piece - 1) / piece;
  parallel_tasks(static_cast<std::size_t>(num_pieces), [&](std::size_t k) {
    const int first = static_cast<int>(k) * piece, width = std::min(piece, num_rows - first);
    const int height = num_rows - first;
    dgemm_("N", "T", &height, &width, &num_columns, &minus_one, signed_rows.data() + first, &num_rows,
           rows + first, &stride, &zero, update + static_cast<Offset>(first) * num_rows + first, &num_rows);
  });
}

void solve_panel(int num_columns, int num_rows, const double* panel, double* x, double* work) {
  const int stride = num_columns + num_rows;
  dtrsv_("L", "N", "N", &num_columns, panel, &stride, x, &step);
  if (num_rows > 0)
    dgemv_("N", &num_rows, &num_columns, &minus_one, panel + num_columns, &stride, x, &step, &one, work,
           &step);
}

void solve_panel_transposed(int num_columns, int num_rows, const double* panel, double* x,
                            const double* work) {
  const int stride = num_columns + num_rows;
  if (num_rows > 0)
    dgemv_("T", &num_rows, &num_columns, &minus_one, panel + num_columns, &stride, work, &step, &one, x,
           &step);
  dtrsv_("L", "T", "N", &num_columns, panel, &stride, x, &step);
}

}  // namespace resilin::detail
