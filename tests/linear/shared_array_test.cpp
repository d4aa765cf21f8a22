// Front by front the factor and the update matrices share one array.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "bar_problem.hpp"
#include "resilin/linear/multifrontal_analysis.hpp"
#include "sample_matrix.hpp"

namespace resilin {
namespace {

struct Extent {
  Offset begin, end;
};

Offset update_size(const Supernode& supernode) {
  return TrapezoidLayout{supernode.num_rows(), TrapezoidLayout::nodes_per_block}.size(supernode.num_rows());
}

/// Content of the array while a front is eliminated: the factor up to its columns, the updates that are not
/// yet taken up, its own.
std::vector<Extent> extents_at(const MultifrontalAnalysis& analysis, std::size_t front) {
  const bool is_last = front + 1 == analysis.supernodes.size();
  std::vector<Extent> extents = {
      {0, is_last ? analysis.factor_blocks : analysis.supernodes[front + 1].factor_begin}};
  for (std::size_t s = 0; s <= front; ++s) {
    const Supernode& supernode = analysis.supernodes[s];
    const bool is_held = s == front || supernode.parent >= static_cast<Index>(front);
    if (!is_held || update_size(supernode) == 0) continue;
    extents.push_back({analysis.update_begin[s], analysis.update_begin[s] + update_size(supernode)});
  }
  std::ranges::sort(extents, {}, &Extent::begin);
  return extents;
}

MultifrontalAnalysis analysis_of(const BlockMatrix& A) {
  MergedPattern pattern;
  pattern.update(A, MergedPattern::Keep::superset);
  return MultifrontalAnalysis(pattern);
}

TEST(SharedArray, HoldsFactorAndUpdatesSideBySideAtEveryFront) {
  std::vector<MultifrontalAnalysis> analyses;
  for (const Index num_nodes : {1, 2, 17, 60, 150})
    for (const int num_extra : {0, 20}) {
      if (num_nodes < 17 && num_extra > 0) continue;
      analyses.push_back(analysis_of(testing::sample_matrix(3, num_nodes, 30, num_extra)));
    }
  for (const int dim : {2, 3})
    analyses.push_back(
        analysis_of(make_bar_problem({.dim = dim, .cells_per_height = dim == 3 ? 4 : 20}).matrix));
  for (const MultifrontalAnalysis& analysis : analyses)
    for (std::size_t front = 0; front < analysis.supernodes.size(); ++front) {
      Offset end = 0;
      for (const Extent& extent : extents_at(analysis, front)) {
        ASSERT_GE(extent.begin, end) << "front " << front << " of " << analysis.supernodes.size();
        end = extent.end;
      }
      ASSERT_LE(end, analysis.shared_blocks);
    }
}

/// Stacks of their own took a fifth of the factor.
TEST(SharedArray, IsHardlyLongerThanTheFactor) {
  const MultifrontalAnalysis analysis = analysis_of(make_bar_problem({.cells_per_height = 10}).matrix);
  EXPECT_LE(static_cast<double>(analysis.shared_blocks), 1.12 * static_cast<double>(analysis.factor_blocks));
}

}  // namespace
}  // namespace resilin
