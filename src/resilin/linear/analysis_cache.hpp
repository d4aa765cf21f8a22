#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <vector>

#include "resilin/linear/multifrontal_analysis.hpp"

namespace resilin {

/// Symbolic analyses, for matrices of the same pattern in different solvers: those of scenes that share a
/// mesh. Several threads may ask at once.
///
/// Holds those asked for last. An analysis follows from its pattern alone, so that a solver gives the same
/// bits with and without.
class AnalysisCache {
 public:
  static constexpr std::size_t most_analyses = 4;

  std::shared_ptr<const MultifrontalAnalysis> of(const MergedPattern& pattern);

 private:
  struct Entry {
    std::vector<Offset> row_begin;
    std::vector<Index> columns;
    std::shared_ptr<const MultifrontalAnalysis> analysis;
  };

  std::mutex mutex_;
  std::list<Entry> entries_;  ///< asked for last: first
};

}  // namespace resilin
