#include "resilin/optimize/path_follower.hpp"

#include <cmath>

#include "resilin/core/stopwatch.hpp"
#include "resilin/optimize/convergence.hpp"
#include "resilin/optimize/residual.hpp"
#include "resilin/optimize/true_tangent.hpp"

namespace resilin {
namespace {

/// dx/dt of the fixed unknowns; zero at the free ones. Central differences are exact for straight motions
/// and good to 1e-10 for rotations; an error here costs iterations, not accuracy.
VectorX slope_of_fixed(const LoadFamily& family, std::span<const std::uint8_t> is_fixed, const VectorX& x,
                       double load) {
  constexpr double half_step = 1e-5;
  VectorX after = x, before = x;
  family.place_fixed(load + half_step, after);
  family.place_fixed(load - half_step, before);
  VectorX slope = (after - before) / (2 * half_step);
  for (Eigen::Index i = 0; i < slope.size(); ++i) {
    if (is_fixed[static_cast<std::size_t>(i)] == 0) slope[i] = 0;
  }
  return slope;
}

/// dg/dt at given positions.
VectorX load_slope(const LoadFamily& family, const VectorX& x) {
  VectorX loaded, unloaded;
  family.at(1)->gradient(x, loaded);
  family.at(0)->gradient(x, unloaded);
  return loaded - unloaded;
}

}  // namespace

/// One search for an equilibrium.
struct PathFollower::Search {
  PathFollower& follower;
  const LoadFamily& family;
  std::span<const std::uint8_t> is_fixed;
  const PathSettings& settings;

  VectorX x;
  double load;
  NewtonReport report;
  VectorX gradient;
  VectorX to_balance;  ///< free unknowns: what takes the residual away at this load
  VectorX along;       ///< dx/dt along the path

  Search(PathFollower& the_follower, const LoadFamily& the_family, std::span<const std::uint8_t> fixed,
         const PathSettings& the_settings, const PathPoint& start)
      : follower(the_follower),
        family(the_family),
        is_fixed(fixed),
        settings(the_settings),
        x(start.positions),
        load(start.load) {}

  NewtonReport finish(NewtonReport::Status status, std::string reason) {
    report.status = status;
    report.reason = std::move(reason);
    return report;
  }

  Convergence::Verdict measure(const Objective& objective) {
    objective.gradient(x, gradient);
    Convergence convergence(objective, is_fixed, follower.parts_, settings.tolerance);
    convergence.measure(x, gradient);
    const Convergence::Verdict verdict =
        convergence.verdict(follower.stiffness_.diagonal(), /*look_closer=*/true);
    report.residual = convergence.residual();
    report.force_scale = convergence.force_scale();
    report.worst_unknown = convergence.worst_unknown();
    report.rounding = convergence.rounding();
    return verdict;
  }

  void solve_tangent(const Objective& objective, const VectorX& b, VectorX& p) {
    follower.stiffness_.solve(b, p);
    if (objective.has_potential(x)) return;
    const NearSolve near = [&](const VectorX& right_side, VectorX& solution) {
      return follower.stiffness_.solve(right_side, solution).status == LinearReport::Status::ok;
    };
    VectorX better;
    const TangentReport tangent = solve_with_true_tangent(objective, is_fixed, {}, x, b, near, 1e-6, better);
    report.tangent_iterations += tangent.iterations;
    if (tangent.relative_residual < 0.3) p.swap(better);
  }

  /// Factorises at x and solves for `along` and, when the gradient is known, for `to_balance`.
  bool solve(const Objective& objective, bool with_residual) {
    const VectorX fixed_slope = slope_of_fixed(family, is_fixed, x, load);
    VectorX pull;
    {
      const Stopwatch watch(report.assembly_seconds);
      along = load_slope(family, x);
    }
    const Stopwatch watch(report.solve_seconds);
    ++report.linear_solves;
    const LinearReport linear = follower.stiffness_.factorize(objective, is_fixed, x, fixed_slope, &pull);
    require_memory(linear);
    if (linear.status != LinearReport::Status::ok) return false;
    VectorX right_side = -(along + pull);
    set_fixed_to_zero(is_fixed, right_side);
    solve_tangent(objective, right_side, along);
    if (with_residual) {
      right_side = -gradient;
      set_fixed_to_zero(is_fixed, right_side);
      solve_tangent(objective, right_side, to_balance);
      if (!to_balance.allFinite()) return false;
    }
    along += fixed_slope;
    return along.allFinite();
  }

  double free_dot(const VectorX& a, const VectorX& b) const {
    double sum = 0;
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      if (is_fixed[static_cast<std::size_t>(i)] == 0) sum += a[i] * b[i];
    }
    return sum;
  }

