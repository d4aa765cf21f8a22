#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "resilin/simulation/simulation.hpp"

namespace resilin {

/// The word that the report gives for how a run ended.
enum class RunStatus {
  running,        ///< it did not end: the report is that of a run that goes on or was killed
  done,           ///< end time or full load reached
  not_converged,  ///< the results up to the last converged step are kept
  budget          ///< stopped before its end: by the user, or after --steps
};
std::string_view name(RunStatus status);

/// The folder that a run leaves: report.json, frames/NNNN.vtu, frames.pvd, checkpoint.bin.
///
/// Every file is written beside and renamed, so that a folder always holds whole files. Frames are written at
/// once; report and checkpoint at most about once a second, and by `finish`.
class ResultFolder {
 public:
  /// Makes the folder. Throws FileError naming it when that fails or nothing can be written in it.
  /// @param seconds_before  what the run has taken already, for the report's total
  explicit ResultFolder(std::filesystem::path folder, double seconds_before = 0);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  const std::filesystem::path& path() const;
  double output_seconds() const;  ///< spent on writing

  /// The state to go on from, and takes over the frames up to it. Empty when the folder has no checkpoint.
  /// Throws InputError when there is one that cannot be used.
  std::optional<State> resume();

  /// Records the simulation's present frame when it is due (each `output.every` steps), or when `is_last`.
  void record(const Simulation& simulation, bool is_last);

  /// The same for a state that the simulation had; report and checkpoint wait for `finish`.
  void record(const World& world, const State& state, const Frame& frame, bool is_last);

  /// Writes report and checkpoint with how the run ended.
  void finish(const Simulation& simulation, RunStatus status, const std::string& reason);

 private:
  struct Contents;
  std::unique_ptr<Contents> contents_;
};

}  // namespace resilin
