#include <algorithm>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/optimize/residual.hpp"
#include "resilin/sensitivity/derivatives.hpp"
#include "resilin/sensitivity/prescribed_changes.hpp"
#include "resilin/sensitivity/stage_slopes.hpp"
#include "resilin/sensitivity/tangent.hpp"
#include "resilin/simulation/stage_plan.hpp"

namespace resilin {
namespace {

/// Beside the forces that balance: a residual above it is felt in a gradient.
constexpr double loose_residual = 1e-7;

/// An elastic equilibrium does not depend on its path: of each that is asked about only its place and its
/// load count, whatever steps led there. With friction the one before counts, too, by the way since.
class StaticDerivatives final : public Derivatives {
 public:
  StaticDerivatives(Description description, const std::vector<std::string>& wrt,
                    const DerivativeOptions& options)
      : Derivatives(std::move(description), wrt, options),
        tangent_(world(), world().solver.kind, options.analyses) {
    places_.push_back(simulation_.state().positions);
    while (!simulation_.is_finished()) {
      const StepReport report = step();
      last_matrix_is_near_ = report.newton.last_step_was_exact;
      if (report.failed_attempts > 0) ++num_halved_steps_;
      places_.push_back(simulation_.state().positions);
      frames_.push_back(simulation_.frame());
    }
    if (follows_way() && num_halved_steps_ > 0)
      warnings_.push_back(world().place + ": " + std::to_string(num_halved_steps_) +
                          (num_halved_steps_ == 1 ? " load step was" : " load steps were") +
                          " halved (cutback), and with friction the load history matters: derivatives are "
                          "those of the run with its " +
                          std::to_string(frames_.size() - 1) +
                          " load steps as they were taken; more simulation.load_steps keep them even");
  }

  VectorX positions(int frame) override { return places_[static_cast<std::size_t>(frame)]; }
  std::vector<VectorX> transposed(const std::vector<FrameChange>& slopes) override;
  std::vector<std::vector<FrameChange>> forward_all(const std::vector<std::vector<VectorX>>& directions,
                                                    const std::vector<bool>& is_wanted) override;

 private:
  Conditions conditions(std::size_t frame) const { return world().at_load(frames_[frame].load); }
  bool follows_way() const { return world().friction != nullptr; }
  Potential potential(std::size_t frame) const;
  /// Makes `tangent_` that of the frame.
  void form_tangent(std::size_t frame, const Potential& at);
  /// K p = b at the frame, or K^T p = b, of an equilibrium that is stable.
  VectorX solve(std::size_t frame, const VectorX& b, bool is_transposed);
  std::vector<VectorX> slopes_at_places(const std::vector<FrameChange>& slopes);
  void estimate_error(const std::vector<FrameChange>& slopes, const std::vector<VectorX>& found);

