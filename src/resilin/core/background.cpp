#include "resilin/core/background.hpp"

#include <tbb/task_arena.h>

#include <cmath>
#include <memory>
#include <system_error>
#include <utility>

#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

std::future<void> run_here(const std::function<void()>& job) {
  std::packaged_task<void()> task([&job] { job(); });
  std::future<void> end = task.get_future();
  task();
  return end;
}

}  // namespace

std::future<void> run_beside(std::function<void()> job) {
  if (num_threads() == 1 || !std::isinf(address_space_left().bytes)) return run_here(job);
  const auto shared_job = std::make_shared<const std::function<void()>>(std::move(job));  // may hold a lot
  try {
    return std::async(std::launch::async, [shared_job] {
      tbb::task_arena arena(1);
      arena.execute(*shared_job);
    });
  } catch (const std::system_error&) {  // no thread is to be had
    return run_here(*shared_job);
  }
}

}  // namespace resilin
