#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/optimize/residual.hpp"
#include "resilin/sensitivity/derivatives.hpp"
#include "resilin/sensitivity/motion_steps.hpp"
#include "resilin/sensitivity/prescribed_changes.hpp"
#include "resilin/sensitivity/trajectory.hpp"

namespace resilin {
namespace {

void add(VectorX& to, const VectorX& more) {
  if (more.size() > 0) to += more;
}

class MotionDerivatives final : public Derivatives {
 public:
  MotionDerivatives(Description description, const std::vector<std::string>& wrt,
                    const DerivativeOptions& options)
      : Derivatives(std::move(description), wrt, options),
        scheme_(make_integrator(world().integrator, world().place + ": simulation.integrator")),
        trajectory_(simulation_, *scheme_, options.checkpoints, [this] { return take_step(); }),
        steps_(world(), *scheme_, links_.inertia(), options.analyses) {}

  VectorX positions(int frame) override { return trajectory_.end_of(frame).positions; }
  VectorX velocities(int frame) override { return trajectory_.end_of(frame).velocities; }
  std::vector<VectorX> transposed(const std::vector<FrameChange>& slopes) override;
  std::vector<std::vector<FrameChange>> forward_all(const std::vector<std::vector<VectorX>>& directions,
                                                    const std::vector<bool>& is_wanted) override;

 private:
  /// @return StepReport::stage_places
  std::vector<VectorX> take_step();
  std::vector<FrameChange> forward_along(const std::vector<VectorX>& changes);

  std::unique_ptr<Integrator> scheme_;
  Trajectory trajectory_;
  MotionSteps steps_;
};

/// Refuses what is no step of the scheme alone.
std::vector<VectorX> MotionDerivatives::take_step() {
  const State& state = simulation_.state();
  const int guarded = state.guarded_steps, divided = state.divided_steps;
  const bool is_first_time = state.step + 1 == num_frames();
  StepReport report = step();
  const std::string place = world().place + ": derivatives, step " + std::to_string(simulation_.state().step);
  const auto refuse = [&](const std::string& got, const std::string& cure) {
    throw InputError(place, "a step of " + std::string(scheme_->name()) + " alone", got, cure);
  };
  if (state.guarded_steps > guarded)
    refuse(report.by_backward_euler ? "a step that backward_euler repeated, or part of one"
                                    : "one that was damped, because it would have added energy",
           "take shorter steps, or integrator = \"backward_euler\"");
  if (state.divided_steps > divided || state.previous_time_step != world().time_step)
    refuse("one with a time-step cutback", "take shorter steps");
  if (state.collider_delay > 0) refuse("a collider that bodies block", "take shorter steps");
  if (is_first_time) frames_.push_back(simulation_.frame());
  return std::move(report.stage_places);
}

std::vector<VectorX> MotionDerivatives::transposed(const std::vector<FrameChange>& slopes) {
  WorldChange world_slopes = asked();
  TermChanges term_slopes = links_.zero(world_slopes);
  const Eigen::Index size = world().rest_positions.size();
  History by_history = zero_history(size);
  steps_.begin();
  for (int k = trajectory_.num_steps(); k >= 0; --k) {
    check_goes_on();
    VectorX w;
    if (static_cast<std::size_t>(k) < slopes.size()) {
      const FrameChange& of_frame = slopes[static_cast<std::size_t>(k)];
      add(by_history.now.positions, of_frame.positions);
      add(by_history.now.velocities, of_frame.velocities);
      if (k > 0 && !of_frame.reactions.empty()) w = weights_of(of_frame.reactions);
    }
    if (k > 0 && !(is_zero(by_history) && w.size() == 0))
      by_history = steps_.transposed(trajectory_.step(k), by_history, w, term_slopes, world_slopes);
  }
  if (trajectory_.num_steps() > 0 && !is_zero(by_history))
    steps_.transposed_start(trajectory_.step(1), by_history.now, term_slopes, world_slopes);
  return gathered(term_slopes, std::move(world_slopes));
}

std::vector<std::vector<FrameChange>> MotionDerivatives::forward_all(
    const std::vector<std::vector<VectorX>>& directions, const std::vector<bool>& /*is_wanted*/) {
  std::vector<std::vector<FrameChange>> all;
  for (const std::vector<VectorX>& changes : directions) all.push_back(forward_along(changes));
  return all;
}

std::vector<FrameChange> MotionDerivatives::forward_along(const std::vector<VectorX>& changes) {
  const WorldChange change = spread(changes);
  const TermChanges of_terms = links_.spread(change);
  std::vector<FrameChange> all(1);
  History of_history = zero_history(world().rest_positions.size());
  steps_.begin();
  if (trajectory_.num_steps() > 0)
    of_history.now = steps_.forward_start(trajectory_.step(1), of_terms, change);
  all[0] = {of_history.now.positions, of_history.now.velocities,
            std::vector<Vector3>(world().supports.size(), Vector3::Zero())};
  for (int k = 1; k <= trajectory_.num_steps(); ++k) {
    check_goes_on();
    VectorX gradient;
    of_history = steps_.forward(trajectory_.step(k), of_history, of_terms, change, gradient);
    all.push_back({of_history.now.positions, of_history.now.velocities, reactions_of(gradient)});
  }
  return all;
}

}  // namespace

std::unique_ptr<Derivatives> differentiate_motion(Description description,
                                                  const std::vector<std::string>& wrt,
                                                  const DerivativeOptions& options) {
  return std::make_unique<MotionDerivatives>(std::move(description), wrt, options);
}

}  // namespace resilin
