#include "resilin/sweep/sweep_run.hpp"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <thread>
#include <utility>
#include <vector>

#include "resilin/core/parallel.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A run of a sweep with all that its threads share.
class Run {
 public:
  Run(SweepFolder& folder, const SweepRunOptions& options)
      : folder_(folder), options_(options), queue_(folder, options.queue) {
    const int threads = options.threads > 0 ? options.threads : num_threads();
    progress_.jobs = options.jobs > 0 ? options.jobs : jobs_for(folder.sweep(), threads);
    threads_each_ = std::max(1, threads / progress_.jobs);
    progress_.count = folder.count(options.queue.shard);
  }

  SweepProgress run() {
    std::vector<std::thread> workers;
    {
      const ThreadShare share(progress_.jobs, threads_each_);
      num_working_ = progress_.jobs;
      for (int i = 0; i < progress_.jobs; ++i)
        workers.emplace_back([this, &share] {
          share.run([this] { work(); });
          const std::lock_guard lock(mutex_);
          --num_working_;
          changed_.notify_one();
        });
      watch();
      for (std::thread& worker : workers) worker.join();
    }
    progress_.is_stopped = stops_ && !failure_;
    if (failure_) {
      if (options_.writes_table) try_table();
      std::rethrow_exception(failure_);
    }
    if (options_.writes_table) write_table();
    progress_.others = queue_.num_others();
    progress_.count = folder_.count(options_.queue.shard);  // includes scenes that other processes have ended
    tell();
    return progress_;
  }

 private:
  void work() {
    try {
      while (!stops_) {
        const std::optional<SceneQueue::Task> task = queue_.next();
        if (!task) return;
        if (!run_one(*task)) return folder_.release(task->hash);
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
      stops_ = true;
    }
  }

  /// False when it was stopped.
  bool run_one(const SceneQueue::Task& task) {
    const bool was_failed = folder_.find(task.scene, task.hash).has_value();
    const std::optional<SceneRow> row =
        run_scene(folder_.sweep(), task.scene, folder_.path(), [this] { return stops_.load(); });
    if (!row) return false;
    folder_.append(task.hash, row_line(*row, folder_.sweep()));
    const std::lock_guard lock(mutex_);
    const bool is_done = row->status == SceneStatus::done;
    ++progress_.run;
    progress_.scene_seconds += row->seconds;
    if (was_failed) --progress_.count.failed;
    ++(is_done ? progress_.count.done : progress_.count.failed);
    if (!is_done) {
      ++progress_.run_failed;
      if (progress_.first_failure.empty())
        progress_.first_failure =
            folder_.sweep().name_of(task.scene) + ": " + spelling(row->status) + ": " + row->reason;
    }
    return true;
  }

  /// Tells of the progress until all workers have ended.
  void watch() {
    std::unique_lock lock(mutex_);
    while (num_working_ > 0) {
      changed_.wait_for(lock, std::chrono::milliseconds(100));
      // Shards leave it to their end: together they would write it all the time.
      const bool is_new = progress_.run > rows_in_table_ && options_.queue.shard.count == 1;
      lock.unlock();
      if (options_.is_stopped && options_.is_stopped()) stops_ = true;
      tell();
      if (options_.writes_table && is_new && Clock::now() >= next_table_) try_table();
      lock.lock();
    }
  }

  void tell() {
    if (!options_.progress) return;
    SweepProgress now;
    {
      const std::lock_guard lock(mutex_);
      progress_.seconds = seconds_since(start_);
      now = progress_;
    }
    options_.progress(now);
  }

  /// One now and then, at most for a twentieth of the time; what goes wrong is seen at the end.
  void try_table() {
    try {
      write_table();
    } catch (const std::exception&) {
      next_table_ = Clock::now() + std::chrono::minutes(1);
    }
  }

  void write_table() {
    const Clock::time_point begin = Clock::now();
    {
      const std::lock_guard lock(mutex_);
      rows_in_table_ = progress_.run;
    }
    progress_.is_table_written = folder_.write_table();
    const double pause = std::max(10.0, 20 * seconds_since(begin));
    next_table_ =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pause));
  }

  SweepFolder& folder_;
  const SweepRunOptions& options_;
  SceneQueue queue_;
  SweepProgress progress_;
  int threads_each_ = 1;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_table_ = start_ + std::chrono::seconds(10);
  std::uint64_t rows_in_table_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  int num_working_ = 0;
  std::atomic<bool> stops_ = false;
  std::exception_ptr failure_;
};

}  // namespace

std::optional<SceneQueue::Task> SceneQueue::next() {
  const std::lock_guard lock(mutex_);
  const Sweep& sweep = folder_.sweep();
  while (!is_empty_) {
    for (; at_ < sweep.size(); at_ += options_.shard.count) {
      const SceneHash hash = sweep.hash(at_);
      const SweepFolder::Claim claim = folder_.claim(at_, hash, options_.retries_failed);
      if (claim == SweepFolder::Claim::others) ++others_in_pass_;
      if (claim != SweepFolder::Claim::taken) continue;
      taken_in_pass_ = true;
      const Task task{at_, hash};
      at_ += options_.shard.count;
      return task;
    }
    others_ = others_in_pass_;
    // Another may have given up in the meantime: look again, unless nothing was to be had.
    if (others_in_pass_ == 0 || !taken_in_pass_) is_empty_ = true;
    rewind();
  }
  return std::nullopt;
}

std::optional<double> SweepProgress::seconds_left() const {
  if (run == 0) return std::nullopt;
  return seconds / static_cast<double>(run) * static_cast<double>(count.left());
}

int jobs_for(const Sweep& sweep, int threads) {
  constexpr std::size_t small = 20000;  // vertices
  std::size_t vertices = 0;
  try {
    for (const BodyDescription& body : sweep.scene(0).description.bodies)
      vertices += body.mesh.vertices.size();
  } catch (const InputError&) {  // its row will say so
  }
  return vertices > small
             ? 1
             : static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(threads),
                                                        std::max<std::uint64_t>(sweep.size(), 1)));
}

SweepProgress run_sweep(SweepFolder& folder, const SweepRunOptions& options) {
  return Run(folder, options).run();
}

}  // namespace resilin
