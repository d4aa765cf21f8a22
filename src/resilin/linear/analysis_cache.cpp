#include "resilin/linear/analysis_cache.hpp"

#include <algorithm>

namespace resilin {

std::shared_ptr<const MultifrontalAnalysis> AnalysisCache::of(const MergedPattern& pattern) {
  const auto is_of = [&pattern](const Entry& entry) {
    return std::ranges::equal(entry.row_begin, pattern.row_begin) &&
           std::ranges::equal(entry.columns, pattern.columns);
  };
  {
    const std::lock_guard lock(mutex_);
    const auto entry = std::ranges::find_if(entries_, is_of);
    if (entry != entries_.end()) {
      entries_.splice(entries_.begin(), entries_, entry);
      return entry->analysis;
    }
  }
  auto analysis = std::make_shared<const MultifrontalAnalysis>(pattern);  // two threads may do it: no harm
  const std::lock_guard lock(mutex_);
  entries_.remove_if(is_of);
  entries_.push_front({{pattern.row_begin.begin(), pattern.row_begin.end()},
                       {pattern.columns.begin(), pattern.columns.end()},
                       analysis});
  if (entries_.size() > most_analyses) entries_.pop_back();
  return analysis;
}

}  // namespace resilin
