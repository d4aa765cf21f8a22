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

constexpr double one = 1, minus_one = -1, zero = 0;
constexpr int step = 1;
/// Large fronts are cut into pieces of this size, whatever the number of threads.
constexpr int piece = 384;

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
