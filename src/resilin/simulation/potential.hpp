#pragma once

#include <memory>
#include <span>
#include <vector>

#include "resilin/contact/collider_motion.hpp"
#include "resilin/optimize/led_motion.hpp"
#include "resilin/optimize/objective.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The sum of energies at given conditions in one stage of a step, in motion or in statics: what Newton
/// minimises, and the one place where terms are added up.
class Potential final : public Objective, public LedMotion {
 public:
  /// The potential of any terms; a world has `at` and `in_stage`.
  /// @param terms, is_fixed  kept by reference
  /// @param share            what this process has of the scene; sums are those over all processes
  /// @param history          State::history at the start of the step; empty: the reference configuration's
  /// @param dependents       unknowns that follow from others, fixed ones among `is_fixed`; null: none
  Potential(std::span<const std::shared_ptr<const Energy>> terms, std::span<const std::uint8_t> is_fixed,
            const Conditions& conditions, const Stage& stage, ProcessGroup share = {}, VectorX history = {},
            const Dependents* dependents = nullptr);

  /// The potential of a world in a state as it is, internal variables frozen.
  static Potential at(const World& world, const State& state);
  /// Likewise of a world whose terms keep no history.
  static Potential at(const World& world, const Conditions& conditions, const VectorX& positions);
  /// The potential of a world in one stage of a step from `start`. The world's terms are kept by reference.
  static Potential in_stage(const World& world, const State& start, const Conditions& conditions,
                            const Stage& stage) {
    return in_stage(world, start.history, conditions, stage);
  }
  static Potential in_stage(const World& world, const VectorX& history, const Conditions& conditions,
                            const Stage& stage) {
    return {world.terms, world.is_fixed, conditions, stage, world.share, history, world.dependents()};
  }

  const Conditions& conditions() const { return conditions_; }
  /// Within the stage: what lags stays where it is.
  void set_conditions(const Conditions& conditions) { conditions_ = conditions; }

  /// Updates quantities that terms keep of a known shape, the normal forces of friction, to x. Before
  /// the first time there is none of it. @return whether that may have changed forces
  bool form_lag(const VectorX& x) override;
  bool relax_lag() override;
  void couple_lag(bool is_coupled) override;
  void follow(const VectorX& x, const VectorX& p, double t) override;

  void prepare(const VectorX& x, const VectorX& p) override;
  double difference(const VectorX& from, const VectorX& to) const override;
  double magnitude(const VectorX& x) const override;
  const Dependents* dependents() const override { return dependents_; }
  /// With the forces at dependent unknowns added to those that they follow.
  void gradient(const VectorX& x, VectorX& gradient) const override;
  void gradient_magnitude(const VectorX& x, VectorX& magnitude) const override;
  void hessian(const VectorX& x, Projection projection, BlockMatrix& hessian) const override;
  VectorX internal_values(const VectorX& x) const override;
  VectorX predicted_internal_values(const VectorX& x, const VectorX& p, double t) const override;
  void hessian_at(const VectorX& internal, const VectorX& x, Projection projection,
                  BlockMatrix& hessian) const override;
  /// No where a pressure follows an open surface whose edge is free: its tangent is then not symmetric.
  bool has_potential(const VectorX& x) const override;
  double max_step(const VectorX& x, const VectorX& p) const override;
  bool add_second_order_forces(const VectorX& x, const VectorX& p, VectorX& forces) const override;

  /// The largest of: each term but the elastic ones, the reactions; each as the norm over a part [N].
  VectorX force_scales(const VectorX& x, const VectorX& gradient,
                       const ConnectedComponents& parts) const override;
  VectorX distinct_acting_scales(const VectorX& x, const VectorX& roundings,
                                 const ConnectedComponents& parts) const override;

  /// In order, those of the stage in place of those that they were made of.
  std::span<const Energy* const> terms() const { return terms_; }

