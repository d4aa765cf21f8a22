#include "resilin/sweep/scene_run.hpp"

#include <exception>
#include <new>
#include <system_error>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/stopwatch.hpp"
#include "resilin/results/results.hpp"
#include "resilin/results/run.hpp"
#include "resilin/sweep/sweep_folder.hpp"

namespace resilin {
namespace {

/// Failure to write files of a scene; all else of the scene is told.
struct WriteFailed {
  FileError error;
};

/// The folder of results while it grows: PATH.partial, which becomes PATH.
class GrowingFolder {
 public:
  explicit GrowingFolder(std::filesystem::path path) : path_(std::move(path)), partial_(path_) {
    partial_ += ".partial";
    try {
      std::filesystem::remove_all(partial_);  // files of a process that was killed
      results_.emplace(partial_);
    } catch (const FileError& error) {
      throw WriteFailed{error};
    } catch (const std::filesystem::filesystem_error& error) {
      throw WriteFailed{FileError(partial_.string(), "cannot be removed: " + error.code().message())};
    }
  }
  ~GrowingFolder() {
    results_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(partial_, ignored);
  }
  GrowingFolder(const GrowingFolder&) = delete;
  GrowingFolder& operator=(const GrowingFolder&) = delete;

  void record(const Simulation& simulation, bool is_last) {
    try {
      results_->record(simulation, is_last);
    } catch (const FileError& error) {
      throw WriteFailed{error};
    }
  }

  void finish(const Simulation& simulation, const RunOutcome& outcome) {
    try {
      results_->finish(simulation, outcome);
      results_.reset();  // gives its lock back
      std::filesystem::remove_all(path_);
      std::filesystem::rename(partial_, path_);
    } catch (const FileError& error) {
      throw WriteFailed{error};
    } catch (const std::filesystem::filesystem_error& error) {
      throw WriteFailed{FileError(path_.string(), "cannot be written: " + error.code().message())};
    }
  }

 private:
  std::filesystem::path path_;
  std::filesystem::path partial_;
  std::optional<ResultFolder> results_;
};

/// False when it was stopped.
bool simulate(const Sweep& sweep, SceneRow& row, const std::filesystem::path& sweep_folder,
              const std::function<bool()>& is_stopped) {
  Scene scene = sweep.scene(row.scene);
  Simulation simulation(World(std::move(scene.description)), sweep.analyses());
  row.unknowns = simulation.world().num_free_unknowns();
  std::optional<GrowingFolder> folder;
  if (!sweep_folder.empty() && sweep.kept().may_have(row.scene))
    folder.emplace(kept_path(sweep_folder, row.hash));
  QuantityRecorder quantities(sweep.quantities(), simulation.world());
  quantities.record(simulation);
  if (folder) folder->record(simulation, false);
  const auto after_step = [&](const StepReport& report) {
    row.newton_iterations += report.newton.iterations;
    quantities.record(simulation);
    if (folder) folder->record(simulation, simulation.is_finished());
  };
  const RunOutcome outcome = run_to_end(simulation, {.is_stopped = is_stopped, .after_step = after_step});
  if (outcome.status == RunStatus::budget) return false;
  quantities.finish(simulation);
  row.quantities = quantities.values();
  row.steps = simulation.state().step;
  row.status = outcome.status == RunStatus::done ? SceneStatus::done : SceneStatus::not_converged;
  row.reason = outcome.reason;
  row.is_kept = folder && sweep.kept().has(row.scene, row.status == SceneStatus::done);
  if (row.is_kept) {
    folder->record(simulation, true);
    folder->finish(simulation, outcome);
  }
  return true;
}

}  // namespace

std::optional<SceneRow> run_scene(const Sweep& sweep, std::uint64_t number,
                                  const std::filesystem::path& folder,
                                  const std::function<bool()>& is_stopped) {
  SceneRow row;
  row.scene = number;
  row.hash = sweep.hash(number);
  const auto fail = [&row](SceneStatus status, const std::string& reason) {
    row.status = status;
    row.reason = reason;
    row.quantities.clear();
  };
  {
    const Stopwatch stopwatch(row.seconds);
    try {
      if (!simulate(sweep, row, folder, is_stopped)) return std::nullopt;
    } catch (const WriteFailed& failure) {
      throw failure.error;
    } catch (const InputError& error) {
      fail(SceneStatus::refused, error.what());
    } catch (const std::bad_alloc& error) {
      fail(SceneStatus::failed, out_of_memory_text(error));
    } catch (const std::exception& error) {
      fail(SceneStatus::failed, std::string("internal error: ") + error.what());
    }
  }
  if (sweep.hash(number) != row.hash)
    throw InputError(sweep.place(), "files that stay as they are while the sweep runs",
                     "one that has changed during " + sweep.name_of(number), "run the sweep again");
  return row;
}

}  // namespace resilin
