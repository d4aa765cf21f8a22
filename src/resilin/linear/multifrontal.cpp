#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <new>
#include <ranges>

#include "resilin/core/parallel.hpp"
#include "resilin/linear/blas.hpp"
#include "resilin/linear/catalog.hpp"
#include "resilin/linear/dense_kernels.hpp"
#include "resilin/linear/direct_solver.hpp"
#include "resilin/linear/multifrontal_analysis.hpp"

namespace resilin {
namespace {

/// Two stacks of numbers, kept from one factorisation to the next.
class UpdateStacks {
 public:
  void reserve(const MultifrontalAnalysis::StackSizes& sizes, int numbers_per_block) {
    for (int k = 0; k < 2; ++k) {
      const Offset size = sizes.blocks[k] * numbers_per_block;
      if (size > capacity_[k]) {
        numbers_[k] = std::make_unique_for_overwrite<double[]>(static_cast<std::size_t>(size));
        capacity_[k] = size;
      }
      used_[k] = 0;
    }
  }
  double* push(int stack, Offset size) {
    double* top = numbers_[stack].get() + used_[stack];
    used_[stack] += size;
    return top;
  }
  void pop(int stack, Offset size) { used_[stack] -= size; }

 private:
  std::unique_ptr<double[]> numbers_[2];
  Offset capacity_[2] = {0, 0}, used_[2] = {0, 0};
};

/// As many stacks as subtrees are being factorised at the same time.
class StackPool {
 public:
  std::unique_ptr<UpdateStacks> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<UpdateStacks>();
    std::unique_ptr<UpdateStacks> stacks = std::move(free_.back());
    free_.pop_back();
    return stacks;
  }
  void give_back(std::unique_ptr<UpdateStacks> stacks) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(stacks));
  }
  void clear() { free_.clear(); }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<UpdateStacks>> free_;
};

/// A multifrontal L L^T, or L S L^T with signs S where the matrix need not be definite: METIS order on the
/// graph of the nodes, relaxed supernodes, dense fronts.
///
/// Every front is a lower panel of its columns, kept as the factor, and an update matrix, which its parent
/// takes up. Independent subtrees are factorised at the same time; each front sums its children in a fixed
/// order.
class MultifrontalSolver : public DirectSolver {
 public:
  explicit MultifrontalSolver(bool is_definite) : is_definite_(is_definite) {}

  std::string_view name() const override { return "multifrontal"; }

 protected:
  void prepare(const BlockMatrix& A) override;
  LinearReport factorize_prepared(const BlockMatrix& A) override;
  void forget() override;
  void solve_factored(const VectorX& b, VectorX& x) override;

 private:
  double* panel_of(const Supernode& supernode) {
    return factor_.get() + supernode.factor_begin * dim_ * dim_;
  }
  double bytes_needed(bool is_serial) const;
  void gather_values(const BlockMatrix& A);
  void prepare_signs();
  void forget_factor();
  /// Where a front keeps its update matrix: the update of a subtree's root outlives the stacks of the
  /// subtree.
  struct Place {
    UpdateStacks& stacks;
    double* root_updates;  ///< null: on the stacks like the others
  };
  void factorize_front(Index s, const Place& place);
  void factorize_all();
  void add_entries(Index s, double* panel);
  void add_child_to_panel(const Supernode& child, const double* update, double* panel, int stride);
  void add_child_to_update(const Supernode& child, const double* update, Index num_columns, double* to,
                           int stride);

  bool is_definite_;
  MergedPattern pattern_;
  std::unique_ptr<const MultifrontalAnalysis> analysis_;
  int dim_ = 3;
  bool has_little_memory_ = false;  // for subtrees at the same time, with the present pattern
  bool is_serial_ = false;          // takes the subtrees one after another
  std::vector<double> values_;      // by slot of the merged pattern
  std::unique_ptr<double[]> factor_;
  std::vector<double*> updates_;  // by supernode: its update matrix, from its front to its parent's
  std::unique_ptr<double[]> root_updates_;
  StackPool stack_pool_;
  UpdateStacks top_stacks_;
  std::vector<Index> bad_position_;  // by supernode: the column whose pivot failed, or -1
  double smallest_pivot_ = 0;
  std::vector<double> signs_;  // by position and component, +1 or -1; empty for a definite matrix
  std::vector<double> solution_, work_;
};

