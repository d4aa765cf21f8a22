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

int cholesky_panel(int num_columns, int num_rows, double* panel, int stride) {
  if (num_columns <= narrow) {
    int info = 0;
    dpotrf_("L", &num_columns, panel, &stride, &info);
    if (info > 0) return info - 1;
    if (num_rows > 0)
      dtrsm_("R", "L", "T", "N", &num_rows, &num_columns, &one, panel, &stride, panel + num_columns, &stride);
    return -1;
  }
  const int half = (num_columns / 2 + narrow - 1) / narrow * narrow, others = num_columns - half;
  const int failed = cholesky_panel(half, others + num_rows, panel, stride);
  if (failed >= 0) return failed;
  double* const rest = panel + static_cast<Offset>(half) * (stride + 1);
  subtract_products(others, others + num_rows, half, panel + half, stride, one, rest, stride);
  const int failed_later = cholesky_panel(others, num_rows, rest, stride);
  return failed_later < 0 ? -1 : half + failed_later;
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
