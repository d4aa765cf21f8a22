#include "resilin/live/live_scene.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <span>

#include "resilin/contact/half_space.hpp"
#include "resilin/contact/sphere.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/stopwatch.hpp"
#include "resilin/core/text.hpp"
#include "resilin/energy/hand.hpp"
#include "resilin/energy/inertia.hpp"
#include "resilin/live/kinetic_guard.hpp"
#include "resilin/live/obstacle.hpp"
#include "resilin/optimize/residual.hpp"
#include "resilin/simulation/body_material.hpp"
#include "resilin/simulation/damping.hpp"
#include "resilin/simulation/loads.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/time_stepping.hpp"

namespace resilin {
namespace {

/// The scene as it is played with: in motion, with a gravity that can be changed.
Description in_motion(Description description) {
  description.is_dynamic = true;
  description.modes.reset();
  description.adaptive.reset();
  description.gravity.setZero();
  for (BodyDescription& body : description.bodies) body.mass = "lumped";
  return description;
}

/// When all that changes by itself has come to its end [s]; before, bodies may be still and yet not at rest.
double end_of_changes(const Description& description) {
  const auto is_endless = [](const auto& entry) {
    return std::holds_alternative<TimeFunction::Sine>(entry.time_function.form) ||
           (entry.velocity != Vector3::Zero() && !entry.until);
  };
  if (std::ranges::any_of(description.fixes, is_endless) ||
      std::ranges::any_of(description.loads, is_endless))
    return std::numeric_limits<double>::infinity();
  const std::vector<double> events = event_times(description);
  return events.empty() ? 0 : events.back();
}

/// A small system is solved directly whatever its mass: stiff bodies at long steps are then as quick as soft
/// ones.
std::unique_ptr<LinearSolver> live_solver(const World& world) {
  constexpr Index most_unknowns_direct = 2500;
  const Index unknowns = world.num_free_unknowns();
  return make_linear_solver({.kind = world.solver.kind,
                             .is_dynamic = unknowns > most_unknowns_direct,
                             .max_iterations = world.solver.max_iterations},
                            unknowns);
}

struct Held {
  MaterialPoint place;
  Vector3 target;
};

/// Nothing moves any more: from here on steps lead straight to the equilibrium.
struct Calm {
  int quiet_steps = 0;    ///< in a row in which nothing moved to speak of
  int seeking_steps = 0;  ///< since then, towards the equilibrium
};
constexpr int quiet_steps_before_seeking = 10;
constexpr double barrier_stiffness = 0.1;    ///< of Young's modulus, as for [[collider]]
constexpr double nearly_flat = 0.1;          ///< volume ratio of a cell about to turn inside out
constexpr double longest_mending_step = 10;  ///< [s], where bodies are held
constexpr double fall_while_mending = 0.05;  ///< of the extent, in one step
constexpr double quiet_speed = 1e-3;         ///< of the body's extent in a second
constexpr double rest_tolerance = 1e-8;      ///< of the load
constexpr double unloaded_force_scale =
    1e-4;  ///< of E times the body's cross section, where there is no load

}  // namespace

struct LiveScene::Contents {
  explicit Contents(const Description& scene)
      : description(in_motion(scene)),
        world(description),
        own_external(world.external),
        own_fixed(world.is_fixed),
        newton(world.dimension, world.pattern, live_solver(world)),
        controls(starting_controls(scene, world)) {
    extent = world.largest_extent();
    end_of_changes = resilin::end_of_changes(description);
    if (controls.gravity.norm() > 0) {
      up = -controls.gravity.normalized();
    } else if (world.dimension == 2) {
      up = Vector3::UnitY();
    }
    reset();
  }

  void reset();
  void wake() { calm = {}, report.at_rest = false; }
  void renew_loads();
  void renew_fixed();
  void renew_floor();
  void advance_obstacles();
  void renew_damping();
  void set_controls(const LiveControls& asked);
  void change_materials(const LiveControls& wanted);

  bool is_seeking() const {
    return state.time >= end_of_changes && calm.quiet_steps >= quiet_steps_before_seeking;
  }
  void step(const StepBudget& budget);
  NewtonReport minimize(const Potential& potential, const VectorX& guess, const VectorX& targets,
                        double tolerance, const StepBudget& budget, VectorX& x);
  std::vector<std::unique_ptr<Energy>> more_terms(double dt) const;
  void move_in_time(const StepBudget& budget);
  void move_to_equilibrium(const StepBudget& budget);
  double mending_factor();
  double min_volume_ratio(const VectorX& x) const;
  bool stay_upright(const Potential& potential, VectorX& x) const;
  void measure(const NewtonReport& newton_report);
  void note_calm(double dt);
  std::string words() const;
  double unloaded_scale() const;

