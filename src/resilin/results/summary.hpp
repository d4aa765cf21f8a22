#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "resilin/fields/discretisation_error.hpp"
#include "resilin/simulation/simulation.hpp"
#include "resilin/simulation/support_stiffness.hpp"

namespace resilin {

/// The word that the report gives for how a run ended.
enum class RunStatus {
  running,        ///< it did not end: the report is that of a run that goes on or was killed
  done,           ///< end time or full load reached
  not_converged,  ///< the results up to the last converged step are kept
  failed,         ///< an error ended it, such as a full disk
  budget          ///< stopped before its end: by the user, or after --steps
};
/// Word of a status in report.json.
std::string_view name(RunStatus status);

/// Final status of a run, with the reason in words.
struct RunOutcome {
  RunStatus status = RunStatus::done;
  std::string reason;
  std::vector<std::string> warnings{};           ///< warnings about the run, one line each
  DiscretisationErrors discretisation_errors{};  ///< estimates for the bodies, in their most strained state
  double estimate_seconds = 0;                   ///< the time that these took
  std::vector<SupportStiffness> stiffness{};  ///< tangent stiffness of supports that ask for it, at the end
};

/// Report of a whole run.
struct RunSummary {
  RunOutcome outcome;
  std::string solver;
  FailedSteps failed_steps;
  MostStrained most_strained;
  Timing timing;
  double total_seconds = 0;
  double output_seconds = 0;
};

/// Collects the entries of a report that concern the whole run.
inline RunSummary summary_of(const Simulation& simulation, const RunOutcome& outcome, double total_seconds,
                             double output_seconds) {
  return {.outcome = outcome,
          .solver = std::string(simulation.solver_name()),
          .failed_steps = simulation.failed_steps(),
          .most_strained = simulation.most_strained(),
          .timing = simulation.timing(),
          .total_seconds = total_seconds,
          .output_seconds = output_seconds};
}

}  // namespace resilin
