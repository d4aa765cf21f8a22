#include "resilin/sensitivity/motion_steps.hpp"

#include <algorithm>
#include <utility>

#include "resilin/optimize/residual.hpp"
#include "resilin/sensitivity/impulse_slopes.hpp"
#include "resilin/sensitivity/prescribed_changes.hpp"
#include "resilin/sensitivity/stage_slopes.hpp"
#include "resilin/simulation/initial_acceleration.hpp"
#include "resilin/simulation/prescribed_motion.hpp"
#include "resilin/world/linear_constraints.hpp"

namespace resilin {
namespace {

/// A stage of slopes or of changes: as long as the one that they belong to.
Stage zero_stage(const Stage& stage) {
  const VectorX zero = VectorX::Zero(stage.base_positions.size());
  return {.base_positions = zero, .base_velocities = zero, .duration = stage.duration, .shape = zero};
}

/// Takes the fixed unknowns out of a motion.
Motion take_fixed(const World& world, Motion& motion) {
  Motion taken = zero_motion(motion.positions.size());
  VectorX* const from[] = {&motion.positions, &motion.velocities, &motion.accelerations};
  VectorX* const to[] = {&taken.positions, &taken.velocities, &taken.accelerations};
  for (std::size_t part = 0; part < 3; ++part)
    for (Eigen::Index i = 0; i < from[part]->size(); ++i)
      if (world.is_fixed[static_cast<std::size_t>(i)] != 0) std::swap((*from[part])[i], (*to[part])[i]);
  return taken;
}

}  // namespace

bool is_zero(const History& history) {
  for (const VectorX* part : {&history.now.positions, &history.now.velocities, &history.now.accelerations,
                              &history.previous_positions, &history.previous_velocities})
    if (!part->isZero(0)) return false;
  return true;
}

void MotionSteps::begin() {
  tangent_.begin_sequence();
  earlier_.assign(static_cast<std::size_t>(scheme_.num_stages()), {});
}

VectorX MotionSteps::mass_changes(const VectorX& accelerations, const TermChanges& of_terms) const {
  VectorX force = VectorX::Zero(accelerations.size());
  const auto& of_mass = of_terms[static_cast<std::size_t>(inertia_)];
  if (const auto found = of_mass.find("mass"); found != of_mass.end())
    world_.mass->add_change(found->second, accelerations, force);
  return force;
}

void MotionSteps::add_mass_slopes(const VectorX& w, const VectorX& accelerations,
                                  TermChanges& by_terms) const {
  auto& by_mass = by_terms[static_cast<std::size_t>(inertia_)];
  if (const auto found = by_mass.find("mass"); found != by_mass.end())
    world_.mass->add_slopes(w, accelerations, found->second);
}

History MotionSteps::forward(const StepReplay& step, const History& change, const TermChanges& of_terms,
                             const WorldChange& of_world, VectorX& gradient) {
  const double dt = step.time_step;
  History start = change;
  start.previous_time_step = step.start().previous_time_step;
  if (step.renews_accelerations)
    start.now.accelerations =
        forward_accelerations(step.start().now, time_after(step.time, dt), start.now, of_terms, of_world);
  const Eigen::Index size = world_.rest_positions.size();
  Motion end_prescribed = zero_motion(size);
  place_prescribed_changes(world_, of_world, step.conditions_at_end(), end_prescribed);
  StageSequence sequence(scheme_, std::move(start), dt);
  for (std::size_t i = 0; i < step.stages.size(); ++i) {
    const StageReplay& at = step.stages[i];
    Stage stage = sequence.begin();
    Motion prescribed = zero_motion(size);
    if (!at.stage.is_mean) {
      place_prescribed_changes(world_, of_world, at.conditions, prescribed);
    } else {
      const Motion& now = sequence.start().now;
      prescribed = mean_of_step(now.positions, now.velocities, end_prescribed, dt);
      prescribed = take_fixed(world_, prescribed);
      follow(world_, prescribed);
    }
    follow_prescribed(world_, prescribed, stage);
    if (world_.constraints) {
      world_.dependents()->follow(stage.base_positions);
      world_.dependents()->follow(stage.base_velocities);
    }
    const Potential potential = potential_of(world_, at);
    tangent_.form(potential, at.motion.positions);
    const ImpulseSlopes impulses(world_, potential, at);
    gradient = VectorX::Zero(size);
    add_stage_forces({world_, potential}, at.motion.positions, of_terms, stage, gradient);
    if (at.stage.is_mean) gradient += impulses.by_base(stage.base_positions, false);
    VectorX dx = prescribed.positions -
                 tangent_.solve(gradient + tangent_.times(prescribed.positions, false), false, &earlier_[i]);
    gradient += tangent_.times(dx, false);
    VectorX by_impulses;
    if (at.by_impulses.size() > 0) {
      const VectorX of_impulses = impulses.change(dx, stage, of_terms);
      gradient += (1 / at.stage.count_of_impulse() - 1) * of_impulses;
      if (scheme_.looks_back())
        by_impulses = -accelerations_by(world_, of_impulses + mass_changes(at.by_impulses, of_terms));
    }
    sequence.end(stage, stage.motion(std::move(dx)), by_impulses, at.by_impulses);
  }
  Motion end = sequence.finish();
  take_fixed(world_, end);
  end.positions += end_prescribed.positions;
  end.velocities += end_prescribed.velocities;
  end.accelerations += end_prescribed.accelerations;
  follow(world_, end);
  return sequence.after(std::move(end));
}

History MotionSteps::transposed(const StepReplay& step, const History& by_next, const VectorX& w,
                                TermChanges& by_terms, WorldChange& by_world) {
  const double dt = step.time_step;
  const Eigen::Index size = world_.rest_positions.size();
  const VectorX none;
  const auto where = [&](std::size_t i) -> const VectorX& {
    return scheme_.looks_back() ? step.stages[i].by_impulses : none;
  };
  History by_end = by_next;
  follow_transposed(world_, by_end.now);
  Motion by_end_prescribed = take_fixed(world_, by_end.now);
  TransposedSequence sequence(scheme_, by_end, where(step.stages.size() - 1), dt,
                              step.start().previous_time_step);
  for (std::size_t i = step.stages.size(); i-- > 0;) {
    const StageReplay& at = step.stages[i];
    const double c = at.stage.duration;
    auto [by_x, by_stage, by_impulses] = sequence.end(at.stage, where(i));
    const Potential potential = potential_of(world_, at);
    tangent_.form(potential, at.motion.positions);
    const ImpulseSlopes impulses(world_, potential, at);
    const bool is_last = i + 1 == step.stages.size();
    if (at.by_impulses.size() > 0) {
      VectorX of_impulses = VectorX::Zero(size);
      if (by_impulses.size() > 0) {
        of_impulses = accelerations_by(world_, -by_impulses);
        add_mass_slopes(of_impulses, at.by_impulses, by_terms);
      }
      if (is_last && w.size() > 0) of_impulses += (1 / at.stage.count_of_impulse() - 1) * w;
      by_x += impulses.add_slopes(of_impulses, by_stage, by_terms);
    }
    VectorX lambda = VectorX::Zero(size);
    if (is_last && w.size() > 0) {
      lambda = w;
      lambda -= tangent_.solve(by_x + tangent_.times(w, true), true, &earlier_[i]);
    } else {
      lambda -= tangent_.solve(by_x, true, &earlier_[i]);
    }
    by_x += tangent_.times(lambda, true);
    follow_transposed(world_, by_x);  // zero at the free unknowns
    add_stage_slopes({world_, potential}, at.motion.positions, lambda, by_terms, by_stage);
    if (at.stage.is_mean) by_stage.base_positions += impulses.by_base(lambda, true);
    follow_transposed(world_, by_stage.base_positions);
    follow_transposed(world_, by_stage.base_velocities);
    Motion by_prescribed = zero_motion(size);
    for (Eigen::Index k = 0; k < size; ++k) {  // follow_prescribed, transposed
      if (world_.is_fixed[static_cast<std::size_t>(k)] == 0) continue;
      by_prescribed.positions[k] = by_x[k] + by_stage.base_positions[k];
      by_prescribed.velocities[k] = by_stage.base_velocities[k] - c * by_stage.base_positions[k];
      by_prescribed.accelerations[k] = -c * by_stage.base_velocities[k];
      by_stage.base_positions[k] = by_stage.base_velocities[k] = 0;
    }
    if (!at.stage.is_mean) {
      add_prescribed_slopes(world_, by_prescribed, at.conditions, by_world);
    } else {  // mean_of_step, transposed
      Motion& by_now = sequence.by_start().now;
      by_now.positions += 0.5 * by_prescribed.positions - by_prescribed.velocities / dt;
      by_now.velocities -= by_prescribed.accelerations / dt;
      by_end_prescribed.positions += 0.5 * by_prescribed.positions + by_prescribed.velocities / dt;
      by_end_prescribed.velocities += by_prescribed.accelerations / dt;
    }
    sequence.begin(by_stage);
  }
  add_prescribed_slopes(world_, by_end_prescribed, step.conditions_at_end(), by_world);
  History by_start = std::move(sequence).finish();
  if (step.renews_accelerations)
    transposed_accelerations(step.start().now, time_after(step.time, dt), by_start.now, by_terms, by_world);
  return by_start;
}

namespace {

/// The potential whose gradient accelerations balance, and the numbers of its terms.
struct SmoothForces {
  Terms terms;
  std::vector<std::size_t> numbers;
  Stage stage;
  Potential potential;

