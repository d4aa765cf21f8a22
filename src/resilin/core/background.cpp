#include "resilin/core/background.hpp"

#include <tbb/task_arena.h>

#include <cmath>
#include <system_error>
#include <utility>

#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"

namespace resilin {

std::future<void> run_beside(std::function<void()> job) {
  const auto job_alone = [job] {
    tbb::task_arena arena(1);
    arena.execute(job);
  };
  if (num_threads() > 1 && std::isinf(address_space_left().bytes)) {
    try {
      return std::async(std::launch::async, job_alone);
    } catch (const std::system_error&) {  // no thread is to be had
    }
  }
  std::packaged_task<void()> task(std::move(job));
  std::future<void> end = task.get_future();
  task();
  return end;
}

}  // namespace resilin