  Description description;
  World world;
  std::vector<std::shared_ptr<const Energy>> own_external;  ///< loads of the scene, without gravity
  std::vector<std::uint8_t> own_fixed;                      ///< by supports
  Newton newton;
  LiveControls controls;
  State state;
  LiveReport report;
  std::optional<Held> held;
  std::optional<Obstacle> floor, ball;
  double ball_radius = 0;
  Vector3 up = Vector3::UnitZ();  ///< what the floor faces, whatever gravity becomes
  std::vector<Index> pinned;
  Calm calm;
  int mending_steps = 0;  ///< in a row that started with cells inside out
  double extent = 1;
  double end_of_changes = 0;  ///< [s]
};

void LiveScene::Contents::reset() {
  state = State{};
  state.positions = world.start_positions;
  state.velocities = world.start_velocities;
  state.load = 1;
  held.reset();
  pinned.clear();
  ball.reset();
  renew_fixed();
  renew_floor();
  renew_loads();
  report = LiveReport{};
  wake();
}

/// Gravity is a load of its own, so that it can be changed.
void LiveScene::Contents::renew_loads() {
  world.external = own_external;
  if (floor) world.external.push_back(floor->barrier());
  if (ball) world.external.push_back(ball->barrier());
  if (controls.gravity.head(world.dimension).norm() > 0)
    world.external.push_back(make_gravity(controls.gravity, world));
  renew_damping();
}

/// Places a floor below all bodies; it then rises to its height.
void LiveScene::Contents::renew_floor() {
  floor.reset();
  if (!controls.ground) return;
  const Vector3 goal = *controls.ground * up;
  floor.emplace("ground", world, state.positions, std::make_shared<HalfSpace>(goal, up), -up,
                barrier_stiffness * controls.youngs_modulus);
  floor->set_goal(goal);
}

/// Floor and ball go where they shall be, as far as the bodies are out of their way.
void LiveScene::Contents::advance_obstacles() {
  if (floor && floor->advance(state.positions)) calm = {};
  if (ball && ball->advance(state.positions)) calm = {};
}

void LiveScene::Contents::renew_damping() {
  world.mass_damping = MassMatrix{};
  if (controls.damping == 0) return;
  world.mass_damping = world.mass;
  world.mass_damping.nodal *= controls.damping;
  for (double& slot : world.mass_damping.slots) slot *= controls.damping;
}

void LiveScene::Contents::renew_fixed() {
  world.is_fixed = own_fixed;
  for (const Index node : pinned) {
    for (int k = 0; k < world.dimension; ++k)
      world.is_fixed[static_cast<std::size_t>(node * world.dimension + k)] = 1;
  }
}

void LiveScene::Contents::change_materials(const LiveControls& wanted) {
  World changed = world;
  std::vector<BodyDescription> bodies = description.bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies[b].material = material_of(wanted, bodies[b].material);
    bodies[b].material.place = "material";
    change_material(changed, b, bodies[b]);
    const double energy = changed.bodies[b].elastic->value(state.positions, {});
    if (std::isfinite(energy)) continue;
    throw InputError("law", "a law that knows cells turned inside out while there are such",
                     "\"" + wanted.law + "\", which needs J > 0 everywhere",
                     "reset the scene, or wait until no cell is inverted");
  }
  world = std::move(changed);
  description.bodies = std::move(bodies);
}

void LiveScene::Contents::set_controls(const LiveControls& asked) {
  LiveControls wanted = asked;
  // The hand grows with the stiffness, unless both are set.
  if (wanted.max_force == controls.max_force)
    wanted.max_force *= wanted.youngs_modulus / controls.youngs_modulus;
  check_controls(wanted);
  const bool changes_material = wanted.law != controls.law ||
                                wanted.youngs_modulus != controls.youngs_modulus ||
                                wanted.poissons_ratio != controls.poissons_ratio;
  if (changes_material) change_materials(wanted);
  const bool changes_floor =
      wanted.ground != controls.ground || wanted.youngs_modulus != controls.youngs_modulus;
  controls = wanted;
  if (changes_floor) renew_floor();
  renew_loads();
  wake();
}

