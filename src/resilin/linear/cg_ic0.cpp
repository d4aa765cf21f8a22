#include <algorithm>
#include <atomic>
#include <cmath>

#include "resilin/linear/catalog.hpp"
#include "resilin/linear/conjugate_gradients.hpp"
#include "resilin/linear/diagonal_check.hpp"
#include "resilin/linear/kernels/block_kernels.hpp"
#include "resilin/linear/merged_pattern.hpp"
#include "resilin/linear/permuted_pattern.hpp"
#include "resilin/linear/small_block.hpp"
#include "resilin/linear/sweep_order.hpp"

namespace resilin {
namespace {

/// Incomplete Cholesky factorisation without fill: A ~ U^T D^-1 U on the pattern of A, in dim x dim blocks,
/// nodes in reverse Cuthill-McKee order. Computed in double, applied in float.
///
/// When a pivot block is not positive definite although that of A is, the diagonal of A is raised by a
/// fraction of itself, ever larger, and the factorisation is begun again (Manteuffel 1980).
class BlockIncompleteCholesky : public Preconditioner {
 public:
  void analyze(const BlockMatrix& A, const VectorX&) override {
    if (pattern_.update(A, MergedPattern::Keep::same_pairs)) analyze_pattern(A.dim);
  }

  LinearReport factorize(const BlockMatrix& A) override {
    if (pattern_.update(A, MergedPattern::Keep::same_pairs)) analyze_pattern(A.dim);
    return dim_ == 3 ? factorize_blocks<3>(A) : factorize_blocks<2>(A);
  }

  void apply(const VectorX& r, double norm, VectorX& z) override {
    z.resize(r.size());
    dim_ == 3 ? apply_blocks<3>(r, norm, z) : apply_blocks<2>(r, norm, z);
  }

  void release() override { *this = {}; }

  /// Blocks in double and in float, and some three pairs for each.
  double bytes_per_coupling(int dim) const override {
    return static_cast<double>((dim == 3 ? 12 : 4) * sizeof(double) + dim * dim * sizeof(float) +
                               6 * sizeof(Index));
  }

 private:
  /// The factors tend to the diagonal blocks, which are definite: only numbers that are none get as far.
  static constexpr double largest_shift = 1e3;
  static constexpr double least_pivot =
      1e-10;  // relative to the block's diagonal: below, float cannot hold the inverse
  static constexpr Offset least_couplings =
      12000;  // rows of a region: below, breakdowns at stiff contacts cost more than a core gains
  static constexpr std::size_t nodes_per_chunk = 4096, numbers_per_chunk = 1 << 15;

  void analyze_pattern(int dim);
  template <int dim>
  LinearReport factorize_blocks(const BlockMatrix& A);
  template <int dim>
  void fill_work(const BlockMatrix& A, double shift);
  template <int dim>
  bool eliminate_rows();
  template <int dim>
  bool eliminate_rows_of(const ColoredChunks::Rows& rows);
  template <int dim>
  void apply_blocks(const VectorX& r, double norm, VectorX& z);

  /// Size of a block in `work_`, its rows padded.
  int padded_size() const { return dim_ == 3 ? 12 : 4; }

