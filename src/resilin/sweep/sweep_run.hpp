#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "resilin/sweep/scene_run.hpp"
#include "resilin/sweep/sweep_folder.hpp"

namespace resilin {

/// Hands out the scenes of a shard that are left, one after the other, claimed for this process. Several
/// threads may ask at once.
class SceneQueue {
 public:
  struct Options {
    Shard shard{};
    bool retries_failed = false;
  };
  SceneQueue(SweepFolder& folder, const Options& options) : folder_(folder), options_(options) { rewind(); }

  struct Task {
    std::uint64_t scene;
    SceneHash hash;
  };
  /// Nothing when none is left, or when all that are left are run by others.
  std::optional<Task> next();

  /// How many scenes others were at work on when they were last looked at.
  std::uint64_t num_others() const { return others_; }

 private:
  void rewind() {
    at_ = options_.shard.number - 1;
    others_in_pass_ = 0;
    taken_in_pass_ = false;
  }

  SweepFolder& folder_;
  Options options_;
  std::mutex mutex_;
  std::uint64_t at_ = 0;
  std::uint64_t others_in_pass_ = 0;
  std::atomic<std::uint64_t> others_ = 0;
  bool taken_in_pass_ = false;
  bool is_empty_ = false;
};

/// Selects the scenes of a sweep that run here, and the number of threads.
struct SweepRunOptions {
  SceneQueue::Options queue{};
  int jobs = 0;              ///< scenes at once; 0: see jobs_for
  int threads = 0;           ///< in all; 0: num_threads()
  bool writes_table = true;  ///< results.csv, now and then and at the end
  std::function<bool()> is_stopped =
      {};  ///< asked about ten times a second by the thread that runs the sweep
  /// Called by the same thread as often, and at the end.
  std::function<void(const struct SweepProgress&)> progress = {};
};

/// Progress of a run of a sweep, while it goes on.
struct SweepProgress {
  SweepCount count;  ///< count of the shard, those of earlier runs and of other processes included
  std::uint64_t run = 0, run_failed = 0;  ///< by this one
  std::uint64_t others = 0;               ///< scenes at work in other processes
  double seconds = 0;                     ///< since this run began
  double scene_seconds = 0;               ///< scene seconds of all scenes that it has run together
  int jobs = 1;
  std::string first_failure;  ///< "scene 3 (...): refused: ..."; empty when none has failed
  bool is_stopped = false;
  bool is_table_written = false;

  /// [s]; nothing before a scene has ended.
  std::optional<double> seconds_left() const;
};

/// How many scenes at once so many threads are best used for: one each where scenes are small, else one scene
/// at a time with all of them.
int jobs_for(const Sweep& sweep, int threads);

/// Runs what is left of a shard, `jobs` scenes at once in this process, each with its share of the threads.
///
/// Ends as soon as `is_stopped` says so; scenes that are then on their way are run again the next time.
/// @throws FileError  when the folder cannot be written: what has ended until then is kept
SweepProgress run_sweep(SweepFolder& folder, const SweepRunOptions& options);

}  // namespace resilin
