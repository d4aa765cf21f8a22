#include "resilin/core/parallel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace resilin {
namespace {

/// Each test with 1, 2 and 8 threads, whatever the machine has.
struct EveryNumberOfThreads : ::testing::TestWithParam<int> {
  const int before = num_threads();
  EveryNumberOfThreads() { set_num_threads(GetParam()); }
  ~EveryNumberOfThreads() override { set_num_threads(before); }
};

INSTANTIATE_TEST_SUITE_P(Parallel, EveryNumberOfThreads, ::testing::Values(1, 2, 8),
                         [](const auto& entry) { return "threads_" + std::to_string(entry.param); });

TEST_P(EveryNumberOfThreads, IsTheOneAskedFor) { EXPECT_EQ(num_threads(), GetParam()); }

TEST_P(EveryNumberOfThreads, LoopsTakeEachIndexOnceInChunksThatDependOnTheirSizeAlone) {
  for (const std::size_t size : {0U, 1U, 7U, 64U, 1000U}) {
    for (const std::size_t chunk : {1U, 7U, 64U, 10000U}) {
      std::vector<std::atomic<int>> taken(size);
      std::atomic<int> num_chunks = 0, num_wrong = 0;
      parallel_for(size, chunk, [&](std::size_t begin, std::size_t end) {
        ++num_chunks;
        if (begin % chunk != 0 || end != std::min(begin + chunk, size)) ++num_wrong;
        for (std::size_t i = begin; i < end; ++i) ++taken[i];
      });
      EXPECT_EQ(static_cast<std::size_t>(num_chunks), (size + chunk - 1) / chunk);
      EXPECT_EQ(num_wrong, 0);
      EXPECT_TRUE(std::ranges::all_of(taken, [](const auto& count) { return count == 1; }));
    }
  }
}

TEST_P(EveryNumberOfThreads, EachTaskRunsOnce) {
  std::vector<std::atomic<int>> taken(500);
  parallel_tasks(taken.size(), [&](std::size_t i) { ++taken[i]; });
  EXPECT_TRUE(std::ranges::all_of(taken, [](const auto& count) { return count == 1; }));
  parallel_tasks(0, [](std::size_t) { FAIL() << "a task of none"; });
}

/// Numbers of many sizes and both signs, whose sum hangs on the order.
double awkward(std::size_t i) {
  const auto x = static_cast<double>(i);
  return std::sin(x * x) * std::exp2(std::fmod(7 * x, 60));
}

TEST_P(EveryNumberOfThreads, WhatIsMadeIsTakenInOrder) {
  for (const std::size_t size : {0U, 1U, 63U, 1000U, 5000U}) {
    for (const std::size_t chunk : {1U, 7U, 10000U}) {
      std::vector<double> taken;
      std::size_t next = 0;
      parallel_in_order(
          size, chunk,
          [](std::size_t begin, std::size_t end) {
            std::vector<double> made;
            for (std::size_t i = begin; i < end; ++i) made.push_back(awkward(i));
            return made;
          },
          [&](std::size_t begin, const std::vector<double>& made) {
            EXPECT_EQ(begin, next);
            next += made.size();
            taken.insert(taken.end(), made.begin(), made.end());
          });
      ASSERT_EQ(taken.size(), size);
      for (std::size_t i = 0; i < size; ++i) EXPECT_EQ(taken[i], awkward(i));
    }
  }
}

TEST_P(EveryNumberOfThreads, SortingSorts) {
  for (const std::size_t size : {0U, 1U, 4095U, 4096U, 4097U, 100003U}) {
    std::vector<std::pair<int, std::size_t>> items;
    for (std::size_t i = 0; i < size; ++i)
      items.emplace_back(static_cast<int>(i * 7919 % 101), i * 31 % (size + 1));
    auto expected = items;
    std::ranges::sort(expected);
    parallel_sort(items, std::less<>());
    EXPECT_EQ(items, expected);
  }
}

TEST_P(EveryNumberOfThreads, SumsHaveTheBitsOfTheirChunksInOrder) {
  constexpr std::size_t size = 10001, chunk = 64;
  const auto body = [](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += awkward(i);
    return sum;
  };
  double in_order = 0, backwards = 0;
  for (std::size_t i = 0; i < size; i += chunk) in_order += body(i, std::min(i + chunk, size));
  for (std::size_t i = size; i-- > 0;) backwards += awkward(i);
  ASSERT_NE(in_order, backwards) << "the order makes no difference, so the test shows nothing";
  for (int repeat = 0; repeat < 20; ++repeat) EXPECT_EQ(parallel_sum<double>(size, chunk, body), in_order);
  EXPECT_EQ(parallel_sum<double>(0, chunk, body), 0);
}

TEST_P(EveryNumberOfThreads, SumsTakeAnythingThatAdds) {
  struct Pair {
    int count = 0;
    double sum = 0;
    void operator+=(const Pair& other) { count += other.count, sum += other.sum; }
  };
  const Pair sum = parallel_sum<Pair>(100, 9, [](std::size_t begin, std::size_t end) {
    return Pair{.count = static_cast<int>(end - begin), .sum = 1};
  });
  EXPECT_EQ(sum.count, 100);
  EXPECT_EQ(sum.sum, 12);
}

TEST_P(EveryNumberOfThreads, AnExceptionReachesTheCallerAndLaterLoopsGoOn) {
  const auto fails = [](std::size_t begin, std::size_t) {
    if (begin == 40) throw std::runtime_error("chunk 40");
  };
  for (int repeat = 0; repeat < 5; ++repeat) {
    try {
      parallel_for(100, 10, fails);
      FAIL() << "no exception";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "chunk 40");
    }
    std::atomic<int> count = 0;
    parallel_for(100, 10, [&](std::size_t, std::size_t) { ++count; });
    EXPECT_EQ(count, 10);
  }
}

TEST_P(EveryNumberOfThreads, LoopsMayStandInLoops) {
  std::array<double, 30> sums{};
  parallel_tasks(sums.size(), [&](std::size_t i) {
    sums[i] = parallel_sum<double>(
        100, 3, [i](std::size_t begin, std::size_t end) { return static_cast<double>(i * (end - begin)); });
  });
  for (std::size_t i = 0; i < sums.size(); ++i) EXPECT_EQ(sums[i], static_cast<double>(100 * i));
}

TEST(Parallel, AtLeastOneThreadIsLeft) {
  const int before = num_threads();
  for (const int count : {0, -3}) {
    set_num_threads(count);
    EXPECT_EQ(num_threads(), 1);
  }
  set_num_threads(before);
}

/// Three jobs of two threads each: no more than six are ever at work, two for each job.
TEST(ThreadShares, BoundTheThreadsOfEachJob) {
  const int before = num_threads();
  std::atomic<int> num_wrong = 0;
  {
    const ThreadShare share(3, 2);
    EXPECT_EQ(num_threads(), 2);
    std::vector<std::thread> jobs;
    for (int job = 0; job < 3; ++job)
      jobs.emplace_back([&] {
        share.run([&] {
          std::atomic<int> at_work = 0;
          parallel_tasks(200, [&](std::size_t) {
            if (++at_work > 2) ++num_wrong;
            std::this_thread::sleep_for(std::chrono::microseconds(50));
            --at_work;
          });
        });
      });
    for (std::thread& job : jobs) job.join();
  }
  EXPECT_EQ(num_wrong, 0);
  EXPECT_EQ(num_threads(), before);
}

}  // namespace
}  // namespace resilin
