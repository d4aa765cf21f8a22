#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "resilin/linear/analysis_cache.hpp"
#include "resilin/linear/direct_solver.hpp"
#include "resilin/linear/front_assembly.hpp"
#include "resilin/linear/pivoted_panel.hpp"
#include "resilin/linear/update_stacks.hpp"

namespace resilin {

/// A front whose pivots were chosen one by one.
struct PivotedFront {
  detail::PivotedColumns pivots;
  std::vector<Index> unknowns;  ///< its columns: those eliminated, then those delayed; dim * position + d
  std::unique_ptr<double[]>
      panel;  ///< panel of a front that took up delayed columns; else where it was foreseen
  std::unique_ptr<double[]>
      update;  ///< update matrix of a front that delays columns; else where it was foreseen

  int num_delayed() const { return static_cast<int>(unknowns.size()) - pivots.num_eliminated; }
};

/// A multifrontal L L^T: METIS order on the graph of the nodes, relaxed supernodes, dense fronts. Where the
/// matrix need not be definite, L D L^T of the equilibrated matrix with pivots of one and two columns in
/// those fronts that are not definite.
///
/// Every front is a lower panel of its columns, kept as the factor, and an update matrix, which its parent
/// takes up, together with columns for which there was no pivot. Independent subtrees are factorised at the
/// same time; each front sums its children in a fixed order.
class MultifrontalSolver : public DirectSolver {
 public:
  /// @param analyses  of matrices elsewhere; may be null
  MultifrontalSolver(bool is_definite, std::shared_ptr<AnalysisCache> analyses)
      : is_definite_(is_definite), analyses_(std::move(analyses)) {}

  std::string_view name() const override { return "multifrontal"; }

 protected:
  void prepare(const BlockMatrix& A, MergedPattern::Keep keep) override;
  LinearReport factorize_prepared(const BlockMatrix& A) override;
  void forget() override;
  void solve_factored(const VectorX& b, VectorX& x) override;

 private:
  /// L11 and L21 of a front: the columns eliminated, and the unknowns below them.
  struct Panel {
    int num_columns;
    Trapezoid values;

    int num_rows() const { return values.layout.order - num_columns; }
  };
  Panel panel_of(Index s);
  double bytes_needed(bool is_serial) const;
  /// Storage that no analysis can foresee.
  static std::unique_ptr<double[]> allocate(Offset size);
  std::span<const double> gather_values(const BlockMatrix& A);
  void forget_factor();
  /// Whether a front keeps its update matrix on the stacks of its subtree: that of the subtree's root
  /// outlives them, and front by front the factor's array has the room.
  bool is_on_stack(Index s) const {
    return !is_serial_ && num_delayed_by(s) == 0 && analysis_->root_update_begin[s] < 0;
  }
  double* place_of_update(Index s, Offset size, UpdateStacks& stacks);
  std::span<const Index> children_of(Index s) const;
  int num_delayed_by(Index s) const { return is_pivoted(s) ? pivoted_[s]->num_delayed() : 0; }
  bool is_pivoted(Index s) const { return !is_definite_ && pivoted_[s] != nullptr; }
  void factorize_front(Index s, std::span<const double> values, UpdateStacks& stacks);
  void factorize_all(std::span<const double> values);
  void assemble(const FrontAssembly& front, const Trapezoid& panel);
  void eliminate(const FrontAssembly& front, UpdateStacks& stacks);
  /// All columns of a front whose pivots are chosen, column-major, until its update matrix is formed.
  static double* square_of(const FrontAssembly& front, UpdateStacks& stacks) {
    return stacks.scratch(static_cast<Offset>(front.num_columns()) * front.height());
  }
  void eliminate_with_pivots(const FrontAssembly& front, double* square);
  void form_update(const FrontAssembly& front, UpdateStacks& stacks);
  void eliminate_from(const UpdateMatrix& update, const FrontAssembly& front);
  void eliminate_pivots_from(const UpdateMatrix& update, const FrontAssembly& front, const double* square);
  void keep_panel(const FrontAssembly& front, const double* square);
  template <class Visit>
  void for_unknowns_below(Index s, const Visit& visit) const;
  void solve_in_place();
  Index null_position();
  void solve_front(Index s);
  void solve_front_transposed(Index s);

  bool is_definite_;
  std::shared_ptr<AnalysisCache> analyses_;
  MergedPattern pattern_;
  std::shared_ptr<const MultifrontalAnalysis> analysis_;
  int dim_ = 3;
  bool has_little_memory_ = false;  // for subtrees at the same time, with the present pattern
  bool is_serial_ = false;          // takes front after front, not subtrees at the same time
  std::vector<double> values_;      // by slot of the merged pattern, where they are not those of A
  std::unique_ptr<double[]> factor_;
  Offset factor_capacity_ = 0;         // in blocks, with the room for updates that are made front by front
  std::vector<UpdateMatrix> updates_;  // by supernode, from its front to its parent's
  std::unique_ptr<double[]> root_updates_;
  StackPool stack_pool_;
  UpdateStacks top_stacks_;
  std::vector<Index> bad_position_;  // by supernode: the column whose pivot failed, or -1
  // For a matrix that need not be definite:
  std::vector<double> scales_;                          // by unknown
  std::vector<std::unique_ptr<PivotedFront>> pivoted_;  // by supernode; null: L L^T
  detail::PivotRule rule_;
  std::vector<double> solution_, front_solution_, work_;
};

}  // namespace resilin
