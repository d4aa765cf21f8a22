#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "resilin/io/atomic_file.hpp"
#include "resilin/results/results.hpp"
#include "resilin/results/run.hpp"

namespace resilin::testing {

/// Runs `steps` steps (0: to the end) into a folder, from its checkpoint where there is one.
inline RunOutcome run_into(const std::filesystem::path& folder, const Description& scene, int steps,
                           Resume resume = Resume::same_scene) {
  Simulation simulation(scene);
  ResultFolder results(folder);
  results.resume(simulation, resume);
  results.record(simulation, false);
  const RunOutcome outcome = run_to_end(simulation, {.after_step =
                                                         [&](const StepReport&) {
                                                           if (simulation.is_finished())
                                                             return results.record(simulation, true);
                                                           results.record(simulation, false);
                                                         },
                                                     .max_steps = steps});
  results.record(simulation, true);
  results.finish(simulation, outcome);
  return outcome;
}

/// Every kind of file that a run leaves, by its name, but those that hold times.
inline std::map<std::string, std::string> files_in(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = std::filesystem::relative(entry.path(), folder).string();
    if (entry.is_regular_file() && name != "report.json" && name != "result.html")
      files[name] = read_file(entry.path());
  }
  return files;
}

}  // namespace resilin::testing
