#pragma once

#include "resilin/sensitivity/replay.hpp"
#include "resilin/sensitivity/tangent.hpp"
#include "resilin/sensitivity/term_changes.hpp"

namespace resilin {

bool is_zero(const History& history);

/// Derivatives of one step in time by what it starts from and by the numbers of the world: forwards and
/// transposed, from the coefficients of the scheme (docs/theory/gradients.md).
class MotionSteps {
 public:
  /// @param inertia   the number of its term
  /// @param analyses  as in LinearOptions
  MotionSteps(const World& world, const Integrator& scheme, int inertia,
              std::shared_ptr<AnalysisCache> analyses = nullptr)
      : world_(world),
        scheme_(scheme),
        inertia_(inertia),
        tangent_(world, world.solver.kind, std::move(analyses)) {}

  /// Steps follow in their order, or against it.
  void begin();

  /// The change of what the next step starts from.
  /// @param gradient  becomes the change of dE/dx of the last stage, from which reactions follow
  History forward(const StepReplay& step, const History& change, const TermChanges& of_terms,
                  const WorldChange& of_world, VectorX& gradient);

  /// Slopes by what the step started from, out of those by what the next one starts from.
  /// @param w  of dE/dx of the last stage at the fixed unknowns; empty: none
  History transposed(const StepReplay& step, const History& by_next, const VectorX& w, TermChanges& by_terms,
                     WorldChange& by_world);

  // Change of the motion with which the run begins, accelerations among it where the scheme needs them.
  Motion forward_start(const StepReplay& first, const TermChanges& of_terms, const WorldChange& of_world);
  void transposed_start(const StepReplay& first, Motion by_start, TermChanges& by_terms,
                        WorldChange& by_world);

 private:
  /// Change of the accelerations M a = -gradient at a motion, under loads of this time.
  VectorX forward_accelerations(const Motion& at, double time, const Motion& change,
                                const TermChanges& of_terms, const WorldChange& of_world);
  void transposed_accelerations(const Motion& at, double time, Motion& by_motion, TermChanges& by_terms,
                                WorldChange& by_world);
  /// dM a, what changes of the terms do to the mass matrix ...
  VectorX mass_changes(const VectorX& accelerations, const TermChanges& of_terms) const;
  /// ... and the slopes of w . M a.
  void add_mass_slopes(const VectorX& w, const VectorX& accelerations, TermChanges& by_terms) const;

  const World& world_;
  const Integrator& scheme_;
  int inertia_;
  Tangent tangent_;
  std::vector<EarlierSolutions> earlier_;  ///< by stage, of the steps since `begin`
};

}  // namespace resilin
