#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>

#include "resilin/core/parallel.hpp"
#include "resilin/linear/blas.hpp"
#include "resilin/linear/catalog.hpp"
#include "resilin/linear/dense_kernels.hpp"
#include "resilin/linear/direct_solver.hpp"
#include "resilin/linear/multifrontal_analysis.hpp"

namespace resilin {
namespace {

/// Memory for the update matrices, which come and go along the tree; kept from one factorisation to the next.
class BufferPool {
 public:
  struct Buffer {
    std::unique_ptr<double[]> numbers;
    std::size_t size = 0;
  };

  Buffer take(std::size_t size) {
    {
      const std::lock_guard lock(mutex_);
      const auto fits = free_.lower_bound(size);
      if (fits != free_.end() && fits->first <= 2 * size + 1024) {
        Buffer buffer = std::move(fits->second);
        free_.erase(fits);
        return buffer;
      }
    }
    return {std::make_unique_for_overwrite<double[]>(size), size};
  }

  void give_back(Buffer buffer) {
    if (buffer.size == 0) return;
    const std::lock_guard lock(mutex_);
    const std::size_t size = buffer.size;
    free_.emplace(size, std::move(buffer));
  }

  void clear() { free_.clear(); }

 private:
  std::mutex mutex_;
  std::multimap<std::size_t, Buffer> free_;
};

/// A multifrontal L L^T: METIS order on the graph of the nodes, relaxed supernodes, dense fronts.
///
/// Every front is a lower panel of its columns, kept as the factor, and an update matrix, which its parent
/// takes up. Independent subtrees are factorised at the same time; each front sums its children in a fixed
/// order.
class MultifrontalCholesky : public DirectSolver {
 public:
  std::string_view name() const override { return "multifrontal"; }

  void analyze(const BlockMatrix& A, const VectorX&) override {
    if (!pattern_.update(A, MergedPattern::Keep::superset)) return;
    analysis_.emplace(pattern_);
    dim_ = A.dim;
    factor_.reset();
    pool_.clear();
  }

  LinearReport factorize(const BlockMatrix& A) override;

 protected:
  void solve_factored(const VectorX& b, VectorX& x) override;

 private:
  double* panel_of(const Supernode& supernode) {
    return factor_.get() + supernode.factor_begin * dim_ * dim_;
  }
  void gather_values(const BlockMatrix& A);
  void factorize_front(Index s);
  void add_entries(Index s, double* panel);
  void add_child_to_panel(const Supernode& child, const double* update, double* panel, int stride);
  void add_child_to_update(const Supernode& child, const double* update, Index num_columns, double* to,
                           int stride);

