#include "resilin/linear/dense_kernels.hpp"

#include <algorithm>

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

constexpr double one = 1, minus_one = -1;
constexpr int step = 1;
/// Large fronts are cut into pieces of these sizes, whatever the number of threads.
constexpr int piece_columns = 192, piece_rows = 768;
/// Columns that LAPACK factorises: its own way is slow for narrow panels. Wider ones are halved, so that most
/// of the work is products.
constexpr int narrow = 24;

}  // namespace

void subtract_products(int num_columns, int num_rows, int width, const double* rows, int stride, double beta,
                       double* target, int target_stride) {
  const auto for_rows = [&](int column, int columns, int row) {
    const int height = std::min(piece_rows, num_rows - row);
    dgemm_("N", "T", &height, &columns, &width, &minus_one, rows + row, &stride, rows + column, &stride,
           &beta, target + static_cast<Offset>(column) * target_stride + row, &target_stride);
  };
  const auto num_pieces = [](int size, int piece) {
    return static_cast<std::size_t>((size + piece - 1) / piece);
  };
  parallel_tasks(num_pieces(num_columns, piece_columns), [&](std::size_t k) {
    const int column = static_cast<int>(k) * piece_columns,
              columns = std::min(piece_columns, num_columns - column);
    dsyrk_("L", "N", &columns, &width, &minus_one, rows + column, &stride, &beta,
           target + static_cast<Offset>(column) * (target_stride + 1), &target_stride);
    const int below = column + columns;
    parallel_tasks(num_pieces(num_rows - below, piece_rows), [&](std::size_t n) {
      for_rows(column, columns, below + static_cast<int>(n) * piece_rows);
    });
  });
}

namespace {

/// For columns that stand in one block.
int cholesky_block(int num_columns, int num_rows, double* panel, int stride) {
  if (num_columns <= narrow) {
    int info = 0;
    dpotrf_("L", &num_columns, panel, &stride, &info);
    if (info > 0) return info - 1;
    if (num_rows > 0)
      dtrsm_("R", "L", "T", "N", &num_rows, &num_columns, &one, panel, &stride, panel + num_columns, &stride);
    return -1;
  }
  const int half = (num_columns / 2 + narrow - 1) / narrow * narrow, others = num_columns - half;
  const int failed = cholesky_block(half, others + num_rows, panel, stride);
  if (failed >= 0) return failed;
  double* const rest = panel + static_cast<Offset>(half) * (stride + 1);
  subtract_products(others, others + num_rows, half, panel + half, stride, one, rest, stride);
  const int failed_later = cholesky_block(others, num_rows, rest, stride);
  return failed_later < 0 ? -1 : half + failed_later;
}

}  // namespace

int cholesky_panel(int num_columns, const Trapezoid& panel) {
  const int order = panel.layout.order, block_width = panel.layout.block_width;
  for (int first = 0; first < num_columns; first += block_width) {
    const int width = std::min(block_width, num_columns - first), stride = panel.layout.stride(first);
    double* const block = panel.column(first) + first;
    const int failed_here = cholesky_block(width, order - first - width, block, stride);
    if (failed_here >= 0) return first + failed_here;
    const int left = num_columns - first - width;
    parallel_tasks(static_cast<std::size_t>((left + block_width - 1) / block_width), [&](std::size_t k) {
      const int column = first + (static_cast<int>(k) + 1) * block_width;
      subtract_products(std::min(block_width, num_columns - column), order - column, width,
                        block + (column - first), stride, one, panel.column(column) + column,
                        panel.layout.stride(column));
    });
  }
  return -1;
}

void solve_panel(int num_columns, const Trapezoid& panel, double* x, double* work) {
  const int num_rows = panel.layout.order - num_columns;
  for (int first = 0; first < num_columns; first += panel.layout.block_width) {
    const int stride = panel.layout.stride(first),
              width = std::min(panel.layout.block_width, num_columns - first);
    const int end = first + width, left = num_columns - end;
    const double* const block = panel.column(first);
    dtrsv_("L", "N", "N", &width, block + first, &stride, x + first, &step);
    if (left > 0)
      dgemv_("N", &left, &width, &minus_one, block + end, &stride, x + first, &step, &one, x + end, &step);
    if (num_rows > 0)
      dgemv_("N", &num_rows, &width, &minus_one, block + num_columns, &stride, x + first, &step, &one, work,
             &step);
  }
}

void solve_panel_transposed(int num_columns, const Trapezoid& panel, double* x, const double* work) {
  const int num_rows = panel.layout.order - num_columns, block_width = panel.layout.block_width;
  for (int first = panel.layout.first_of_block(num_columns - 1); first >= 0; first -= block_width) {
    const int stride = panel.layout.stride(first), width = std::min(block_width, num_columns - first);
    const int end = first + width, left = num_columns - end;
    const double* const block = panel.column(first);
    if (num_rows > 0)
      dgemv_("T", &num_rows, &width, &minus_one, block + num_columns, &stride, work, &step, &one, x + first,
             &step);
    if (left > 0)
      dgemv_("T", &left, &width, &minus_one, block + end, &stride, x + end, &step, &one, x + first, &step);
    dtrsv_("L", "T", "N", &width, block + first, &stride, x + first, &step);
  }
}

}  // namespace resilin::detail