  std::vector<VectorX> places_;  ///< places of the frames
  Tangent tangent_;
  std::size_t formed_ = 0;            ///< the frame of `tangent_`; 0: none
  bool last_matrix_is_near_ = false;  ///< Newton's last step was one by the exact Hessian, which was definite
};

// The stages are those of LoadControl.
Potential StaticDerivatives::potential(std::size_t frame) const {
  const Stage stage = follows_way() ? stage_of_increment(world(), places_[frame - 1], frames_[frame - 1].load,
                                                         frames_[frame].load)
                                    : static_stage(places_[frame]);
  Potential made = Potential::in_stage(world(), VectorX(), conditions(frame), stage);
  made.prepare(places_[frame], VectorX::Zero(places_[frame].size()));
  made.form_lag(places_[frame]);
  return made;
}

void StaticDerivatives::form_tangent(std::size_t frame, const Potential& at) {
  check_goes_on();
  if (formed_ == frame && !follows_way()) return;
  const bool has_factors = frame + 1 == places_.size() && last_matrix_is_near_;
  tangent_.form(at, places_[frame], has_factors ? &simulation_.newton() : nullptr);
  formed_ = frame;
}

VectorX StaticDerivatives::solve(std::size_t frame, const VectorX& b, bool is_transposed) {
  VectorX p = tangent_.solve(b, is_transposed);
  const Index negative = tangent_.negative_eigenvalues();
  if (negative == 0 || !tangent_.is_symmetric()) return p;
  throw InputError(world().place + ": derivatives at load factor " + format_short(frames_[frame].load),
                   "a stable equilibrium",
                   "one with " + std::to_string(negative) + " unstable mode" + (negative == 1 ? "" : "s"),
                   "unstable equilibria have no gradient: take another load, or a dynamic analysis");
}

// With lambda = w at fixed unknowns, w weighing reactions there, and K_FF^T lambda_F = -(J_x + K^T w)_F
// elsewhere: dJ/dp = lambda . dg/dp, dJ/dx_D = (J_x + K^T lambda)_D (docs/theory/gradients.md, G.1 and G.2).
std::vector<VectorX> StaticDerivatives::slopes_at_places(const std::vector<FrameChange>& slopes) {
  WorldChange world_slopes = asked();
  TermChanges term_slopes = links_.zero(world_slopes);
  const VectorX zero = VectorX::Zero(world().rest_positions.size());
  VectorX by_way = zero;  // slopes by the places of the frame that the next one has
  for (std::size_t frame = std::min(slopes.size(), places_.size()); frame-- > 0;) {
    VectorX by_x = slopes[frame].positions.size() > 0 ? slopes[frame].positions : zero;
    by_x += std::exchange(by_way, zero);
    const VectorX w = weights_of(slopes[frame].reactions);
    if (by_x.isZero(0) && w.isZero(0)) continue;
    if (frame == 0) {
      if (world_slopes.start_positions.size() > 0) world_slopes.start_positions += by_x;
      continue;
    }
    const Potential at = potential(frame);
    form_tangent(frame, at);
    const VectorX pull = w.isZero(0) ? zero : tangent_.times(w, true);
    const VectorX lambda = w - solve(frame, by_x + pull, true);
    Stage stage;
    if (follows_way()) stage.base_positions = zero;
    add_stage_slopes({world(), at}, places_[frame], lambda, term_slopes, stage);
    if (follows_way()) by_way = stage.base_positions;
    Motion prescribed{by_x + tangent_.times(lambda, true), {}, {}};
    follow_transposed(world(), prescribed);
    add_prescribed_slopes(world(), prescribed, conditions(frame), world_slopes);
  }
  return gathered(term_slopes, std::move(world_slopes));
}

std::vector<VectorX> StaticDerivatives::transposed(const std::vector<FrameChange>& slopes) {
  std::vector<VectorX> found = slopes_at_places(slopes);
  bool is_loose = false;
  for (std::size_t frame = 1; options_.estimates_errors && frame < std::min(slopes.size(), places_.size());
       ++frame)
    is_loose |= frames_[frame].residual > loose_residual &&
                (slopes[frame].positions.size() > 0 || !slopes[frame].reactions.empty());
  if (is_loose) estimate_error(slopes, found);
  return found;
}

/// The rest of the forces moves each equilibrium by one more Newton step, and the gradient with it.
void StaticDerivatives::estimate_error(const std::vector<FrameChange>& slopes,
                                       const std::vector<VectorX>& found) {
  const std::vector<VectorX> kept = places_;
  for (std::size_t frame = 1; frame < places_.size(); ++frame) {
    if (!(frames_[frame].residual > loose_residual)) continue;
    const Potential at = potential(frame);
    form_tangent(frame, at);
    VectorX gradient;
    at.gradient(places_[frame], gradient);
    places_[frame] -= solve(frame, gradient, false);
  }
  formed_ = 0;
  last_matrix_is_near_ = false;
  const std::vector<VectorX> better = slopes_at_places(slopes);
  places_ = kept;
  formed_ = 0;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const double size = better[i].norm(), error = (better[i] - found[i]).norm();
    if (!(error > loose_residual * size)) continue;
    warnings_.push_back(parameters_[i].name + ": the gradient may be off by " + format_short(error / size) +
                        " of its size, because forces balance to " + format_short(frames_.back().residual) +
                        " only: lower newton.tolerance");
  }
}

std::vector<std::vector<FrameChange>> StaticDerivatives::forward_all(
    const std::vector<std::vector<VectorX>>& directions, const std::vector<bool>& is_wanted) {
  std::vector<WorldChange> changes;
  std::vector<TermChanges> of_terms;
  const VectorX zero = VectorX::Zero(world().rest_positions.size());
  std::vector<std::vector<FrameChange>> all(directions.size(), std::vector<FrameChange>(places_.size()));
  for (std::size_t d = 0; d < directions.size(); ++d) {
    changes.push_back(spread(directions[d]));
    of_terms.push_back(links_.spread(changes[d]));
    all[d][0].positions = changes[d].start_positions.size() > 0 ? changes[d].start_positions : zero;
    all[d][0].reactions.assign(world().supports.size(), Vector3::Zero());
  }
  for (std::size_t frame = 1; frame < places_.size(); ++frame) {
    if (!is_wanted[frame] && !follows_way()) continue;
    const Potential at = potential(frame);
    form_tangent(frame, at);
    for (std::size_t d = 0; d < directions.size(); ++d) {
      VectorX force = zero;
      Stage stage;
      if (follows_way()) stage.base_positions = all[d][frame - 1].positions;
      add_stage_forces({world(), at}, places_[frame], of_terms[d], stage, force);
      Motion prescribed{zero, zero, zero};
      place_prescribed_changes(world(), changes[d], conditions(frame), prescribed);
      VectorX& dx = all[d][frame].positions;
      dx = prescribed.positions - solve(frame, force + tangent_.times(prescribed.positions, false), false);
      all[d][frame].reactions = reactions_of(force + tangent_.times(dx, false));
    }
  }
  return all;
}

}  // namespace

std::unique_ptr<Derivatives> differentiate_statics(Description description,
                                                   const std::vector<std::string>& wrt,
                                                   const DerivativeOptions& options) {
  return std::make_unique<StaticDerivatives>(std::move(description), wrt, options);
}

}  // namespace resilin
