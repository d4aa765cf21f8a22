#include "resilin/core/parallel.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>

#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/thread_count.hpp"

namespace resilin {
namespace {

/// Where the address space is limited a thread may find no room for its stack, its heap and the buffer of the
/// BLAS, which oneTBB does not survive: as many as there is room for, and room left for what they work on.
int threads_with_room(int wanted) {
  constexpr double bytes_each = 256.0 * (1 << 20);
  const double fitting = address_space_left().bytes / bytes_each;
  return fitting < wanted ? std::max(1, static_cast<int>(fitting)) : wanted;
}

/// Number of threads that RESILIN_THREADS asks for, else the number of cores.
int wanted_threads() {
  const char* const variable = std::getenv("RESILIN_THREADS");
  const std::string text = variable == nullptr ? "" : variable;
  if (text.empty()) return tbb::this_task_arena::max_concurrency();
  int count = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, count);
  if (error != std::errc() || rest != end || count < 1 || count > max_threads)
    throw InputError("environment variable RESILIN_THREADS",
                     "a whole number from 1 to " + std::to_string(max_threads), '"' + text + '"',
                     "correct it or unset it");
  return count;
}

/// The limit belongs to the process, as the cores do; everything else in the library is a value.
struct ThreadLimit {
  std::mutex mutex;
  std::atomic<int> count = threads_with_room(wanted_threads());  // read without the lock
  std::unique_ptr<tbb::global_control> control;

  ThreadLimit() {
    if (count != tbb::this_task_arena::max_concurrency()) enforce();
  }
  void enforce() { enforce(count); }
  void enforce(int threads) {
    control.reset();
    control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<std::size_t>(threads));
  }
};

ThreadLimit& thread_limit() {
  static ThreadLimit limit;
  return limit;
}

}  // namespace

int num_threads() { return thread_limit().count; }

void set_num_threads(int count) {
  ThreadLimit& limit = thread_limit();
  const std::lock_guard lock(limit.mutex);
  limit.count = threads_with_room(std::max(count, 1));
  limit.enforce();
}

ThreadShare::ThreadShare(int jobs, int threads_each)
    : threads_each_(threads_each), count_before_(num_threads()) {
  ThreadLimit& limit = thread_limit();
  const std::lock_guard lock(limit.mutex);
  limit.count = threads_each_;
  limit.enforce(threads_with_room(std::max(jobs, 1) * threads_each_));
}

ThreadShare::~ThreadShare() { set_num_threads(count_before_); }

void ThreadShare::run(const std::function<void()>& job) const {
  if (threads_each_ == 1) return job();  // its loops start no tasks
  tbb::task_arena arena(threads_each_);
  arena.execute(job);
}

void detail::run_tasks(std::size_t count, const std::function<void(std::size_t)>& task) {
  tbb::parallel_for(std::size_t{0}, count, task, tbb::simple_partitioner{});
}

}  // namespace resilin
