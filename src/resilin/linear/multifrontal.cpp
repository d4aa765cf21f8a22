#include "resilin/linear/multifrontal.hpp"

#include <algorithm>
#include <new>
#include <numeric>
#include <ranges>

#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/linear/blas.hpp"
#include "resilin/linear/catalog.hpp"
#include "resilin/linear/dense_kernels.hpp"
#include "resilin/linear/equilibration.hpp"

namespace resilin {

/// Those of A themselves where they need neither be merged nor scaled.
std::span<const double> MultifrontalSolver::gather_values(const BlockMatrix& A) {
  if (is_definite_ && pattern_.is_that_of(A)) {
    values_ = {};
    return A.values;
  }
  const int size = dim_ * dim_;
  values_.assign(static_cast<std::size_t>(pattern_.num_slots()) * size, 0.0);
  pattern_.for_each_block(A, [&](Offset slot, const double* block) {
    for (int k = 0; k < size; ++k) values_[slot * size + k] += block[k];
  });
  if (!is_definite_) scales_ = equilibrate(pattern_, dim_, values_);
  return values_;
}

std::unique_ptr<double[]> MultifrontalSolver::allocate(Offset size) {
  if (!fits(static_cast<double>(size) * sizeof(double))) throw std::bad_alloc();
  return make_numbers(static_cast<std::size_t>(size));
}

std::span<const Index> MultifrontalSolver::children_of(Index s) const {
  return {analysis_->children.data() + analysis_->child_begin[s],
          analysis_->children.data() + analysis_->child_begin[s + 1]};
}

MultifrontalSolver::Panel MultifrontalSolver::panel_of(Index s) {
  const Supernode& supernode = analysis_->supernodes[s];
  const int block_width = TrapezoidLayout::nodes_per_block * dim_;
  double* const foreseen = factor_.get() + supernode.factor_begin * dim_ * dim_;
  if (!is_pivoted(s))
    return {supernode.num_columns * dim_, {{supernode.front_size() * dim_, block_width}, foreseen}};
  const PivotedFront& front = *pivoted_[s];
  const int height = static_cast<int>(front.unknowns.size()) + supernode.num_rows() * dim_;
  return {front.pivots.num_eliminated, {{height, block_width}, front.panel ? front.panel.get() : foreseen}};
}

void MultifrontalSolver::assemble(const FrontAssembly& front, const Trapezoid& panel) {
  std::fill_n(panel.values, panel.layout.size(front.num_columns()), 0.0);
  front.add_entries(panel);
  int first_delayed = 0;
  for (const Index child : children_of(front.front)) {
    front.add_to_panel(analysis_->supernodes[child], updates_[child], first_delayed, panel);
    first_delayed += updates_[child].num_delayed;
  }
}

/// Few fronts of most matrices hold a negative pivot, and those above them: the others go the quick way.
void MultifrontalSolver::eliminate(const FrontAssembly& front, UpdateStacks& stacks) {
  const Index s = front.front;
  if (std::ranges::any_of(children_of(s), [&](Index child) { return is_pivoted(child); }))
    return eliminate_with_pivots(front, square_of(front, stacks));
  const auto [num_columns, panel] = panel_of(s);
  assemble(front, panel);
  const int failed_column = detail::cholesky_panel(num_columns, panel);
  if (is_definite_) {
    if (failed_column >= 0) bad_position_[s] = front.supernode().first + failed_column / dim_;
  } else if (failed_column >= 0 || !detail::is_bounded(num_columns, panel, rule_)) {
    eliminate_with_pivots(front, square_of(front, stacks));
  }
}

void MultifrontalSolver::eliminate_with_pivots(const FrontAssembly& front, double* square) {
  const Index s = front.front;
  auto pivoted = std::make_unique<PivotedFront>();
  const int height = front.height();
  assemble(front, {{height, height}, square});
  pivoted->pivots = detail::ldlt_panel(front.num_columns(), front.num_rows(), square, height, rule_);

  std::vector<Index> unknowns(static_cast<std::size_t>(front.num_own()));
  std::iota(unknowns.begin(), unknowns.end(), front.supernode().first * dim_);
  for (const Index child : children_of(s))
    if (is_pivoted(child))
      unknowns.insert(unknowns.end(),
                      pivoted_[child]->unknowns.begin() + pivoted_[child]->pivots.num_eliminated,
                      pivoted_[child]->unknowns.end());
  const detail::PivotedColumns& pivots = pivoted->pivots;
  for (const int column : pivots.order) pivoted->unknowns.push_back(unknowns[column]);
  if (pivots.null_column >= 0) {
    bad_position_[s] = unknowns[pivots.null_column] / dim_;
  } else if (front.num_rows() == 0 && pivoted->num_delayed() > 0) {
    bad_position_[s] = pivoted->unknowns[pivots.num_eliminated] / dim_;
  }
  pivoted_[s] = std::move(pivoted);
}

double* MultifrontalSolver::place_of_update(Index s, Offset size, UpdateStacks& stacks) {
  const int numbers_per_block = dim_ * dim_;
  if (is_serial_) return factor_.get() + analysis_->update_begin[s] * numbers_per_block;
  return is_on_stack(s) ? stacks.push(analysis_->stack_of[s], size)
                        : root_updates_.get() + analysis_->root_update_begin[s] * numbers_per_block;
}

void MultifrontalSolver::form_update(const FrontAssembly& front, UpdateStacks& stacks) {
  const Index s = front.front;
  if (front.num_rows() > 0) {
    UpdateMatrix& update = updates_[s];
    const int num_delayed = num_delayed_by(s), order = num_delayed + front.num_rows();
    update = {{{order, num_delayed > 0 ? order : TrapezoidLayout::nodes_per_block * dim_}}, num_delayed};
    if (update.num_delayed > 0) {
      pivoted_[s]->update = allocate(update.layout.size(order));
      update.values = pivoted_[s]->update.get();
    } else {
      update.values = place_of_update(s, update.layout.size(order), stacks);
    }
    if (is_pivoted(s)) {
      eliminate_pivots_from(update, front, square_of(front, stacks));
    } else {
      eliminate_from(update, front);
    }
    for (const Index child : children_of(s))
      front.add_to_update(analysis_->supernodes[child], updates_[child], update);
  }
  for (const Index child : children_of(s)) {
    const TrapezoidLayout& layout = updates_[child].layout;
    if (is_on_stack(child)) stacks.pop(analysis_->stack_of[child], layout.size(layout.order));
    if (is_pivoted(child)) pivoted_[child]->update.reset();
  }
}

/// Eliminates from the columns of a front the part of its update matrix.
void MultifrontalSolver::eliminate_from(const UpdateMatrix& update, const FrontAssembly& front) {
  const auto [num_columns, panel] = panel_of(front.front);
  const int block_width = panel.layout.block_width;
  update.for_columns_of_rows(block_width, [&, end = num_columns, L = panel](int first, int count) {
    for (int begin = 0; begin < end; begin += block_width)
      detail::subtract_products(count, update.layout.order - first, std::min(block_width, end - begin),
                                L.column(begin) + end + first, L.layout.stride(begin), begin > 0 ? 1 : 0,
                                update.column(first) + first, update.layout.stride(first));
  });
}

/// The same of one whose pivots were chosen; the columns that it delays come first in its update.
void MultifrontalSolver::eliminate_pivots_from(const UpdateMatrix& update, const FrontAssembly& front,
                                               const double* square) {
  const PivotedFront& pivoted = *pivoted_[front.front];
  const int width = pivoted.pivots.num_eliminated, stride = front.height(), order = update.layout.order;
  const double* const below = square + width;
  for (int j = 0; j < update.num_delayed; ++j)
    std::copy_n(below + static_cast<Offset>(width + j) * stride + j, order - j, update.column(j) + j);
  const std::vector<double> times_D = detail::times_diagonal(order, pivoted.pivots, below, stride);
  update.for_columns_of_rows(TrapezoidLayout::nodes_per_block * dim_, [&](int first, int count) {
    detail::negative_product(order - first, count, width, times_D.data() + first, order, below + first,
                             stride, update.column(first) + first, update.layout.stride(first));
  });
}

/// Keeps the eliminated ones among all the columns whose pivots were chosen.
void MultifrontalSolver::keep_panel(const FrontAssembly& front, const double* square) {
  PivotedFront& pivoted = *pivoted_[front.front];
  auto [num_columns, panel] = panel_of(front.front);
  if (front.num_delayed > 0) {
    pivoted.panel = allocate(panel.layout.size(num_columns));
    panel.values = pivoted.panel.get();
  }
  const int height = front.height();
  for (int j = 0; j < num_columns; ++j) {
    const int first = panel.layout.first_of_block(j);
    const double* const from = square + static_cast<Offset>(j) * height;
    std::copy(from + first, from + height, panel.column(j) + first);
  }
}

void MultifrontalSolver::factorize_front(Index s, std::span<const double> values, UpdateStacks& stacks) {
  FrontAssembly front{*analysis_, dim_, values, s};
  for (const Index child : children_of(s)) front.num_delayed += num_delayed_by(child);
  eliminate(front, stacks);
  if (bad_position_[s] >= 0) return;
  form_update(front, stacks);
  if (is_pivoted(s)) keep_panel(front, square_of(front, stacks));
}

/// Stops at the first pivot that fails in every subtree, and before the top when there is one. Every front is
/// computed alike however many threads there are; one front at a time needs less memory.
void MultifrontalSolver::factorize_all(std::span<const double> values) {
  const int numbers_per_block = dim_ * dim_;
  const auto factorize_in_order = [&](const auto& supernodes, UpdateStacks& stacks) {
    for (const Index s : supernodes) {
      factorize_front(s, values, stacks);
      if (bad_position_[s] >= 0) return;
    }
  };
  if (is_serial_) {
    const auto num_supernodes = static_cast<Index>(analysis_->supernodes.size());
    return factorize_in_order(std::views::iota(0, num_supernodes), top_stacks_);
  }
  if (!root_updates_)
    root_updates_ =
        make_numbers(static_cast<std::size_t>(analysis_->root_update_blocks * numbers_per_block + 1));
  parallel_tasks(analysis_->subtrees.size(), [&](std::size_t k) {
    std::unique_ptr<UpdateStacks> stacks = stack_pool_.take();
    stacks->reserve(analysis_->subtree_stacks, numbers_per_block);
    const auto [first, last] = analysis_->subtrees[k];
    factorize_in_order(std::views::iota(first, last), *stacks);
    stack_pool_.give_back(std::move(stacks));
  });
  // Fronts before the first failure have sound descendants: going on to it names the same node as one thread
  // does.
  const auto bad = std::find_if(bad_position_.begin(), bad_position_.end(), [](Index b) { return b >= 0; });
  const auto first_bad = static_cast<Index>(bad - bad_position_.begin());
  const auto top_end = std::lower_bound(analysis_->top.begin(), analysis_->top.end(), first_bad);
  top_stacks_.reserve(analysis_->top_stacks, numbers_per_block);
  factorize_in_order(std::ranges::subrange(analysis_->top.begin(), top_end), top_stacks_);
}

void MultifrontalSolver::prepare(const BlockMatrix& A, MergedPattern::Keep keep) {
  if (!pattern_.update(A, keep)) return;
  forget_factor();
  // Pairs that meet are a pattern of their own in each scene.
  const bool is_of_mesh = pattern_.is_that_of(A);
  analysis_ = analyses_ && is_of_mesh ? analyses_->of(pattern_)
                                      : std::make_shared<const MultifrontalAnalysis>(pattern_);
  dim_ = A.dim;
}

void MultifrontalSolver::forget_factor() {
  analysis_.reset();
  factor_.reset();
  factor_capacity_ = 0;
  pivoted_.clear();
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
  const Offset factor_and_updates = is_serial ? analysis_->shared_blocks
                                              : analysis_->factor_blocks + analysis_->root_update_blocks +
                                                    stacks(analysis_->top_stacks) +
                                                    subtrees * stacks(analysis_->subtree_stacks);
  const Offset blocks = pattern_.num_slots() + factor_and_updates;
  return static_cast<double>(blocks) * dim_ * dim_ * sizeof(double);
}

LinearReport MultifrontalSolver::factorize_prepared(const BlockMatrix& A) {
  LinearReport report;
  if (!factor_) has_little_memory_ = !fits(bytes_needed(false));
  is_serial_ = has_little_memory_ || num_threads() == 1;
  const Offset capacity = is_serial_ ? analysis_->shared_blocks : analysis_->factor_blocks;
  if (factor_capacity_ < capacity) factor_.reset();
  const double bytes = factor_ ? 0 : bytes_needed(is_serial_);
  foresee(bytes, A);
  const SingleThreadedBlas single_threaded(num_threads(), static_cast<std::size_t>(bytes));
  if (!factor_) {
    factor_ = make_numbers(static_cast<std::size_t>(capacity * dim_ * dim_));
    factor_capacity_ = capacity;
  }
  const std::span<const double> values = gather_values(A);
  updates_.assign(analysis_->supernodes.size(), {});
  bad_position_.assign(analysis_->supernodes.size(), -1);
  if (!is_definite_) {
    pivoted_.clear();
    pivoted_.resize(analysis_->supernodes.size());
  }
  factorize_all(values);
  const auto bad = std::find_if(bad_position_.begin(), bad_position_.end(), [](Index b) { return b >= 0; });
  const Index bad_position = bad != bad_position_.end() ? *bad : is_definite_ ? -1 : null_position();
  if (bad_position >= 0) {
    report.status = LinearReport::Status::indefinite;
    report.worst_node = analysis_->node_at[bad_position];
  }
  for (const std::unique_ptr<PivotedFront>& front : pivoted_)
    if (front) report.negative_pivots += front->pivots.num_negative();
  return report;
}

std::unique_ptr<LinearSolver> make_multifrontal(const LinearOptions& options) {
  return std::make_unique<MultifrontalSolver>(options.is_definite, options.analyses);
}

}  // namespace resilin
