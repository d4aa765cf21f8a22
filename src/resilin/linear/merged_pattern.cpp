#include "resilin/linear/merged_pattern.hpp"

#include <algorithm>
#include <cassert>

namespace resilin {
namespace {

std::vector<std::pair<Index, Index>> pairs_of(const BlockMatrix& A) {
  std::vector<std::pair<Index, Index>> pairs;
  pairs.reserve(A.extra.size());
  for (const BlockMatrix::ExtraBlock& extra : A.extra) pairs.emplace_back(extra.row, extra.column);
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace

bool MergedPattern::update(const BlockMatrix& A, Keep keep) {
  std::vector<std::pair<Index, Index>> pairs = pairs_of(A);
  if (base_ == A.pattern) {
    if (pairs == extra_pairs_) return false;
    const bool has_all = std::includes(extra_pairs_.begin(), extra_pairs_.end(), pairs.begin(), pairs.end());
    if (keep == Keep::superset && has_all) return false;
  }
  base_ = A.pattern;
  extra_pairs_ = std::move(pairs);
  base_slots_.clear();
  merged_row_begin_.clear();
  merged_columns_.clear();
  if (extra_pairs_.empty()) {
    row_begin = base_->row_begin;
    columns = base_->columns;
    return true;
  }
  const Index n = base_->num_nodes();
  merged_row_begin_.push_back(0);
  base_slots_.reserve(base_->columns.size());
  auto pair = extra_pairs_.begin();
  for (Index i = 0; i < n; ++i) {
    for (Offset s = base_->row_begin[i]; s < base_->row_begin[i + 1]; ++s) {
      for (; pair != extra_pairs_.end() && pair->first == i && pair->second < base_->columns[s]; ++pair)
        merged_columns_.push_back(pair->second);
      base_slots_.push_back(static_cast<Offset>(merged_columns_.size()));
      merged_columns_.push_back(base_->columns[s]);
    }
    for (; pair != extra_pairs_.end() && pair->first == i; ++pair) merged_columns_.push_back(pair->second);
    merged_row_begin_.push_back(static_cast<Offset>(merged_columns_.size()));
  }
  row_begin = merged_row_begin_;
  columns = merged_columns_;
  return true;
}

Offset MergedPattern::find_slot(Index i, Index j) const {
  const auto begin = columns.begin() + row_begin[i];
  const auto end = columns.begin() + row_begin[i + 1];
  const auto found = std::lower_bound(begin, end, j);
  assert(found != end && *found == j);
  return found - columns.begin();
}

NodeGraph::NodeGraph(const MergedPattern& pattern) {
  const Index n = pattern.num_nodes();
  begin.assign(static_cast<std::size_t>(n) + 1, 0);
  for (Index i = 0; i < n; ++i)
    for (Offset s = pattern.row_begin[i] + 1; s < pattern.row_begin[i + 1]; ++s) {
      ++begin[i + 1];
      ++begin[pattern.columns[s] + 1];
    }
  for (Index i = 0; i < n; ++i) begin[i + 1] += begin[i];
  neighbours.resize(static_cast<std::size_t>(begin[n]));
  std::vector<Index> next(begin.begin(), begin.end() - 1);
  for (Index i = 0; i < n;
       ++i)  // the lower neighbours of a node come from earlier rows, so all are ascending
    for (Offset s = pattern.row_begin[i] + 1; s < pattern.row_begin[i + 1]; ++s) {
      const Index j = pattern.columns[s];
      neighbours[next[i]++] = j;
      neighbours[next[j]++] = i;
    }
}

}  // namespace resilin
