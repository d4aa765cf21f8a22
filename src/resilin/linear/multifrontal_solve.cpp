#include <cmath>

#include "resilin/linear/blas.hpp"
#include "resilin/linear/dense_kernels.hpp"
#include "resilin/linear/multifrontal.hpp"

namespace resilin {

/// Calls visit(k, unknown) for what stands below the columns that front s has eliminated.
template <class Visit>
void MultifrontalSolver::for_unknowns_below(Index s, const Visit& visit) const {
  int k = 0;
  if (is_pivoted(s))
    for (auto i = static_cast<std::size_t>(pivoted_[s]->pivots.num_eliminated);
         i < pivoted_[s]->unknowns.size(); ++i)
      visit(k++, pivoted_[s]->unknowns[i]);
  const Supernode& supernode = analysis_->supernodes[s];
  for (Offset row = supernode.rows_begin; row < supernode.rows_end; ++row)
    for (int d = 0; d < dim_; ++d) visit(k++, analysis_->rows[row] * dim_ + d);
}

void MultifrontalSolver::solve_front(Index s) {
  const Panel panel = panel_of(s);
  const int num_columns = panel.num_columns;
  work_.assign(static_cast<std::size_t>(panel.num_rows()), 0.0);
  if (is_pivoted(s)) {
    const PivotedFront& front = *pivoted_[s];
    front_solution_.resize(static_cast<std::size_t>(num_columns));
    for (int k = 0; k < num_columns; ++k) front_solution_[k] = solution_[front.unknowns[k]];
    detail::solve_panel(num_columns, panel.values, front_solution_.data(), work_.data());
    detail::solve_diagonal(front.pivots, front_solution_.data());
    for (int k = 0; k < num_columns; ++k) solution_[front.unknowns[k]] = front_solution_[k];
  } else {
    detail::solve_panel(num_columns, panel.values,
                        solution_.data() + static_cast<Offset>(analysis_->supernodes[s].first) * dim_,
                        work_.data());
  }
  for_unknowns_below(s, [&](int k, Index unknown) { solution_[unknown] += work_[k]; });
}

void MultifrontalSolver::solve_front_transposed(Index s) {
  const Panel panel = panel_of(s);
  const int num_columns = panel.num_columns;
  work_.resize(static_cast<std::size_t>(panel.num_rows()));
  for_unknowns_below(s, [&](int k, Index unknown) { work_[k] = solution_[unknown]; });
  if (is_pivoted(s)) {
    const PivotedFront& front = *pivoted_[s];
    front_solution_.resize(static_cast<std::size_t>(num_columns));
    for (int k = 0; k < num_columns; ++k) front_solution_[k] = solution_[front.unknowns[k]];
    detail::solve_panel_transposed(num_columns, panel.values, front_solution_.data(), work_.data());
    for (int k = 0; k < num_columns; ++k) solution_[front.unknowns[k]] = front_solution_[k];
  } else {
    detail::solve_panel_transposed(
        num_columns, panel.values,
        solution_.data() + static_cast<Offset>(analysis_->supernodes[s].first) * dim_, work_.data());
  }
}

void MultifrontalSolver::solve_in_place() {
  const SingleThreadedBlas single_threaded;
  const auto num_supernodes = static_cast<Index>(analysis_->supernodes.size());
  for (Index s = 0; s < num_supernodes; ++s) solve_front(s);
  for (Index s = num_supernodes - 1; s >= 0; --s) solve_front_transposed(s);
}

void MultifrontalSolver::solve_factored(const VectorX& b, VectorX& x) {
  solution_.resize(static_cast<std::size_t>(b.size()));
  x.resize(b.size());
  const auto for_unknowns = [&](const auto& visit) {
    for (std::size_t i = 0; i < analysis_->node_at.size(); ++i)
      for (int d = 0; d < dim_; ++d) {
        const Index unknown = analysis_->node_at[i] * dim_ + d;
        visit(solution_[i * static_cast<std::size_t>(dim_) + d], unknown,
              is_definite_ ? 1.0 : scales_[unknown]);
      }
  };
  for_unknowns([&](double& y, Index unknown, double scale) { y = scale * b[unknown]; });
  solve_in_place();
  for_unknowns([&](double y, Index unknown, double scale) { x[unknown] = scale * y; });
}

/// Inverse iteration from numbers that no eigenvector is likely to be orthogonal to: the position of the
/// largest entry of an eigenvector whose eigenvalue is no larger than round-off, or -1. The signs of the
/// pivots are those of a matrix that is round-off away: without such an eigenvalue they are those of A.
Index MultifrontalSolver::null_position() {
  constexpr int num_iterations = 2;
  constexpr double golden_ratio = 0.6180339887498949;
  solution_.resize(analysis_->node_at.size() * static_cast<std::size_t>(dim_));
  Eigen::Map<VectorX> x(solution_.data(), static_cast<Offset>(solution_.size()));
  for (Offset k = 0; k < x.size(); ++k) {
    const double product = golden_ratio * static_cast<double>(k + 1);
    x[k] = product - std::floor(product) - 0.5;
  }
  for (int iteration = 0; iteration < num_iterations; ++iteration) {
    x /= x.norm();
    solve_in_place();
  }
  Offset largest;
  x.cwiseAbs().maxCoeff(&largest);
  return x.norm() * rule_.round_off < 1 ? -1 : static_cast<Index>(largest / dim_);
}

}  // namespace resilin
