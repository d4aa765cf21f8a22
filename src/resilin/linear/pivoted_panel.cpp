#include "resilin/linear/pivoted_panel.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "resilin/core/parallel.hpp"
#include "resilin/core/types.hpp"

extern "C" {
void dgemm_(const char*, const char*, const int*, const int*, const int*, const double*, const double*,
            const int*, const double*, const int*, const double*, double*, const int*);
void dgemv_(const char*, const int*, const int*, const double*, const double*, const int*, const double*,
            const int*, const double*, double*, const int*);
}

namespace resilin::detail {
namespace {

constexpr double one = 1, minus_one = -1, zero = 0;
constexpr int step = 1;
/// Columns eliminated before the others are brought up to date.
constexpr int block = 32;
/// Columns brought up to date at a time, whatever the number of threads.
constexpr int piece = 96;

double largest_size(const double* numbers, int count) {
  return count > 0 ? Eigen::Map<const VectorX>(numbers, count).lpNorm<Eigen::Infinity>() : 0.0;
}

/// A symmetric 2 x 2 block of D.
struct Pair {
  double first, lower, second;

  double determinant() const { return first * second - lower * lower; }
};

/// The factorisation while it goes on. Columns [0, begin) are eliminated and all others know it; columns
/// [begin, next) are eliminated, and of them only the pivots' own columns and `scaled_columns_` know.
class PanelFactorization {
 public:
  PanelFactorization(int num_columns, int num_rows, double* panel, int stride, const PivotRule& rule)
      : num_columns_(num_columns),
        height_(num_columns + num_rows),
        stride_(stride),
        panel_(panel),
        rule_(rule),
        scaled_columns_(static_cast<std::size_t>(height_) * (block + 2)) {
    result_.order.resize(static_cast<std::size_t>(num_columns));
    std::iota(result_.order.begin(), result_.order.end(), 0);
    result_.diagonal.assign(static_cast<std::size_t>(num_columns), 0.0);
    result_.lower.assign(static_cast<std::size_t>(num_columns), 0.0);
  }

  /// Columns that fail are tried again after the others, as long as there is progress.
  PivotedColumns run() {
    int eliminated_before = -1;
    while (next_ < num_columns_ && next_ > eliminated_before) {
      eliminated_before = next_;
      end_ = num_columns_;
      while (next_ < end_) {
        begin_ = next_;
        while (next_ < end_ && next_ - begin_ < block) {
          eliminate_next();
          if (result_.null_column >= 0) return std::move(result_);
        }
        update_others();
      }
    }
    result_.num_eliminated = next_;
    return std::move(result_);
  }

 private:
  double& at(int i, int j) { return panel_[static_cast<Offset>(j) * stride_ + i]; }
  /// Rows of L D in the column of a pivot of this block, or of a candidate for the next ones.
  double* scaled_column(int k) { return scaled_columns_.data() + static_cast<Offset>(k - begin_) * height_; }

  /// Rows [next, height) of a column of the front, with all that has been eliminated.
  void bring_up_to_date(int column, double* to) {
    for (int i = next_; i < column; ++i) to[i] = at(column, i);
    std::copy(&at(column, column), &at(column, column) + (height_ - column), to + column);
    const int rows = height_ - next_, pivots = next_ - begin_;
    if (pivots > 0)
      dgemv_("N", &rows, &pivots, &minus_one, &at(next_, begin_), &stride_, scaled_columns_.data() + column,
             &height_, &one, to + next_, &step);
  }

  /// The largest of rows [first, height), one of them left out.
  double largest(const double* column, int first, int left_out) const {
    return std::max(largest_size(column + first, left_out - first),
                    largest_size(column + left_out + 1, height_ - left_out - 1));
  }

  bool is_pivot(double value, double largest_beside) const {
    const double size = std::abs(value);
    return size > rule_.round_off && (size >= rule_.threshold * largest_beside ||
                                      largest_beside * largest_beside <= size * rule_.growth);
  }

