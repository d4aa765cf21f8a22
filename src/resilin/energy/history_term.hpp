#pragma once

#include <memory>

#include "resilin/core/types.hpp"
#include "resilin/integrator/stage.hpp"

namespace resilin {

class Energy;

/// The capability of a term that depends on what happened before: it owns internal variables, such as the
/// stresses of a viscoelastic material at its quadrature points. `Energy::history_term` tells who has it.
///
/// The term itself never changes. A `State` holds the internal variables beside positions and velocities
/// (State::history), those of one term after another; all zero in the reference configuration. They advance
/// when a step is accepted, so that a step that is tried again begins with the same ones.
class HistoryTerm {
 public:
  virtual ~HistoryTerm() = default;

  virtual Eigen::Index num_history_values() const = 0;

  /// The term for one stage of a step that begins with `history`; the stage says how much later its unknown
  /// is (Stage::elapsed). With no time elapsed internal variables are frozen: its gradient at the positions
  /// of the state is the force there.
  virtual std::unique_ptr<Energy> begin_stage_after(const VectorX& history, const Stage& stage) const = 0;

  struct Advance {
    VectorX history;  ///< at the end of the step
    double heat = 0;  ///< work of the step that is not stored in `stored_energy` [J]
  };
  /// After a step of `duration` [s] in which bodies have come from one shape to another.
  virtual Advance advance(const VectorX& history, const VectorX& from, const VectorX& to,
                          double duration) const = 0;

  /// Energy that depends on the shape alone and comes back in full, for reports [J]; and its change.
  virtual double stored_energy(const VectorX& x) const = 0;
  virtual double stored_difference(const VectorX& from, const VectorX& to) const = 0;
};

}  // namespace resilin