std::vector<std::unique_ptr<Energy>> LiveScene::Contents::more_terms(double dt) const {
  auto terms = damping_terms(world, state.positions, state.positions, dt);
  if (held) {
    terms.push_back(std::make_unique<Hand>(world.dimension, held->place, held->target,
                                           hand_stiffness(controls, world), controls.max_force));
  }
  return terms;
}

/// Newton's method from the better of where things are and where they would fly, until the tolerance or the
/// end of the time.
NewtonReport LiveScene::Contents::minimize(const Potential& potential, const VectorX& guess,
                                           const VectorX& targets, double tolerance, const StepBudget& budget,
                                           VectorX& x) {
  const auto start = std::chrono::steady_clock::now();
  choose_lower_start(potential, world.is_fixed, state.positions, guess, x);
  NewtonSettings settings = newton_settings(world);
  settings.tolerance = tolerance;
  settings.max_iterations = controls.newton_limit > 0 ? controls.newton_limit : world.newton.max_iterations;
  return newton.minimize(potential, world.is_fixed, targets, settings, x, [&](const NewtonReport&) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < budget.seconds;
  });
}

void LiveScene::Contents::move_in_time(const StepBudget& budget) {
  const double dt = controls.time_step;
  const Conditions conditions{.time = state.time + dt, .load = 1};
  const double step = dt * mending_factor();
  const VectorX guess = state.positions + (dt / step) * dt * state.velocities;
  VectorX targets = state.positions;
  place_supports(world.dimension, world.supports, world.rest_positions, conditions, targets);
  const bool is_driven = targets != state.positions;
  const Inertia inertia(world.mass, guess, step * step);
  const auto terms = more_terms(step);
  const Potential potential(world, conditions, &inertia, terms);
  VectorX x = state.positions;
  NewtonReport newton_report = minimize(potential, guess, targets, controls.tolerance, budget, x);
  if (!held && !is_driven && report.min_volume_ratio > 0 && stay_upright(potential, x))
    newton_report.status = NewtonReport::Status::stalled;
  VectorX velocities = (x - state.positions) / step;
  if (!is_driven && !newton_report.converged()) {
    const Potential without_inertia(world, conditions, nullptr, terms);
    const double gain = without_inertia.difference(state.positions, x);
    limit_kinetic_energy(world.mass, state.velocities, gain, velocities);
  }
  state.previous_positions = std::move(state.positions);
  state.positions = std::move(x);
  state.velocities = std::move(velocities);
  state.time += dt;
  ++state.step;
  measure(newton_report);
  note_calm(dt);
}

/// Backward Euler dissipates the more the longer its step. Once nobody pulls, each step that starts with
/// cells turned inside out counts as four times as long as the one before, until they are upright: up to
/// statics where the bodies are held, and no longer than a free body takes to fall a little.
double LiveScene::Contents::mending_factor() {
  const bool is_folded = report.min_volume_ratio < nearly_flat && !held;
  mending_steps = is_folded ? mending_steps + 1 : std::max(0, mending_steps - 1);
  const double g = controls.gravity.norm();
  const bool may_fall = g > 0 && std::ranges::find(world.is_fixed, std::uint8_t{1}) == world.is_fixed.end();
  const double longest = may_fall ? std::sqrt(fall_while_mending * extent / g) : longest_mending_step;
  return std::clamp(std::pow(4.0, mending_steps), 1.0, std::max(1.0, longest / controls.time_step));
}

double LiveScene::Contents::min_volume_ratio(const VectorX& x) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Body& body : world.bodies) least = std::min(least, body.elastic->min_volume_ratio(x).ratio);
  return least;
}

/// A step that would turn a first cell inside out although nobody pulls goes only part of its way, as long as
/// that lowers the potential, too. @return whether it was shortened
bool LiveScene::Contents::stay_upright(const Potential& potential, VectorX& x) const {
  if (min_volume_ratio(x) > 0) return false;
  VectorX nearer = x;
  for (int halving = 0; halving < 20; ++halving) {
    nearer = 0.5 * (nearer + state.positions);
    if (!(min_volume_ratio(nearer) > 0)) continue;
    if (!(potential.difference(state.positions, nearer) <= 0)) return false;
    x = std::move(nearer);
    return true;
  }
  return false;
}

