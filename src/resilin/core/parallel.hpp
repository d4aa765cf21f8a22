#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace resilin {

/// Number of threads that loops use; all cores unless `set_num_threads` was called. Fewer where the address
/// space of the process is limited (ulimit -v) and has no room for so many: each needs some 256 MiB of it.
int num_threads();

/// Limits every later loop to `count` threads (at least 1). Not to be called inside a loop.
void set_num_threads(int count);

/// The threads shared out between `jobs` computations that go on at once, `threads_each` for each of them,
/// until the end of its life: neither more threads than jobs * threads_each at work nor jobs that wait for
/// each other's.
class ThreadShare {
 public:
  ThreadShare(int jobs, int threads_each);
  ~ThreadShare();
  ThreadShare(const ThreadShare&) = delete;
  ThreadShare& operator=(const ThreadShare&) = delete;

  /// Calls `job` in a thread of the caller's own; its loops use no more than `threads_each`.
  void run(const std::function<void()>& job) const;

 private:
  int threads_each_;
  int count_before_;
};

namespace detail {
void run_tasks(std::size_t count, const std::function<void(std::size_t)>& task);
}

/// Calls `body(begin, end)` for consecutive chunks of [0, size). Chunks depend on `chunk_size` alone, never
/// on the number of threads, so that whatever a chunk computes is the same on every machine.
template <class Body>
void parallel_for(std::size_t size, std::size_t chunk_size, const Body& body) {
  const std::size_t num_chunks = (size + chunk_size - 1) / chunk_size;
  const auto run_chunk = [&](std::size_t chunk) {
    const std::size_t begin = chunk * chunk_size;
    body(begin, begin + chunk_size < size ? begin + chunk_size : size);
  };
  if (num_chunks <= 1 || num_threads() == 1) {
    for (std::size_t chunk = 0; chunk < num_chunks; ++chunk) run_chunk(chunk);
  } else {
    detail::run_tasks(num_chunks, run_chunk);
  }
}

/// Runs `task(i)` for i in [0, count), in any order and at the same time.
template <class Task>
void parallel_tasks(std::size_t count, const Task& task) {
  if (count <= 1 || num_threads() == 1) {
    for (std::size_t i = 0; i < count; ++i) task(i);
  } else {
    detail::run_tasks(count, task);
  }
}

/// Sum of `body(begin, end)` over the chunks of [0, size), added in the order of the chunks: the same bits
/// for any number of threads. `T` needs `T{}` and `+=`.
template <class T, class Body>
T parallel_sum(std::size_t size, std::size_t chunk_size, const Body& body) {
  const std::size_t num_chunks = (size + chunk_size - 1) / chunk_size;
  std::vector<T> partial(num_chunks, T{});
  parallel_for(size, chunk_size,
               [&](std::size_t begin, std::size_t end) { partial[begin / chunk_size] = body(begin, end); });
  T sum{};
  for (const T& part : partial) sum += part;
  return sum;
}

/// Calls `take(begin, make(begin, end))` for the chunks of [0, size): what many threads have made is taken by
/// one, in the order of the chunks. What some chunks make is held at once.
template <class Make, class Take>
void parallel_in_order(std::size_t size, std::size_t chunk_size, const Make& make, const Take& take) {
  constexpr std::size_t chunks_at_once = 64;
  const std::size_t batch_size = chunks_at_once * chunk_size;
  for (std::size_t first = 0; first < size; first += batch_size) {
    const std::size_t count = std::min(batch_size, size - first);
    std::vector<decltype(make(first, first))> made((count + chunk_size - 1) / chunk_size);
    parallel_for(count, chunk_size, [&](std::size_t begin, std::size_t end) {
      made[begin / chunk_size] = make(first + begin, first + end);
    });
    for (std::size_t chunk = 0; chunk < made.size(); ++chunk) take(first + chunk * chunk_size, made[chunk]);
  }
}

/// Sorts in an order that leaves no two items equal, so that the result is the same on every machine.
template <class Item, class Less>
void parallel_sort(std::vector<Item>& items, const Less& less) {
  constexpr std::size_t num_parts = 16, least_items = 4096;
  const std::size_t size = items.size();
  if (size < least_items) return std::sort(items.begin(), items.end(), less);
  const auto at = [&](std::size_t part) {
    return items.begin() + static_cast<std::ptrdiff_t>(size * std::min(part, num_parts) / num_parts);
  };
  parallel_tasks(num_parts, [&](std::size_t part) { std::sort(at(part), at(part + 1), less); });
  for (std::size_t width = 1; width < num_parts; width *= 2)
    parallel_tasks(num_parts / (2 * width), [&](std::size_t pair) {
      const std::size_t first = 2 * pair * width;
      std::inplace_merge(at(first), at(first + width), at(first + 2 * width), less);
    });
}

}  // namespace resilin
