#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "resilin/results/checkpoint.hpp"
#include "resilin/results/summary.hpp"
#include "resilin/simulation/simulation.hpp"

namespace resilin {

/// Fields of the scene, and then those that the page shows: the report has the ranges of both.
std::vector<std::string> fields_of_report(const World& world);

/// The folder that a run leaves: report.json, frames/NNNN.vtu, frames.pvd, where there are colliders
/// colliders/NNNN.vtu and colliders.pvd, checkpoint.bin and, as output.formats asks, recording.bin and
/// result.html, result.usda. It records one world, which must outlive it.
///
/// Every file is written beside and renamed, so that a folder always holds whole files. Frames are written at
/// once, or beside the next step where loops have more than one thread; report and checkpoint at most about
/// once a second, and by `finish`. What cannot be written is then told by the next call. As long as this
/// lives no other run writes into the folder.
class ResultFolder {
 public:
  /// Makes the folder and sweeps up what a killed run has left half-written. Throws FileError naming it when
  /// that fails, nothing can be written in it or another run writes into it.
  /// @param seconds_before  what the run has taken already, for the report's total
  explicit ResultFolder(std::filesystem::path folder, double seconds_before = 0);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  const std::filesystem::path& path() const;
  double output_seconds() const;  ///< waiting time of the run for its output

  /// Files of `finish` for viewing: names and sizes [bytes].
  const std::vector<std::pair<std::string, std::uintmax_t>>& shown_files() const;

  /// The run that has left the folder without ending (it was killed), in words; empty when none has.
  const std::string& previous_holder() const;

  /// Goes on from the checkpoint in the folder and takes over the frames up to it; not at all when there is
  /// none. Throws InputError when there is one that cannot be used, or one of another scene.
  struct Resumed {
    bool has_checkpoint = false;
    std::optional<std::string> difference;  ///< to the scene of the checkpoint, in words; gone on from anyway
  };
  Resumed resume(Simulation& simulation, Resume rule);

  /// Records the simulation's present frame when it is due (each `output.every` steps), or when `is_last`.
  void record(const Simulation& simulation, bool is_last);

  /// The same for a state that the simulation had; report and checkpoint wait for `finish`.
  void record(const World& world, const State& state, const Frame& frame, bool is_last);

  /// Adds a state with its entry of the report's "frames", as JSON.
  void add(const World& world, const State& state, const std::string& frame);

  /// Writes report and checkpoint with how the run ended.
  void finish(const Simulation& simulation, const RunOutcome& outcome);

  /// The same for a run that has ended already in this state.
  void finish(const World& world, const State& state, const RunSummary& summary);

 private:
  struct Contents;
  std::unique_ptr<Contents> contents_;
};

}  // namespace resilin