/// One step of the proximal point method: the mass matrix, divided by a scale that grows, keeps the system
/// definite while velocities are no longer carried along.
void LiveScene::Contents::move_to_equilibrium(const StepBudget& budget) {
  const double dt = controls.time_step;
  const Conditions conditions{.time = state.time, .load = 1};
  VectorX targets = state.positions;
  place_supports(world.dimension, world.supports, world.rest_positions, conditions, targets);
  const double scale = dt * dt * std::pow(10.0, std::min(calm.seeking_steps, 8));
  const Inertia inertia(world.mass, state.positions, scale);
  std::vector<std::unique_ptr<Energy>> terms;
  if (held) {
    terms.push_back(std::make_unique<Hand>(world.dimension, held->place, held->target,
                                           hand_stiffness(controls, world), controls.max_force));
  }
  const Potential potential(world, conditions, &inertia, terms);
  VectorX x = state.positions;
  NewtonReport newton_report = minimize(potential, x, targets, 0.1 * rest_tolerance, budget, x);
  const Potential without_inertia(world, conditions, nullptr, terms);
  VectorX gradient;
  without_inertia.gradient(x, gradient);
  const Residual residual = free_residual(gradient, world.is_fixed);
  newton_report.residual = residual.norm;
  newton_report.worst_unknown = residual.worst;
  newton_report.force_scale = std::max(without_inertia.force_scale(x, gradient), unloaded_scale());
  state.positions = std::move(x);
  state.velocities.setZero();
  ++state.step;
  ++calm.seeking_steps;
  measure(newton_report);
  const double round_off = residual_round_off(without_inertia, world.is_fixed, state.positions, {});
  report.at_rest = residual.norm <= std::max(rest_tolerance * newton_report.force_scale, round_off);
  report.converged = report.at_rest;
  report.words = words();
}

double LiveScene::Contents::unloaded_scale() const {
  return unloaded_force_scale * controls.youngs_modulus * std::pow(extent, world.dimension - 1);
}

/// Whether anything moved in the last step.
void LiveScene::Contents::note_calm(double dt) {
  const double moved = (state.positions - state.previous_positions).cwiseAbs().maxCoeff();
  const bool is_quiet = moved <= quiet_speed * extent * dt && report.inverted_cells == 0;
  calm.quiet_steps = is_quiet ? calm.quiet_steps + 1 : 0;
}

void LiveScene::Contents::measure(const NewtonReport& newton_report) {
  report.time = state.time;
  report.converged = newton_report.converged();
  report.newton_iterations = newton_report.iterations;
  report.linear_iterations = newton_report.linear_iterations;
  report.residual = newton_report.residual;
  report.relative_residual = newton_report.relative_residual();
  report.assembly_ms = 1e3 * newton_report.assembly_seconds;
  report.solve_ms = 1e3 * newton_report.solve_seconds;
  VectorX momentum;
  world.mass.multiply(state.velocities, momentum);
  report.kinetic_energy = 0.5 * momentum.dot(state.velocities);
  report.elastic_energy = 0;
  report.min_volume_ratio = std::numeric_limits<double>::infinity();
  report.inverted_cells = 0;
  for (const Body& body : world.bodies) {
    report.elastic_energy += body.elastic->value(state.positions, {});
    const double ratio = body.elastic->min_volume_ratio(state.positions).ratio;
    report.min_volume_ratio = std::min(report.min_volume_ratio, ratio);
    if (ratio > 0) continue;
    const std::vector<double> ratios = body.elastic->volume_ratios(state.positions);
    const auto width = static_cast<std::size_t>(body.elastic->num_points());
    for (std::size_t first = 0; first < ratios.size(); first += width) {
      const auto points = std::span(ratios).subspan(first, width);
      if (std::ranges::any_of(points, [](double J) { return !(J > 0); })) ++report.inverted_cells;
    }
  }
  report.words = words();
}

std::string LiveScene::Contents::words() const {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  const std::string share = format_short(report.relative_residual) + " of the load";
  if (report.at_rest) {
    add("at rest: exact equilibrium, the force residual is " + share);
  } else if (is_seeking()) {
    add("nothing moves: going on to the exact equilibrium, the force residual is " + share);
  } else if (!report.converged) {
    add("not solved to the end: after " + std::to_string(report.newton_iterations) +
        (report.newton_iterations == 1 ? " Newton iteration" : " Newton iterations") +
        " the force residual is " + share + "; the next step goes on from there");
  }
  if (report.inverted_cells > 0) {
    add(std::to_string(report.inverted_cells) + (report.inverted_cells == 1 ? " cell is" : " cells are") +
        " turned inside out");
  }
  return text;
}

void LiveScene::Contents::step(const StepBudget& budget) {
  if (report.at_rest) return;
  double seconds = 0;
  {
    const Stopwatch watch(seconds);
    advance_obstacles();
    is_seeking() ? move_to_equilibrium(budget) : move_in_time(budget);
  }
  report.step_ms = 1e3 * seconds;
}