void MultifrontalSolver::gather_values(const BlockMatrix& A) {
  const int size = dim_ * dim_;
  values_.assign(static_cast<std::size_t>(pattern_.num_slots()) * size, 0.0);
  pattern_.for_each_block(A, [&](Offset slot, const double* block) {
    for (int k = 0; k < size; ++k) values_[slot * size + k] += block[k];
  });
}

/// A pivot of the size of round-off says that the matrix is singular, or that it needs other pivots.
void MultifrontalSolver::prepare_signs() {
  constexpr double round_off = 1e-15;
  double largest = 0;
  for (const double value : values_) largest = std::max(largest, std::abs(value));
  smallest_pivot_ = round_off * largest;
  signs_.assign(analysis_->node_at.size() * static_cast<std::size_t>(dim_), 1.0);
}

void MultifrontalSolver::add_entries(Index s, double* panel) {
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
void MultifrontalSolver::add_child_to_panel(const Supernode& child, const double* update, double* panel,
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
void MultifrontalSolver::add_child_to_update(const Supernode& child, const double* update, Index num_columns,
                                             double* to, int stride) {
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

void MultifrontalSolver::factorize_front(Index s, const Place& place) {
  const Supernode& supernode = analysis_->supernodes[s];
  const int num_columns = supernode.num_columns * dim_, num_rows = supernode.num_rows() * dim_;
  const int stride = num_columns + num_rows;
  const auto begin = analysis_->children.begin() + analysis_->child_begin[s];
  const auto end = analysis_->children.begin() + analysis_->child_begin[s + 1];
  double* panel = panel_of(supernode);
  std::fill(panel, panel + static_cast<Offset>(num_columns) * stride, 0.0);
  add_entries(s, panel);
  for (auto child = begin; child != end; ++child)
    add_child_to_panel(analysis_->supernodes[*child], updates_[*child], panel, stride);

  double* signs = is_definite_ ? nullptr : signs_.data() + static_cast<Offset>(supernode.first) * dim_;
  const int failed_column = is_definite_ ? detail::cholesky_panel(num_columns, num_rows, panel, stride)
                                         : detail::signed_cholesky_panel(num_columns, num_rows, panel, stride,
                                                                         smallest_pivot_, signs);
  bad_position_[s] = failed_column < 0 ? -1 : supernode.first + failed_column / dim_;
  const int own_stack = analysis_->stack_of[s];
  const auto is_on_stack = [&](Index t) {
    return place.root_updates == nullptr || analysis_->root_update_begin[t] < 0;
  };
  if (num_rows > 0) {
    double* update = is_on_stack(s) ? place.stacks.push(own_stack, static_cast<Offset>(num_rows) * num_rows)
                                    : place.root_updates + analysis_->root_update_begin[s] * dim_ * dim_;
    updates_[s] = update;
    if (is_definite_) {
      detail::outer_product(num_rows, num_columns, panel + num_columns, stride, update);
    } else {
      detail::signed_outer_product(num_rows, num_columns, panel + num_columns, stride, signs, update);
    }
    for (auto child = begin; child != end; ++child)
      add_child_to_update(analysis_->supernodes[*child], updates_[*child], supernode.num_columns, update,
                          num_rows);
  }
  for (auto child = begin; child != end; ++child) {
    const Offset child_rows = static_cast<Offset>(analysis_->supernodes[*child].num_rows()) * dim_;
    if (is_on_stack(*child)) place.stacks.pop(1 - own_stack, child_rows * child_rows);
  }
}

/// Stops at the first pivot that fails in every subtree, and before the top when there is one. Every front is
/// computed alike however many threads there are; one subtree at a time needs less memory.
void MultifrontalSolver::factorize_all() {
  const int numbers_per_block = dim_ * dim_;
  const auto factorize_in_order = [&](const auto& supernodes, const Place& place) {
    for (const Index s : supernodes) {
      factorize_front(s, place);
      if (bad_position_[s] >= 0) return;
    }
  };
  if (is_serial_) {
    top_stacks_.reserve(analysis_->all_stacks, numbers_per_block);
    const auto num_supernodes = static_cast<Index>(analysis_->supernodes.size());
    return factorize_in_order(std::views::iota(0, num_supernodes), {top_stacks_, nullptr});
  }
  if (!root_updates_)
    root_updates_ = std::make_unique_for_overwrite<double[]>(
        static_cast<std::size_t>(analysis_->root_update_blocks * numbers_per_block + 1));
  parallel_tasks(analysis_->subtrees.size(), [&](std::size_t k) {
    std::unique_ptr<UpdateStacks> stacks = stack_pool_.take();
    stacks->reserve(analysis_->subtree_stacks, numbers_per_block);
    const auto [first, last] = analysis_->subtrees[k];
    factorize_in_order(std::views::iota(first, last), {*stacks, root_updates_.get()});
    stack_pool_.give_back(std::move(stacks));
  });
  // Fronts before the first failure have sound descendants: going on to it names the same node as one thread
  // does.
  const auto bad = std::find_if(bad_position_.begin(), bad_position_.end(), [](Index b) { return b >= 0; });
  const auto first_bad = static_cast<Index>(bad - bad_position_.begin());
  const auto top_end = std::lower_bound(analysis_->top.begin(), analysis_->top.end(), first_bad);
  top_stacks_.reserve(analysis_->top_stacks, numbers_per_block);
  factorize_in_order(std::ranges::subrange(analysis_->top.begin(), top_end),
                     {top_stacks_, root_updates_.get()});
}

void MultifrontalSolver::prepare(const BlockMatrix& A) {
  if (!pattern_.update(A, MergedPattern::Keep::superset)) return;
  forget_factor();
  analysis_ = std::make_unique<const MultifrontalAnalysis>(pattern_);
  dim_ = A.dim;
}

void MultifrontalSolver::forget_factor() {
  analysis_.reset();
  factor_.reset();
  root_updates_.reset();
  stack_pool_.clear();
  top_stacks_ = {};
}

void MultifrontalSolver::forget() {
  pattern_.reset();
  forget_factor();
}

double MultifrontalSolver::bytes_needed(bool is_serial) const {
  const auto stacks = [](const MultifrontalAnalysis::StackSizes& sizes) {
    return sizes.blocks[0] + sizes.blocks[1];
  };
  const auto subtrees =
      std::min(static_cast<Offset>(num_threads()), static_cast<Offset>(analysis_->subtrees.size()));
  const Offset updates = is_serial ? stacks(analysis_->all_stacks)
                                   : analysis_->root_update_blocks + stacks(analysis_->top_stacks) +
                                         subtrees * stacks(analysis_->subtree_stacks);
  const Offset blocks = pattern_.num_slots() + analysis_->factor_blocks + updates;
  return static_cast<double>(blocks) * dim_ * dim_ * sizeof(double);
}

LinearReport MultifrontalSolver::factorize_prepared(const BlockMatrix& A) {
  LinearReport report;
  if (!factor_) has_little_memory_ = !fits(bytes_needed(false));
  is_serial_ = has_little_memory_ || num_threads() == 1;
  const double bytes = factor_ ? 0 : bytes_needed(is_serial_);
  foresee(bytes, A);
  const SingleThreadedBlas single_threaded(num_threads(), static_cast<std::size_t>(bytes));
  if (!factor_)
    factor_ = std::make_unique_for_overwrite<double[]>(static_cast<std::size_t>(analysis_->factor_blocks) *
                                                       static_cast<std::size_t>(dim_ * dim_));
  gather_values(A);
  updates_.assign(analysis_->supernodes.size(), nullptr);
  bad_position_.assign(analysis_->supernodes.size(), -1);
  if (!is_definite_) prepare_signs();
  factorize_all();
  const auto bad = std::find_if(bad_position_.begin(), bad_position_.end(), [](Index b) { return b >= 0; });
  if (bad != bad_position_.end()) {
    report.status = LinearReport::Status::indefinite;
    report.worst_node = analysis_->node_at[*bad];
  }
  report.negative_pivots =
      static_cast<Index>(std::count_if(signs_.begin(), signs_.end(), [](double sign) { return sign < 0; }));
  return report;
}

void MultifrontalSolver::solve_factored(const VectorX& b, VectorX& x) {
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
  for (std::size_t k = 0; k < signs_.size(); ++k) solution_[k] *= signs_[k];
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

std::unique_ptr<LinearSolver> make_multifrontal(const LinearOptions& options) {
  return std::make_unique<MultifrontalSolver>(options.is_definite);
}

}  // namespace resilin
