#include "resilin/linear/analysis_cache.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "resilin/linear/linear_solver.hpp"
#include "sample_matrix.hpp"

namespace resilin {
namespace {

using testing::sample_matrix;

MergedPattern pattern_of(const BlockMatrix& A) {
  MergedPattern pattern;
  pattern.update(A, MergedPattern::Keep::superset);
  return pattern;
}

VectorX solution(const BlockMatrix& A, const std::shared_ptr<AnalysisCache>& analyses) {
  const auto solver = make_linear_solver({.kind = "multifrontal", .analyses = analyses}, A.num_unknowns());
  solver->analyze(A, {});
  EXPECT_EQ(solver->factorize(A).status, LinearReport::Status::ok);
  VectorX x;
  solver->solve(A, VectorX::Ones(A.num_unknowns()), x, 1e-12);
  return x;
}

TEST(AnalysisCache, GivesEqualPatternsOneAnalysisAndOthersTheirOwn) {
  AnalysisCache cache;
  const BlockMatrix A = sample_matrix(3, 40, 30, 0), same = sample_matrix(3, 40, 50, 0),
                    other = sample_matrix(3, 41, 30, 0);
  const auto of_A = cache.of(pattern_of(A));
  EXPECT_EQ(cache.of(pattern_of(same)), of_A);
  EXPECT_NE(cache.of(pattern_of(other)), of_A);
  EXPECT_EQ(cache.of(pattern_of(A)), of_A);
  for (std::size_t i = 0; i < AnalysisCache::most_analyses; ++i)
    static_cast<void>(cache.of(pattern_of(sample_matrix(3, static_cast<Index>(10 + i), 30, 0))));
  EXPECT_NE(cache.of(pattern_of(A)), of_A);  // held for those asked for last
}

TEST(AnalysisCache, ChangesNoBitOfASolution) {
  const auto analyses = std::make_shared<AnalysisCache>();
  for (const int num_extra : {0, 7, 0}) {
    const BlockMatrix A = sample_matrix(2, 60, 30, num_extra);
    const VectorX alone = solution(A, nullptr);
    for (int repeat = 0; repeat < 2; ++repeat) EXPECT_EQ(solution(A, analyses), alone);
  }
}

TEST(AnalysisCache, ServesSeveralThreadsAtOnce) {
  const auto analyses = std::make_shared<AnalysisCache>();
  std::vector<BlockMatrix> matrices;
  std::vector<VectorX> alone;
  for (Index i = 0; i < 8; ++i) {
    matrices.push_back(sample_matrix(2, 30 + i % 6, 30, 0));
    alone.push_back(solution(matrices.back(), nullptr));
  }
  std::vector<std::thread> threads;
  std::vector<int> num_wrong(4, 0);
  for (std::size_t t = 0; t < num_wrong.size(); ++t)
    threads.emplace_back([&, t] {
      for (std::size_t i = 0; i < 40; ++i) {
        const std::size_t k = (i * (t + 1)) % matrices.size();
        num_wrong[t] += solution(matrices[k], analyses) != alone[k] ? 1 : 0;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(num_wrong, std::vector<int>(4, 0));
}

}  // namespace
}  // namespace resilin
