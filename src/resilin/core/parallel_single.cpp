#include "resilin/core/parallel.hpp"

/// Loops of a program that has one thread.
namespace resilin {

int num_threads() { return 1; }
void set_num_threads(int) {}

ThreadShare::ThreadShare(int, int) : threads_each_(1), count_before_(1) {}
ThreadShare::~ThreadShare() = default;
void ThreadShare::run(const std::function<void()>& job) const { job(); }

void detail::run_tasks(std::size_t count, const std::function<void(std::size_t)>& task) {
  for (std::size_t i = 0; i < count; ++i) task(i);
}

}  // namespace resilin
