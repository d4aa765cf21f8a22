// Independent computations that go on at once.

#include "resilin/sensitivity/side_by_side.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"

namespace resilin::testing {
namespace {

struct SideBySide : ::testing::Test {
  const int threads_before = num_threads();
  std::atomic<bool> stops = false;
  SideBySide() { set_num_threads(3); }
  ~SideBySide() override { set_num_threads(threads_before); }
  void run(std::size_t count, const std::function<void(std::size_t)>& task, bool goes_on = true) {
    run_side_by_side(count, task, [goes_on] { return goes_on; }, stops);
  }
};

TEST_F(SideBySide, EachIsDoneOnceAndThreadsAreAsManyAsBefore) {
  for (const std::size_t count : {0U, 1U, 2U, 20U}) {
    std::vector<std::atomic<int>> done(count);
    run(count, [&](std::size_t i) { ++done[i]; });
    for (const auto& times : done) EXPECT_EQ(times, 1);
    EXPECT_EQ(num_threads(), 3);
  }
}

TEST_F(SideBySide, SeveralGoOnAtOnce) {
  std::atomic<int> waiting = 0;
  run(3, [&](std::size_t) {  // ends once all three have come here
    ++waiting;
    while (waiting < 3) std::this_thread::yield();
  });
  EXPECT_EQ(waiting, 3);
}

TEST_F(SideBySide, TheFirstThatFailsIsTold) {
  for (int again = 0; again < 20; ++again) {
    std::string text;
    try {
      run(30, [](std::size_t i) {
        if (i % 7 == 5) throw InputError("task", std::to_string(i));
      });
    } catch (const InputError& error) {
      text = error.what();
    }
    EXPECT_EQ(text, "task: 5");
  }
}

TEST_F(SideBySide, EndsWhenItIsToStop) {
  const auto until_stopped = [this](std::size_t) {
    while (!stops) std::this_thread::yield();
    throw Interrupted();
  };
  EXPECT_THROW(run(4, until_stopped, false), Interrupted);
}

TEST_F(SideBySide, OneWithinAnotherIsDoneOneAfterAnother) {
  std::atomic<int> done = 0;
  run(3, [&](std::size_t) {
    std::atomic<bool> inner_stops = false;
    run_side_by_side(4, [&](std::size_t) { ++done; }, [] { return true; }, inner_stops);
  });
  EXPECT_EQ(done, 12);
  EXPECT_EQ(num_threads(), 3);
}

}  // namespace
}  // namespace resilin::testing