  SmoothForces(const World& world, const Motion& at, double time)
      : terms(smooth_terms(world)),
        stage(stage_at_once(at.positions, at.velocities)),
        potential(terms, world.is_fixed, {.time = time, .load = 1}, stage) {
    for (std::size_t t = 0; t < world.terms.size(); ++t)
      if (std::ranges::find(terms, world.terms[t]) != terms.end()) numbers.push_back(t);
  }
  /// K p of the smooth terms at x, or K^T p.
  VectorX tangent_times(const World& world, const VectorX& x, const VectorX& p, bool is_transposed) const {
    BlockMatrix hessian(world.dimension, world.pattern);
    potential.hessian(x, Projection::none, hessian);
    VectorX product;
    multiply(hessian, p, product);
    return product + SkewPart(world, potential, x).times(p, is_transposed);
  }
};

}  // namespace

// M a + g(x; x_0 = x - v, shape = x) = 0 at the free unknowns.
VectorX MotionSteps::forward_accelerations(const Motion& at, double time, const Motion& change,
                                           const TermChanges& of_terms, const WorldChange& of_world) {
  const SmoothForces smooth(world_, at, time);
  Motion prescribed = zero_motion(at.positions.size());
  place_prescribed_changes(world_, of_world, smooth.potential.conditions(), prescribed);
  VectorX force = smooth.tangent_times(world_, at.positions, change.positions, false);
  add_stage_forces({smooth.potential, smooth.numbers}, at.positions, of_terms,
                   stage_at_once(change.positions, change.velocities), force);
  force += mass_changes(at.accelerations, of_terms);
  VectorX pull;
  world_.mass->multiply(prescribed.accelerations, pull);
  return prescribed.accelerations - accelerations_by(world_, force + pull);
}

void MotionSteps::transposed_accelerations(const Motion& at, double time, Motion& by_motion,
                                           TermChanges& by_terms, WorldChange& by_world) {
  const SmoothForces smooth(world_, at, time);
  const VectorX lambda = -accelerations_by(world_, by_motion.accelerations);
  VectorX pull;
  world_.mass->multiply(lambda, pull);
  Motion by_prescribed = zero_motion(at.positions.size());
  by_prescribed.accelerations = by_motion.accelerations + pull;
  follow_transposed(world_, by_prescribed);
  by_prescribed = take_fixed(world_, by_prescribed);
  add_prescribed_slopes(world_, by_prescribed, smooth.potential.conditions(), by_world);
  by_motion.positions += smooth.tangent_times(world_, at.positions, lambda, true);
  Stage by_stage = zero_stage(smooth.stage);
  add_stage_slopes({smooth.potential, smooth.numbers}, at.positions, lambda, by_terms, by_stage);
  by_motion.positions += by_stage.base_positions + by_stage.shape;
  by_motion.velocities += by_stage.base_velocities - by_stage.base_positions;
  add_mass_slopes(lambda, at.accelerations, by_terms);
  by_motion.accelerations.setZero();
}

// Prescribed are the velocities and accelerations of the start, not its places.
Motion MotionSteps::forward_start(const StepReplay& first, const TermChanges& of_terms,
                                  const WorldChange& of_world) {
  const Eigen::Index size = world_.rest_positions.size();
  Motion start = zero_motion(size), prescribed = zero_motion(size);
  if (of_world.start_velocities.size() > 0) start.velocities = of_world.start_velocities;
  take_fixed(world_, start);
  if (of_world.start_positions.size() > 0) start.positions = of_world.start_positions;
  place_prescribed_changes(world_, of_world, first.conditions_at_start(), prescribed);
  start.velocities += prescribed.velocities;
  if (world_.constraints) world_.dependents()->follow(start.velocities);
  if (scheme_.needs_accelerations() && !first.renews_accelerations)
    start.accelerations = forward_accelerations(first.start().now, first.time, start, of_terms, of_world);
  return start;
}

void MotionSteps::transposed_start(const StepReplay& first, Motion by_start, TermChanges& by_terms,
                                   WorldChange& by_world) {
  if (scheme_.needs_accelerations() && !first.renews_accelerations)
    transposed_accelerations(first.start().now, first.time, by_start, by_terms, by_world);
  if (by_world.start_positions.size() > 0) by_world.start_positions += by_start.positions;
  by_start.positions.setZero();
  by_start.accelerations.setZero();
  follow_transposed(world_, by_start.velocities);
  const Motion by_prescribed = take_fixed(world_, by_start);
  add_prescribed_slopes(world_, by_prescribed, first.conditions_at_start(), by_world);
  if (by_world.start_velocities.size() > 0) by_world.start_velocities += by_start.velocities;
}

}  // namespace resilin