  /// Goes by (dx, dt), less where that would leave the domain of the energies; false when no part of it
  /// stays inside.
  bool move_by(Objective& objective, const VectorX& dx, double dt) {
    VectorX trial = x + dx;
    family.place_fixed(load + dt, trial);
    objective.prepare(x, trial - x);
    double part = objective.max_step(x, trial - x);
    for (int halving = 0; halving < 12; ++halving, part *= 0.5) {
      trial = x + part * dx;
      family.place_fixed(load + part * dt, trial);
      if (!std::isfinite(objective.difference(x, trial))) continue;
      x.swap(trial);
      load += part * dt;
      return true;
    }
    return false;
  }

  /// Newton's method from (x, load) on the sphere around `center`, or at the load as it is without one.
  NewtonReport run(const PathPoint* center, const NewtonObserver& observer);
};

NewtonReport PathFollower::Search::run(const PathPoint* center, const NewtonObserver& observer) {
  using Status = NewtonReport::Status;
  const double arc = settings.arc_length, weight = settings.load_weight * settings.load_weight;
  while (true) {
    const std::unique_ptr<Objective> objective = family.at(load);
    const Convergence::Verdict verdict = measure(*objective);
    if (verdict == Convergence::Verdict::yes) return finish(Status::converged, "converged");
    if (verdict == Convergence::Verdict::not_finite)
      return finish(Status::not_finite, "the step left the domain of the constitutive model");
    if (report.iterations >= settings.max_iterations)
      return finish(Status::max_iterations, "no point of the path was found at this distance");
    if (!solve(*objective, true)) return finish(Status::singular, "the stiffness matrix is singular");
    VectorX dx = to_balance;
    double dt = 0;
    if (center != nullptr) {
      const VectorX moved = x - center->positions;
      const double moved_load = load - center->load;
      const double excess = free_dot(moved, moved) + weight * moved_load * moved_load - arc * arc;
      dt = -(0.5 * excess + free_dot(moved, to_balance)) / (free_dot(moved, along) + weight * moved_load);
      dx += dt * along;
      if (!(std::sqrt(free_dot(dx, dx) + weight * dt * dt) < 10 * arc))
        return finish(Status::stalled, "the path curves more sharply than the step");
    }
    if (!move_by(*objective, dx, dt)) return finish(Status::stalled, "the step would invert an element");
    ++report.iterations;
    if (observer && !observer(report)) return finish(Status::interrupted, "interrupted");
  }
}

bool PathFollower::tangent(const LoadFamily& family, std::span<const std::uint8_t> is_fixed,
                           const PathPoint& at, VectorX& slope) {
  const PathSettings settings;
  Search search(*this, family, is_fixed, settings, at);
  if (!search.solve(*family.at(at.load), false)) return false;
  slope = std::move(search.along);
  return true;
}

NewtonReport PathFollower::advance(const LoadFamily& family, std::span<const std::uint8_t> is_fixed,
                                   const PathSettings& settings, const PathPoint& previous, PathPoint& point,
                                   const NewtonObserver& observer) {
  using Status = NewtonReport::Status;
  Search search(*this, family, is_fixed, settings, point);
  const std::unique_ptr<Objective> objective = family.at(point.load);
  if (!search.solve(*objective, false))
    return search.finish(Status::singular, "the stiffness matrix is singular where the step begins");
  const double weight = settings.load_weight * settings.load_weight;
  const VectorX along = search.along;
  const double forward =
      search.free_dot(along, point.positions - previous.positions) + weight * (point.load - previous.load);
  const double length = std::sqrt(search.free_dot(along, along) + weight);
  const double guess = (forward < 0 ? -1 : 1) * settings.arc_length / length;
  if (!search.move_by(*objective, guess * along, guess))
    return search.finish(Status::stalled, "the step would invert an element");
  NewtonReport report = search.run(&point, observer);
  if (!report.converged()) return report;
  // A point of the sphere far from the guess lies on another branch, or on the way back.
  const double agreement =
      guess * (search.free_dot(along, search.x - point.positions) + weight * (search.load - point.load));
  if (agreement < 0.5 * settings.arc_length * settings.arc_length) {
    report.status = Status::stalled;
    report.reason = "the path curves more sharply than the step";
    return report;
  }
  point = {std::move(search.x), search.load};
  return report;
}

NewtonReport PathFollower::settle(const LoadFamily& family, std::span<const std::uint8_t> is_fixed,
                                  const PathSettings& settings, PathPoint& point,
                                  const NewtonObserver& observer) {
  Search search(*this, family, is_fixed, settings, point);
  family.place_fixed(point.load, search.x);
  const NewtonReport report = search.run(nullptr, observer);
  if (report.converged()) point.positions = std::move(search.x);
  return report;
}

}  // namespace resilin
