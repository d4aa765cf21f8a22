#pragma once

#include <optional>
#include <string>
#include <vector>

#include "resilin/core/members.hpp"
#include "resilin/optimize/newton.hpp"
#include "resilin/world/linear_problem.hpp"
#include "resilin/world/world.hpp"

/// Data that steps in time and in load have in common.
namespace resilin {

struct StageReport;

/// How friction settled in the stages of a step.
struct FrictionReport {
  int rounds = 0;            ///< searches that went on with normal forces formed anew
  int unsettled_stages = 0;  ///< stages whose forces do not balance the friction of where they ended
  double mismatch = 0;       ///< the most that is out of balance, beside the forces that act

  void add(const StageReport& stage);
  void add(const FrictionReport& part);
};

/// Outcome of one time step or load step.
struct StepReport {
  enum class Status {
    converged,
    not_converged,  ///< motion: the step was cut short, safely; statics: no smaller load step helped
    interrupted,    ///< the observer asked to stop; the state is that before the step
  };
  Status status = Status::converged;
  std::string reason;              ///< in words, with the place of the worst residual or the worst element
  bool has_solution = true;        ///< motion: one was found, or newton.max_iterations cut the search short
  NewtonReport newton;             ///< summed over the stages and attempts of the step
  int failed_attempts = 0;         ///< steps that were tried before, too long
  double time_step = 0;            ///< motion: length of the step [s]
  bool by_backward_euler = false;  ///< motion: in place of another scheme, which would have added energy
  double removed_energy = 0;       ///< motion: taken out of the velocities, lest the step add it [J]
  FrictionReport friction;
  /// Motion: where the stages of its last part ended but the last one, from which the step's end follows [m].
  std::vector<VectorX> stage_places{};
  double time_error = 0;  ///< motion with adaptive steps: about how far the step misplaced a vertex [m]
  std::optional<Index> unstable_modes;  ///< statics: negative eigenvalues of the stiffness, where counted
  double jump_energy = 0;               ///< statics: lost in a jump to another equilibrium; 0: none [J]
  std::optional<Inversion> inversion;   ///< linear statics: where a cell is first turned inside out
  std::vector<std::string> warnings;    ///< one line each
};

/// Adds the counts and times of `part` to those of `sum`.
void add_counts(NewtonReport& sum, const NewtonReport& part);
/// The same; everything else `sum` takes from `part`.
void add_to(NewtonReport& sum, const NewtonReport& part);

/// Settings of Newton's method in the scene.
NewtonSettings newton_settings(const World& world);

/// Makes x the one of two starts with the lower objective, so that a step cut short never has pumped energy
/// in. At fixed unknowns the candidate takes the values of `held`.
/// @return whether it is the candidate
bool choose_lower_start(Objective& objective, std::span<const std::uint8_t> is_fixed, const VectorX& held,
                        VectorX candidate, VectorX& x);

/// Why a search ended: with the place of the largest residual, where the material of that body suffers most,
/// and cells of other bodies that are all but flat. Places are those of the rest shapes.
std::string describe_failure(const World& world, const NewtonReport& report, const VectorX& positions);

/// Why a stage is not solved whose friction has not settled.
std::string describe_unsettled_friction(const StageReport& stage);

/// "; gent ends where ...", for a body of a law whose energy ends at a stretch; else empty.
std::string describe_limit(const Body& body);

/// Steps of a run that did not converge and were gone on from, those before a restart included.
struct FailedSteps {
  int count = 0;
  int in_a_row = 0;  ///< number of the last ones in a row for which there seems to be no solution
  int first_step = 0;
  double first_time = 0;     ///< at its end [s]
  std::string first_reason;  ///< in words
};
RESILIN_MEMBERS(FailedSteps, count, in_a_row, first_step, first_time, first_reason)

}  // namespace resilin
