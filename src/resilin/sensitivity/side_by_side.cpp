#include "resilin/sensitivity/side_by_side.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr auto between_looks = std::chrono::milliseconds(20);

class Tasks {
 public:
  Tasks(std::size_t count, const std::function<void(std::size_t)>& task, std::atomic<bool>& stops)
      : count_(count), task_(task), stops_(stops) {}

  void run(int threads, const std::optional<ThreadShare>& share, const std::function<bool()>& goes_on) {
    num_working_ = threads;
    std::vector<std::thread> workers;
    for (int i = 0; i < threads; ++i)
      workers.emplace_back([this, &share] {
        if (share)
          share->run([this] { work(); });
        else
          work();
        const std::lock_guard lock(mutex_);
        --num_working_;
        changed_.notify_one();
      });
    watch(goes_on);
    for (std::thread& worker : workers) worker.join();
    if (stops_) throw Interrupted();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  // Tasks are taken in order, and none is left out whose number is below that of one that failed.
  void work() {
    for (std::size_t i = next_++; i < count_ && i < failed_ && !stops_; i = next_++) {
      try {
        task_(i);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (i > failed_) continue;
        failure_ = std::current_exception();
        failed_ = i;
      }
    }
  }

  void watch(const std::function<bool()>& goes_on) {
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, between_looks, [this] { return num_working_ == 0; })) {
      lock.unlock();
      if (!stops_ && !goes_on()) stops_ = true;
      lock.lock();
    }
  }

  std::size_t count_;
  const std::function<void(std::size_t)>& task_;
  std::atomic<bool>& stops_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<std::size_t> failed_ = std::numeric_limits<std::size_t>::max();
  std::mutex mutex_;
  std::condition_variable changed_;
  int num_working_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

void run_side_by_side(std::size_t count, const std::function<void(std::size_t)>& task,
                      const std::function<bool()>& goes_on, std::atomic<bool>& stops) {
  static std::mutex sharing;  // the number of threads is one of the process
  const std::unique_lock lock(sharing, std::try_to_lock);
  std::optional<ThreadShare> share;
  int jobs = 1;
  if (lock.owns_lock()) {
    const int threads = num_threads();
    jobs = static_cast<int>(std::clamp<std::size_t>(count, 1, static_cast<std::size_t>(threads)));
    share.emplace(jobs, std::max(1, threads / jobs));
  }
  Tasks(count, task, stops).run(jobs, share, goes_on);
}

}  // namespace resilin