  MergedPattern pattern_;
  std::optional<MultifrontalAnalysis> analysis_;
  int dim_ = 3;
  std::vector<double> values_;  // by slot of the merged pattern
  std::unique_ptr<double[]> factor_;
  std::vector<BufferPool::Buffer> updates_;  // by supernode, between the front and its parent
  std::vector<Index> bad_position_;          // by supernode: the column whose pivot failed, or -1
  BufferPool pool_;
  std::vector<double> solution_, work_;
};

void MultifrontalCholesky::gather_values(const BlockMatrix& A) {
  const int size = dim_ * dim_;
  values_.assign(static_cast<std::size_t>(pattern_.num_slots()) * size, 0.0);
  pattern_.for_each_block(A, [&](Offset slot, const double* block) {
    for (int k = 0; k < size; ++k) values_[slot * size + k] += block[k];
  });
}

void MultifrontalCholesky::add_entries(Index s, double* panel) {
  const Offset stride = static_cast<Offset>(analysis_->supernodes[s].front_size()) * dim_;
  for (Offset e = analysis_->entry_begin[s]; e < analysis_->entry_begin[s + 1]; ++e) {
    const MultifrontalAnalysis::Entry& entry = analysis_->entries[e];
    const double* block = values_.data() + entry.slot * dim_ * dim_;
    double* to = panel + entry.column * dim_ * stride + entry.row * dim_;
    for (int c = 0; c < dim_; ++c)
      for (int r = 0; r < dim_; ++r)
        to[c * stride + r] += entry.is_transposed ? block[c * dim_ + r] : block[r * dim_ + c];
  }
}

/// Columns of the child's update that are columns of the parent.
void MultifrontalCholesky::add_child_to_panel(const Supernode& child, const double* update, double* panel,
                                              int stride) {
  const Index* places = analysis_->places.data() + child.rows_begin;
  const Index num_rows = child.num_rows();
  const Index num_columns = analysis_->supernodes[child.parent].num_columns;
  const Offset update_stride = static_cast<Offset>(num_rows) * dim_;
  for (Index column = 0; column < num_rows && places[column] < num_columns; ++column)
    for (int c = 0; c < dim_; ++c)
      detail::add_rows(dim_, update + (static_cast<Offset>(column) * dim_ + c) * update_stride, places,
                       column, num_rows, panel + (static_cast<Offset>(places[column]) * dim_ + c) * stride);
}

/// The rest of them.
void MultifrontalCholesky::add_child_to_update(const Supernode& child, const double* update,
                                               Index num_columns, double* to, int stride) {
  const Index* places = analysis_->places.data() + child.rows_begin;
  const Index num_rows = child.num_rows();
  const Offset update_stride = static_cast<Offset>(num_rows) * dim_;
  const auto first = static_cast<Index>(std::lower_bound(places, places + num_rows, num_columns) - places);
  for (Index column = first; column < num_rows; ++column)
    for (int c = 0; c < dim_; ++c)
      detail::add_rows(dim_, update + (static_cast<Offset>(column) * dim_ + c) * update_stride, places,
                       column, num_rows,
                       to + (static_cast<Offset>(places[column] - num_columns) * dim_ + c) * stride -
                           static_cast<Offset>(num_columns) * dim_);
}

void MultifrontalCholesky::factorize_front(Index s) {
  const Supernode& supernode = analysis_->supernodes[s];
  const int num_columns = supernode.num_columns * dim_, num_rows = supernode.num_rows() * dim_;
  const int stride = num_columns + num_rows;
  const auto begin = analysis_->children.begin() + analysis_->child_begin[s];
  const auto end = analysis_->children.begin() + analysis_->child_begin[s + 1];
  double* panel = panel_of(supernode);
  std::fill(panel, panel + static_cast<Offset>(num_columns) * stride, 0.0);
  add_entries(s, panel);
  for (auto child = begin; child != end; ++child)
    add_child_to_panel(analysis_->supernodes[*child], updates_[*child].numbers.get(), panel, stride);

  const int failed_column = detail::cholesky_panel(num_columns, num_rows, panel, stride);
  bad_position_[s] = failed_column < 0 ? -1 : supernode.first + failed_column / dim_;
  if (num_rows > 0) {
    updates_[s] = pool_.take(static_cast<std::size_t>(num_rows) * static_cast<std::size_t>(num_rows));
    double* update = updates_[s].numbers.get();
    detail::outer_product(num_rows, num_columns, panel + num_columns, stride, update);
    for (auto child = begin; child != end; ++child)
      add_child_to_update(analysis_->supernodes[*child], updates_[*child].numbers.get(),
                          supernode.num_columns, update, num_rows);
  }
  for (auto child = begin; child != end; ++child) pool_.give_back(std::move(updates_[*child]));
}

LinearReport MultifrontalCholesky::factorize(const BlockMatrix& A) {
  analyze(A, {});
  LinearReport report;
  const SingleThreadedBlas single_threaded;
  try {
    gather_values(A);
    const auto size = static_cast<std::size_t>(analysis_->factor_blocks) * dim_ * dim_;
    if (!factor_) factor_ = std::make_unique_for_overwrite<double[]>(size);
    updates_.resize(analysis_->supernodes.size());
    bad_position_.assign(analysis_->supernodes.size(), -1);
    parallel_tasks(analysis_->subtrees.size(), [&](std::size_t k) {
      const auto [first, last] = analysis_->subtrees[k];
      for (Index s = first; s < last; ++s) {
        factorize_front(s);
        if (bad_position_[s] >= 0) return;  // its ancestors cannot be finished; other subtrees do not know
      }
    });
    const auto has_failed = [&] {
      return std::any_of(bad_position_.begin(), bad_position_.end(), [](Index bad) { return bad >= 0; });
    };
    if (!has_failed()) {
      for (const Index s : analysis_->top) {
        factorize_front(s);
        if (bad_position_[s] >= 0) break;
      }
    }
  } catch (const std::bad_alloc&) {
    updates_.clear();
    report.status = LinearReport::Status::out_of_memory;
    return report;
  }
  for (const Index bad : bad_position_) {
    if (bad < 0) continue;
    report.status = LinearReport::Status::indefinite;
    report.worst_node = analysis_->node_at[bad];
    for (BufferPool::Buffer& update : updates_) pool_.give_back(std::move(update));
    updates_.clear();
    break;
  }
  return report;
}

void MultifrontalCholesky::solve_factored(const VectorX& b, VectorX& x) {
  const SingleThreadedBlas single_threaded;
  solution_.resize(static_cast<std::size_t>(b.size()));
  const auto n = static_cast<Index>(analysis_->node_at.size());
  for (Index i = 0; i < n; ++i)
    for (int d = 0; d < dim_; ++d) solution_[i * dim_ + d] = b[analysis_->node_at[i] * dim_ + d];
  for (const Supernode& supernode : analysis_->supernodes) {
    const int num_columns = supernode.num_columns * dim_, num_rows = supernode.num_rows() * dim_;
    work_.assign(static_cast<std::size_t>(num_rows), 0.0);
    detail::solve_panel(num_columns, num_rows, panel_of(supernode), solution_.data() + supernode.first * dim_,
                        work_.data());
    for (Offset k = 0; k < supernode.num_rows(); ++k)
      for (int d = 0; d < dim_; ++d)
        solution_[analysis_->rows[supernode.rows_begin + k] * dim_ + d] += work_[k * dim_ + d];
  }
  for (auto supernode = analysis_->supernodes.rbegin(); supernode != analysis_->supernodes.rend();
       ++supernode) {
    const int num_columns = supernode->num_columns * dim_, num_rows = supernode->num_rows() * dim_;
    work_.resize(static_cast<std::size_t>(num_rows));
    for (Offset k = 0; k < supernode->num_rows(); ++k)
      for (int d = 0; d < dim_; ++d)
        work_[k * dim_ + d] = solution_[analysis_->rows[supernode->rows_begin + k] * dim_ + d];
    detail::solve_panel_transposed(num_columns, num_rows, panel_of(*supernode),
                                   solution_.data() + supernode->first * dim_, work_.data());
  }
  x.resize(b.size());
  for (Index i = 0; i < n; ++i)
    for (int d = 0; d < dim_; ++d) x[analysis_->node_at[i] * dim_ + d] = solution_[i * dim_ + d];
}

}  // namespace

std::unique_ptr<LinearSolver> make_multifrontal(const LinearOptions&) {
  return std::make_unique<MultifrontalCholesky>();
}

}  // namespace resilin