LiveScene::LiveScene(const Description& description) : contents_(std::make_unique<Contents>(description)) {}
LiveScene::~LiveScene() = default;
LiveScene::LiveScene(LiveScene&&) noexcept = default;
LiveScene& LiveScene::operator=(LiveScene&&) noexcept = default;

const World& LiveScene::world() const { return contents_->world; }
const State& LiveScene::state() const { return contents_->state; }
const LiveControls& LiveScene::controls() const { return contents_->controls; }
const LiveReport& LiveScene::report() const { return contents_->report; }
void LiveScene::set_controls(const LiveControls& controls) { contents_->set_controls(controls); }
void LiveScene::reset() { contents_->reset(); }

void LiveScene::grab(MaterialPoint place, const Vector3& target) {
  if (!target.allFinite()) throw InputError("grab", "a finite place", "inf or nan");
  contents_->held = Held{std::move(place), target};
  contents_->wake();
}

void LiveScene::drag(const Vector3& target) {
  std::optional<Held>& held = contents_->held;
  if (!target.allFinite()) throw InputError("drag", "a finite place", "inf or nan");
  if (!held || held->target == target) return;
  held->target = target;
  contents_->wake();
}

void LiveScene::release() {
  if (contents_->held) contents_->wake();
  contents_->held.reset();
}

bool LiveScene::is_grabbed() const { return contents_->held.has_value(); }

void LiveScene::pin(Index node) {
  std::vector<Index>& pinned = contents_->pinned;
  if (node < 0 || node >= contents_->world.num_nodes())
    throw InputError("pin", "a node from 0 to " + std::to_string(contents_->world.num_nodes() - 1),
                     std::to_string(node));
  if (std::ranges::find(pinned, node) != pinned.end()) return;
  pinned.push_back(node);
  const int dim = contents_->world.dimension;
  contents_->state.velocities.segment(Eigen::Index{node} * dim, dim).setZero();
  contents_->renew_fixed();
  contents_->wake();
}

void LiveScene::unpin(Index node) {
  if (std::erase(contents_->pinned, node) == 0) return;
  contents_->renew_fixed();
  contents_->wake();
}

void LiveScene::unpin_all() {
  contents_->pinned.clear();
  contents_->renew_fixed();
  contents_->wake();
}

const std::vector<Index>& LiveScene::pinned() const { return contents_->pinned; }

void LiveScene::poke(const Vector3& center, double radius) {
  Contents& c = *contents_;
  if (!center.allFinite() || !(radius > 0) || !(radius <= 1e3 * c.extent))
    throw InputError("poke", "a finite place and a positive radius of at most a thousand extents",
                     "radius " + format_number(radius));
  if (!c.ball || c.ball_radius != radius) {
    Vector3 middle = Vector3::Zero();
    for (Index node = 0; node < c.world.num_nodes(); ++node)
      middle += node_position(c.world.dimension, node, c.state.positions) / c.world.num_nodes();
    const Vector3 out = center - middle;
    c.ball.emplace("ball", c.world, c.state.positions, std::make_shared<Sphere>(center, radius),
                   out.norm() > 0 ? Vector3(out.normalized()) : c.up,
                   barrier_stiffness * c.controls.youngs_modulus);
    c.ball_radius = radius;
    c.renew_loads();
  }
  c.ball->set_goal(center);
  c.wake();
}

void LiveScene::stop_poking() {
  if (!contents_->ball) return;
  contents_->ball.reset();
  contents_->renew_loads();
  contents_->wake();
}

std::optional<Vector3> LiveScene::ball() const {
  if (!contents_->ball) return {};
  return contents_->ball->barrier()->place({});
}

std::optional<double> LiveScene::ground() const {
  if (!contents_->floor) return {};
  return contents_->floor->barrier()->place({}).dot(contents_->up);
}

Vector3 LiveScene::up() const { return contents_->up; }

void LiveScene::place(const VectorX& positions, const VectorX& velocities) {
  const auto fits = [&](const VectorX& values) {
    return values.size() == contents_->state.positions.size() && values.allFinite();
  };
  if (!fits(positions) || !fits(velocities))
    throw InputError("place", std::to_string(contents_->state.positions.size()) + " finite numbers",
                     std::to_string(positions.size()));
  contents_->state.positions = positions;
  contents_->state.velocities = velocities;
  contents_->wake();
}

const LiveReport& LiveScene::step(const StepBudget& budget) {
  contents_->step(budget);
  return contents_->report;
}

}  // namespace resilin
