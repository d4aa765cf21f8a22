#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "resilin/petsc/shared_scene.hpp"
#include "resilin/results/checkpoint.hpp"
#include "resilin/results/summary.hpp"
#include "resilin/simulation/simulation.hpp"

namespace resilin {

/// The folder that a run on several processes leaves: report.json and checkpoint.bin as one process writes
/// them, by the first, which gathers one state for that; frames/NNNN.pvtu with the piece of each process in
/// frames/NNNN, and frames.pvd. All processes call the same functions.
class SharedResults {
 public:
  /// Makes the folder. Throws AgreedError where that fails, or another run writes into it.
  /// @param scene  kept by reference
  SharedResults(std::filesystem::path folder, const SharedScene& scene, double seconds_before);
  ~SharedResults();
  SharedResults(const SharedResults&) = delete;
  SharedResults& operator=(const SharedResults&) = delete;

  struct Resumed {
    bool has_checkpoint = false;
    std::optional<std::string> difference;  ///< to the scene of the checkpoint, in words
  };
  /// Goes on from the checkpoint in the folder, of any number of processes. Throws AgreedError.
  Resumed resume(Simulation& simulation, Resume rule);

  void record(const Simulation& simulation, bool is_last);
  void finish(const Simulation& simulation, const RunOutcome& outcome);

  double output_seconds() const;

 private:
  struct Contents;
  std::unique_ptr<Contents> contents_;
};

}  // namespace resilin
