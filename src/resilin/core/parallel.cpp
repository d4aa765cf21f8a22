#include "resilin/core/parallel.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>

namespace resilin {
namespace {

/// The limit belongs to the process, as the cores do; everything else in the library is a value.
struct ThreadLimit {
  std::mutex mutex;
  std::atomic<int> count = tbb::this_task_arena::max_concurrency();  // read without the lock
  std::unique_ptr<tbb::global_control> control;
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
  limit.count = std::max(count, 1);
  limit.control.reset();
  limit.control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                        static_cast<std::size_t>(limit.count));
}

void detail::run_tasks(std::size_t count, const std::function<void(std::size_t)>& task) {
  tbb::parallel_for(std::size_t{0}, count, task, tbb::simple_partitioner{});
}

}  // namespace resilin