  /// |D^-1| times the largest entries beside the two columns bounds the entries of L. A determinant that
  /// cancels is no better than round-off.
  bool is_pivot(const Pair& D, double largest_beside_first, double largest_beside_second) const {
    const double size = std::max({std::abs(D.first), std::abs(D.second), std::abs(D.lower)});
    const double product = std::abs(D.first * D.second), square = D.lower * D.lower;
    const double determinant = std::abs(D.determinant());
    if (!(determinant > rule_.round_off * size && 2 * determinant >= std::max(product, square))) return false;
    const double bound = determinant / rule_.threshold;
    return std::abs(D.second) * largest_beside_first + std::abs(D.lower) * largest_beside_second <= bound &&
           std::abs(D.lower) * largest_beside_first + std::abs(D.first) * largest_beside_second <= bound;
  }

  void eliminate_next() {
    const int k = next_;
    double* const column = scaled_column(k);
    bring_up_to_date(k, column);
    const double beside = largest(column, k, k);
    if (!(std::max(std::abs(column[k]), beside) > rule_.round_off)) {
      result_.null_column = result_.order[k];
      return;
    }
    if (is_pivot(column[k], beside)) return eliminate_one();
    int t = -1;
    for (int i = k + 1; i < num_columns_; ++i)
      if (t < 0 || std::abs(column[i]) > std::abs(column[t])) t = i;
    if (t >= 0) {
      double* const partner = scaled_column(k + 1);
      bring_up_to_date(t, partner);
      const Pair D{column[k], column[t], partner[t]};
      if (is_pivot(D, largest(column, k + 1, t), largest(partner, k + 1, t))) {
        exchange(k + 1, t);
        return eliminate_two();
      }
      if (is_pivot(partner[t], largest(partner, k, t))) {
        std::swap_ranges(column + k, column + height_, partner + k);
        exchange(k, t);
        return eliminate_one();
      }
    }
    exchange(k, --end_);
  }

  /// Exchanges two columns, and rows, that are not eliminated.
  void exchange(int p, int q) {
    if (p == q) return;
    for (int j = 0; j < p; ++j) std::swap(at(p, j), at(q, j));
    std::swap(at(p, p), at(q, q));
    for (int i = p + 1; i < q; ++i) std::swap(at(i, p), at(q, i));
    std::swap_ranges(&at(q, p) + 1, &at(q, p) + (height_ - q), &at(q, q) + 1);
    for (int k = begin_; k < next_ + 2; ++k) std::swap(scaled_column(k)[p], scaled_column(k)[q]);
    std::swap(result_.order[p], result_.order[q]);
  }

  void eliminate_one() {
    const int k = next_++;
    const double* const column = scaled_column(k);
    const double D = column[k];
    result_.diagonal[k] = D;
    at(k, k) = 1;
    for (int i = k + 1; i < height_; ++i) at(i, k) = column[i] / D;
  }

  void eliminate_two() {
    const int k = next_;
    next_ += 2;
    const double *const first = scaled_column(k), *const second = scaled_column(k + 1);
    const Pair D{first[k], first[k + 1], second[k + 1]};
    result_.diagonal[k] = D.first;
    result_.diagonal[k + 1] = D.second;
    result_.lower[k] = D.lower;
    at(k, k) = at(k + 1, k + 1) = 1;
    at(k + 1, k) = 0;
    // Divided by the entry below the diagonal, so that nothing overflows: LAPACK's dlasyf.
    const double a = D.first / D.lower, b = D.second / D.lower, scale = 1 / (a * b - 1) / D.lower;
    for (int i = k + 2; i < height_; ++i) {
      at(i, k) = (b * first[i] - second[i]) * scale;
      at(i, k + 1) = (a * second[i] - first[i]) * scale;
    }
  }