  MergedPattern pattern_;
  int dim_ = 3;
  Index num_nodes_ = 0;
  PermutedPattern upper_pattern_;
  ColoredChunks chunks_;             // chunks of its positions
  std::vector<Offset> pair_begin_;   // by position: first entry of slot_of_pair_
  std::vector<Index> slot_of_pair_;  // see BlockKernels::eliminate_row
  std::vector<double> work_;
  std::vector<double> inverse_;  // inverse of the pivot blocks
  std::vector<float> upper_, inverse_diagonal_;
  std::vector<float> permuted_;
  double scale_ = 1;  // brings the matrix into the range of float
};

void BlockIncompleteCholesky::analyze_pattern(int dim) {
  dim_ = dim;
  num_nodes_ = pattern_.num_nodes();
  const NodeGraph graph(pattern_);
  SweepOrder order = two_ended_order(graph, least_couplings);
  upper_pattern_ = PermutedPattern(pattern_, graph, std::move(order.node_at));
  chunks_ = std::move(order.chunks);
  const std::vector<Offset>& row_begin = upper_pattern_.row_begin;
  const std::vector<Index>& columns = upper_pattern_.columns;
  pair_begin_.clear();
  slot_of_pair_.clear();
  for (Index i = 0; i < num_nodes_; ++i) {
    pair_begin_.push_back(static_cast<Offset>(slot_of_pair_.size()));
    for (Offset a = row_begin[i]; a < row_begin[i + 1]; ++a)
      for (Offset b = a; b < row_begin[i + 1]; ++b)
        slot_of_pair_.push_back(static_cast<Index>(upper_pattern_.find(columns[a], columns[b])));
  }
  const auto num_nodes = static_cast<std::size_t>(num_nodes_), num_blocks = columns.size();
  const auto size = static_cast<std::size_t>(dim * dim);
  work_.resize((num_blocks + num_nodes) * static_cast<std::size_t>(padded_size()));
  inverse_.resize(num_nodes * size);
  upper_.assign(num_blocks * size + 1, 0.0F);  // padded: see BlockKernels::solve_lower
  inverse_diagonal_.assign(num_nodes * size + 1, 0.0F);
  permuted_.resize(num_nodes * static_cast<std::size_t>(dim));
}

template <int dim>
void BlockIncompleteCholesky::fill_work(const BlockMatrix& A, double shift) {
  constexpr int lanes = dim == 3 ? 4 : 2;
  pattern_.for_each_block(A, [&](Offset slot, const double* block) {
    const Offset target = upper_pattern_.block_of_slot[slot];
    double* to = work_.data() + (target >= 0 ? target : ~target) * dim * lanes;
    for (int r = 0; r < dim; ++r) {
      for (int c = 0; c < dim; ++c)
        to[r * lanes + c] = scale_ * (target >= 0 ? block[r * dim + c] : block[c * dim + r]);
      if (dim < lanes) to[r * lanes + dim] = 0;
    }
  });
  if (shift > 0)
    for (Index i = 0; i < num_nodes_; ++i)
      for (int d = 0; d < dim; ++d)
        work_[static_cast<std::size_t>(i) * dim * lanes + d * (lanes + 1)] *= 1 + shift;
}

template <int dim>
bool BlockIncompleteCholesky::eliminate_rows() {
  std::atomic<bool> is_definite = true;
  chunks_.forward([&](const ColoredChunks::Rows& rows) {
    if (!eliminate_rows_of<dim>(rows)) is_definite = false;
  });
  return is_definite;
}

template <int dim>
bool BlockIncompleteCholesky::eliminate_rows_of(const ColoredChunks::Rows& rows) {
  constexpr int lanes = dim == 3 ? 4 : 2;
  const auto eliminate_row = detail::block_kernels().eliminate_row[dim - 2];
  for (Index i = rows.first; i < rows.last; ++i) {
    double pivot[dim * dim];
    for (int r = 0; r < dim; ++r)
      for (int c = 0; c < dim; ++c)
        pivot[r * dim + c] = work_[(static_cast<std::size_t>(i) * dim + r) * lanes + c];
    double* inverse = &inverse_[static_cast<std::size_t>(i) * dim * dim];
    if (!invert_positive_definite<dim>(pivot, least_pivot, inverse)) return false;
    eliminate_row(work_.data(), num_nodes_ + upper_pattern_.row_begin[i],
                  num_nodes_ + upper_pattern_.row_begin[i + 1], slot_of_pair_.data() + pair_begin_[i],
                  inverse);
  }
  return true;
}

template <int dim>
LinearReport BlockIncompleteCholesky::factorize_blocks(const BlockMatrix& A) {
  constexpr int lanes = dim == 3 ? 4 : 2;
  LinearReport report;
  const DiagonalCheck diagonal = check_diagonal(A);
  if (diagonal.bad_node >= 0) {
    report.status = LinearReport::Status::indefinite;
    report.worst_node = diagonal.bad_node;
    return report;
  }
  scale_ = 1 / diagonal.largest;
  for (double shift = 0;; shift = shift == 0 ? 1e-3 : 4 * shift) {
    fill_work<dim>(A, shift);
    if (eliminate_rows<dim>()) break;
    if (shift > largest_shift) {
      report.status = LinearReport::Status::indefinite;
      return report;
    }
  }
  const double* off_diagonal = work_.data() + static_cast<Offset>(num_nodes_) * dim * lanes;
  parallel_for(upper_pattern_.columns.size() * dim, numbers_per_chunk,
               [&](std::size_t first, std::size_t last) {
                 for (std::size_t k = first; k < last; ++k)
                   for (int c = 0; c < dim; ++c)
                     upper_[k * dim + c] = static_cast<float>(off_diagonal[k * lanes + c]);
               });
  parallel_for(inverse_.size(), numbers_per_chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) inverse_diagonal_[k] = static_cast<float>(inverse_[k]);
  });
  return report;
}

template <int dim>
void BlockIncompleteCholesky::apply_blocks(const VectorX& r, double norm, VectorX& z) {
  const double into = 1 / norm, back = norm * scale_;
  const Index* node_at = upper_pattern_.node_at.data();
  float* permuted = permuted_.data();
  const auto solve_lower = detail::block_kernels().solve_lower[dim - 2];
  const auto solve_upper = detail::block_kernels().solve_upper[dim - 2];
  const Offset* row_begin = upper_pattern_.row_begin.data();
  const Index* columns = upper_pattern_.columns.data();
  const auto num_nodes = static_cast<std::size_t>(num_nodes_);
  parallel_for(num_nodes, nodes_per_chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      for (int d = 0; d < dim; ++d)
        permuted[i * dim + d] = static_cast<float>(r[node_at[i] * dim + d] * into);
  });
  chunks_.forward([&](const ColoredChunks::Rows& rows) {
    solve_lower(row_begin, columns, upper_.data(), permuted, rows.first, rows.last);
  });
  chunks_.backward([&](const ColoredChunks::Rows& rows) {
    solve_upper(row_begin, columns, upper_.data(), inverse_diagonal_.data(), permuted, rows.first, rows.last);
  });
  parallel_for(num_nodes, nodes_per_chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      for (int d = 0; d < dim; ++d)
        z[node_at[i] * dim + d] = back * static_cast<double>(permuted[i * dim + d]);
  });
}

}  // namespace

std::unique_ptr<LinearSolver> make_cg_ic0(const LinearOptions& options) {
  return std::make_unique<ConjugateGradients>("cg_ic0", options.max_iterations,
                                              std::make_unique<BlockIncompleteCholesky>());
}

}  // namespace resilin