  // ---- parts of the sum
  double energy(EnergyCategory category, const VectorX& x) const;  ///< [J]
  double difference_without(EnergyCategory category, const VectorX& from, const VectorX& to) const;
  VectorX gradient_of(EnergyCategory category, const VectorX& x) const;
  VectorX impulses(const VectorX& x) const;  ///< gradients of what acts as an impulse
  /// Heat of friction in the stage, whose forces are those of its end [J].
  /// @param from      where the stage before ended
  /// @param duration  since then [s]
  double heat_of_friction(const VectorX& from, const VectorX& x, double duration) const;
  std::vector<VectorX> gradients_without(EnergyCategory category, const VectorX& x) const;  ///< term by term
  struct Gain {
    double beyond_work = 0;  ///< [J]
    bool is_driven = false;  ///< something did work by itself
  };
  /// E(to) at the present conditions less E(from) at those before, less the work of what drives terms by
  /// itself; of terms with internal variables the stored energy, without their heat.
  Gain gain(const VectorX& from, const Conditions& before, const VectorX& to) const;
  /// The energy at x is finite.
  bool is_in_domain(const VectorX& x) const override;
  /// How far behind terms that move by themselves have to be when bodies stand at x, at most
  /// `conditions().delay` [s].
  double least_delay(const VectorX& x) const;

  // ---- colliders that move by themselves, `conditions().delay` behind

  /// They are where they should be at once, if on their way none meets or leaves anything while bodies stand
  /// at x; else a search leads them there, as it does supports.
  void lead_colliders(int dim, const VectorX& x);
  double way_left() const override { return leads_colliders_ ? conditions_.delay : 0; }
  void set_way_left(double way) override { conditions_.delay = way; }
  void leave_way() override { leads_colliders_ = false; }
  bool has_room(const VectorX& x) const override { return smallest_relative_gap(x) > least_relative_gap_; }
  bool find_room_in_balance(const VectorX& x) override;
  void prepare_along(const VectorX& x, const VectorX& p, double way) override;
  double max_step_along(const VectorX& x, const VectorX& p, double way) const override;
  bool add_second_order_forces_along(const VectorX& x, const VectorX& p, double way,
                                     VectorX& forces) const override;
  void add_pull(const VectorX& x, double way, Projection projection, BlockMatrix& room,
                VectorX& forces) const override;

 private:
  /// Adds the Hessian of one term, and the matrices that it takes along.
  void add_hessian_of(std::size_t i, const VectorX& internal, const VectorX& x, Projection projection,
                      BlockMatrix& hessian) const;
  /// From the place of a term's own motion to the one that is `way` further; none for a term that stays.
  std::optional<RigidPlace> own_way(const Energy& term, double way) const;
  /// The step p as a collider sees it that goes on by a rigid motion meanwhile.
  VectorX seen_from(const RigidPlace& own_way, const VectorX& x, const VectorX& p) const;
  /// The smallest gap of contacts, relative to the activation distance.
  double smallest_relative_gap(const VectorX& x) const;
  /// Where the stage ends: there colliders meet bodies.
  VectorX end_of(const VectorX& x) const;

  ProcessGroup share_;
  std::span<const std::uint8_t> is_fixed_;
  const Dependents* dependents_;
  Conditions conditions_;
  double time_to_end_, end_slope_;  ///< end of the stage, as Stage tells it
  bool leads_colliders_ = false;
  /// Gap relative to the activation distance below which colliders wait for bodies to give way.
  double least_relative_gap_ = 1e-4;
  int dim_ = 0;                               ///< dimension; known where it does
  VectorX base_positions_;                    ///< base positions of the stage; empty in statics
  std::vector<std::unique_ptr<Energy>> own_;  ///< made for this stage
  std::vector<LaggedTerm*> lagged_terms_;     ///< those of them that lag
  std::vector<const Energy*> terms_;          ///< in order, `own_` in place of those they were made of
  std::vector<const HistoryTerm*>
      history_terms_;  ///< by term: what has made it; null for one without history
  VectorX history_;    ///< at the start of the step
  std::vector<std::vector<const CellMatrices*>> along_;  ///< by term: what it takes along into the Hessian
  std::vector<bool> is_taken_;                           ///< by term: another one takes it along
};

/// Internal variables at the start of a run, to which bodies came from their reference configuration at an
/// even rate, in no time or in `duration` [s].
VectorX start_of_history(const Terms& terms, const VectorX& positions, double duration = 0);

/// Moves internal variables to the end of a step of `duration` [s] between two shapes.
/// @return heat of the terms [J], of this process
double advance_history(const Terms& terms, const VectorX& from, const VectorX& to, double duration,
                       VectorX& history);

/// The terms that are no part of a category.
Terms terms_without(EnergyCategory category, const Terms& terms);

}  // namespace resilin
