#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "resilin/core/parallel.hpp"
#include "resilin/linear/block_matrix.hpp"

namespace resilin {

/// The upper pattern of a matrix with its extra blocks merged in: what a factorisation sees.
class MergedPattern {
 public:
  MergedPattern() = default;
  MergedPattern(MergedPattern&&) = default;
  MergedPattern& operator=(MergedPattern&&) = default;
  MergedPattern(const MergedPattern&) = delete;
  MergedPattern& operator=(const MergedPattern&) = delete;
  ~MergedPattern() = default;

  /// Changes of the extra couplings that require a new symbolic analysis.
  enum class Keep {
    same_pairs,  ///< any change
    superset,    ///< only new pairs: pairs that have gone stay as zeros
  };

  /// Takes the pattern of `A`; true when it is not the one held, so that the caller must analyse anew.
  bool update(const BlockMatrix& A, Keep keep);
  /// Forgets what is held: the next `update` is true.
  void reset() { base_.reset(); }

  Index num_nodes() const { return static_cast<Index>(row_begin.size()) - 1; }
  Offset num_slots() const { return static_cast<Offset>(columns.size()); }
  Offset find_slot(Index i, Index j) const;
  /// Whether the values of `A`, whose pattern is held, stand by slot as they are.
  bool is_that_of(const BlockMatrix& A) const { return base_slots_.empty() && A.extra.empty(); }

  /// Calls visit(slot, values) for every block of `A`, each with its slot in the merged pattern; those of
  /// different slots at the same time.
  template <class Visit>
  void for_each_block(const BlockMatrix& A, const Visit& visit) const {
    constexpr std::size_t slots_per_chunk = 4096;
    parallel_for(A.pattern->columns.size(), slots_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (auto s = static_cast<Offset>(begin); s < static_cast<Offset>(end); ++s)
        visit(base_slots_.empty() ? s : base_slots_[s], A.block(s));
    });
    for (const BlockMatrix::ExtraBlock& extra : A.extra)
      visit(find_slot(extra.row, extra.column), A.extra_values.data() + extra.begin);
  }

  std::span<const Offset> row_begin;  ///< as in BlockPattern, and that of the matrix where nothing is merged
  std::span<const Index> columns;

 private:
  std::shared_ptr<const BlockPattern> base_;
  std::vector<Offset> merged_row_begin_;
  std::vector<Index> merged_columns_;
  std::vector<std::pair<Index, Index>> extra_pairs_;  ///< sorted, each once
  std::vector<Offset> base_slots_;                    ///< slot by base slot; empty when they are the same
};

/// The neighbours of every node, itself left out, ascending: both triangles of the pattern.
struct NodeGraph {
  std::vector<Index> begin;
  std::vector<Index> neighbours;

  NodeGraph() = default;
  explicit NodeGraph(const MergedPattern& pattern);
  Index num_nodes() const { return static_cast<Index>(begin.size()) - 1; }
};

}  // namespace resilin