  void update_others() {
    const int pivots = next_ - begin_, left = num_columns_ - next_;
    if (pivots == 0 || left == 0) return;
    parallel_tasks(static_cast<std::size_t>((left + piece - 1) / piece), [&](std::size_t n) {
      const int first = next_ + static_cast<int>(n) * piece, width = std::min(piece, num_columns_ - first);
      const int rows = height_ - first;
      dgemm_("N", "T", &rows, &width, &pivots, &minus_one, &at(first, begin_), &stride_,
             scaled_columns_.data() + first, &height_, &one, &at(first, first), &stride_);
    });
  }

  int num_columns_, height_, stride_;
  double* panel_;
  PivotRule rule_;
  std::vector<double> scaled_columns_;
  PivotedColumns result_;
  int begin_ = 0, next_ = 0, end_ = 0;  // columns [end, num_columns) failed of late
};

}  // namespace

int PivotedColumns::num_negative() const {
  int count = 0;
  for (int k = 0; k < num_eliminated; ++k) {
    if (lower[k] == 0) {
      count += diagonal[k] < 0 ? 1 : 0;
      continue;
    }
    const Pair D{diagonal[k], lower[k], diagonal[k + 1]};
    count += D.determinant() < 0 ? 1 : D.first < 0 ? 2 : 0;
    ++k;
  }
  return count;
}

PivotedColumns ldlt_panel(int num_columns, int num_rows, double* panel, int stride, const PivotRule& rule) {
  return PanelFactorization(num_columns, num_rows, panel, stride, rule).run();
}

bool is_bounded(int num_columns, const Trapezoid& panel, const PivotRule& rule) {
  const double bound = std::sqrt(rule.growth);
  bool is_bounded = true;
  for (int j = 0; j < num_columns && is_bounded; ++j) {
    const double* column = panel.column(j);
    is_bounded = column[j] * column[j] > rule.round_off &&
                 (Eigen::Map<const Eigen::ArrayXd>(column + j, panel.layout.order - j).abs() <= bound).all();
  }
  return is_bounded;
}

std::vector<double> times_diagonal(int num_rows, const PivotedColumns& columns, const double* rows,
                                   int stride) {
  const int width = columns.num_eliminated;
  std::vector<double> times_D(static_cast<std::size_t>(num_rows) * static_cast<std::size_t>(width));
  const auto row_of = [&](int k) { return rows + static_cast<Offset>(k) * stride; };
  for (int k = 0; k < width; ++k) {
    double* to = times_D.data() + static_cast<Offset>(k) * num_rows;
    const double D = columns.diagonal[k];
    for (int i = 0; i < num_rows; ++i) to[i] = D * row_of(k)[i];
    const bool has_next = columns.lower[k] != 0, has_previous = k > 0 && columns.lower[k - 1] != 0;
    if (!has_next && !has_previous) continue;
    const double off = has_next ? columns.lower[k] : columns.lower[k - 1];
    const double* other = row_of(has_next ? k + 1 : k - 1);
    for (int i = 0; i < num_rows; ++i) to[i] += off * other[i];
  }
  return times_D;
}

void negative_product(int num_rows, int num_columns, int width, const double* left, int left_stride,
                      const double* right, int right_stride, double* target, int target_stride) {
  dgemm_("N", "T", &num_rows, &num_columns, &width, &minus_one, left, &left_stride, right, &right_stride,
         &zero, target, &target_stride);
}

void solve_diagonal(const PivotedColumns& columns, double* x) {
  for (int k = 0; k < columns.num_eliminated; ++k) {
    if (columns.lower[k] == 0) {
      x[k] /= columns.diagonal[k];
      continue;
    }
    const double off = columns.lower[k], a = columns.diagonal[k] / off, b = columns.diagonal[k + 1] / off;
    const double scale = 1 / (a * b - 1) / off;
    const double first = x[k], second = x[k + 1];
    x[k] = (b * first - second) * scale;
    x[k + 1] = (a * second - first) * scale;
    ++k;
  }
}

}  // namespace resilin::detail
