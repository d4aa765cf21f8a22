#include "resilin/live/live_contents.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "resilin/contact/half_space.hpp"
#include "resilin/core/error.hpp"
#include "resilin/energy/damping.hpp"
#include "resilin/energy/hand.hpp"
#include "resilin/linear/dependents.hpp"
#include "resilin/material/rest_tangents.hpp"
#include "resilin/world/body_material.hpp"
#include "resilin/world/cell_material.hpp"
#include "resilin/world/colliders.hpp"
#include "resilin/world/contact.hpp"
#include "resilin/world/event_times.hpp"
#include "resilin/world/friction.hpp"
#include "resilin/world/loads.hpp"
#include "resilin/world/rigid_region.hpp"
#include "resilin/world/rigid_shape.hpp"
#include "resilin/world/support_phase.hpp"

namespace resilin {
namespace {

constexpr double longest_step = 0.1;  ///< [s], of those that are played with

/// Against gravity; where there is none, the last axis.
Vector3 up_of(const Description& scene) {
  const Vector3 gravity =
      scene.dimension == 2 ? Vector3(scene.gravity.x(), scene.gravity.y(), 0) : scene.gravity;
  if (gravity.norm() > 0) return -gravity.normalized();
  return scene.dimension == 2 ? Vector3::UnitY() : Vector3::UnitZ();
}

/// Rigid bodies are as stiff as in the scene, with its gravity and the time step that is played with.
void keep_rigid_stiffness(Description& description) {
  if (!has_rigid_bodies(description)) return;
  Description as_played = description;
  as_played.is_dynamic = true;
  if (!description.is_dynamic) as_played.time_step = LiveControls{}.time_step;
  std::vector<std::string> warnings;  // the world has them, too
  const RigidBodies rigid = with_control_nodes(as_played, warnings);
  for (std::size_t b = 0; b < description.bodies.size(); ++b)
    if (std::optional<RigidDescription>& given = description.bodies[b].rigid; given && rigid.shapes[b])
      given->stiffness = rigid.shapes[b]->modulus;
}

/// The scene as it is played with: in motion, with a gravity that can be changed.
Description in_motion(Description description) {
  refuse_releases(description, "a live run");
  if (const std::string place = place_of_rigid_region(description); !place.empty())
    throw InputError(place, "a scene without rigid regions for a live run", "one",
                     "give the region a stiff material, or compute the scene with resilin run");
  keep_rigid_stiffness(description);
  description.is_dynamic = true;
  description.time_step =
      std::min(longest_step, 0.05 * description.end_time);  // fast rotations need short steps
  description.modes.reset();
  description.adaptive.reset();
  // Floor, gravity and damping by mass can be changed.
  std::erase_if(description.colliders, [up = up_of(description)](const ColliderDescription& collider) {
    return is_floor(collider, up);
  });
  description.gravity.setZero();
  for (BodyDescription& body : description.bodies) {
    body.mass = MassKind::lumped;
    body.damping.mass = 0;
  }
  return description;
}

/// When all that changes by itself has come to its end [s]; before, bodies may be still and yet not at rest.
double end_of_changes(const Description& description, const World& world) {
  const auto moves_on = [](const ColliderDescription& collider) {
    const bool turns = collider.rotate && collider.rotate->degrees_per_second != 0;
    return (turns || collider.velocity != Vector3::Zero()) && !collider.until;
  };
  const auto is_endless = [](const auto& entry) {
    return std::holds_alternative<TimeFunction::Sine>(entry.time_function.form) ||
           (entry.velocity != Vector3::Zero() && !entry.until);
  };
  const auto swings = [](const ConstraintDescription& constraint) {
    return std::holds_alternative<TimeFunction::Sine>(constraint.time_function.form);
  };
  if (std::ranges::any_of(description.fixes, is_endless) ||
      std::ranges::any_of(description.loads, is_endless) ||
      std::ranges::any_of(description.constraints, swings) ||
      std::ranges::any_of(description.colliders, is_endless) ||
      std::ranges::any_of(description.colliders, moves_on))
    return std::numeric_limits<double>::infinity();
  return world.event_times.empty() ? 0 : world.event_times.back();
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

}  // namespace

LiveScene::Contents::Contents(const Description& scene, const std::optional<State>& given_start)
    : description(in_motion(scene)),
      world(description),
      newton(world.dimension, world.pattern, live_solver(world)),
      controls(starting_controls(scene, world, up_of(scene))) {
  for (std::size_t b = 0; b < world.bodies.size(); ++b)
    materials.push_back(starting_material(scene.bodies[b], world.bodies[b]));
  drives = Drives(description, world);
  extent = world.largest_extent();
  const bool has_path = !scene.is_dynamic && follows_time(scene);
  path_time = has_path ? scene.end_time : std::numeric_limits<double>::infinity();
  end_of_changes = std::min(resilin::end_of_changes(description, world), path_time);
  up = up_of(scene);
  for (const ColliderDescription& collider : scene.colliders) {
    if (!is_floor(collider, up)) continue;
    controls.has_ground = true;
    controls.ground_friction = collider.friction;
    controls.ground_height = collider.shape.point.dot(up);
    floor_options = {.activation_distance = collider.activation_distance, .stiffness = collider.stiffness};
  }
  start.positions = world.start_positions;
  start.velocities = world.start_velocities;
  start.load = 1;
  start.history = start_of_history(world.terms, start.positions);
  if (given_start) {
    check_places(given_start->positions, given_start->velocities, "start");
    start.positions = given_start->positions;
    start.velocities = given_start->velocities;
    start.time = given_start->time;
    start.load = given_start->load;
    start.collider_delay = given_start->collider_delay;
    // A frame of results has no history: its branches have relaxed.
    constexpr double long_ago = std::numeric_limits<double>::infinity();
    start.history = given_start->history.size() == start.history.size()
                        ? given_start->history
                        : start_of_history(world.terms, start.positions, long_ago);
    was_run = true;
    goes_on = has_path;
    // Large rotations have gone with the load factor, not at once.
    for (std::size_t i = 0; !scene.is_dynamic && i < world.supports.size(); ++i)
      world.supports[i].time_function = scene.fixes[i].time_function;
  }
  reset();
}

void LiveScene::Contents::check_places(const VectorX& positions, const VectorX& velocities,
                                       const char* place) const {
  const Eigen::Index size = world.rest_positions.size();
  for (const VectorX* values : {&positions, &velocities})
    if (values->size() != size || !values->allFinite())
      throw InputError(place, std::to_string(size) + " finite numbers",
                       values->size() != size ? std::to_string(values->size()) : "inf or nan");
}

void LiveScene::Contents::reset() {
  state = start;
  held.reset();
  pinned.clear();
  pinned_points.clear();
  drives.reset(conditions(), world);
  ball.reset();
  floor.reset();
  mending_steps = 0;
  renew_fixed();
  renew_floor(/*least_gap=*/0);  // where bodies start on it, as in a run
  renew_fold_barriers();
  look_at_cells();
  renew_terms();
  report = LiveReport{};
  wake();
  is_as_run = was_run;
}

/// The terms of the world, and those of what can be changed: gravity, floor, ball, damping.
void LiveScene::Contents::renew_terms() {
  const auto all = [this](bool is_in_motion) {
    Terms sum = world.terms;
    if (controls.gravity.head(world.dimension).norm() > 0)
      sum.push_back(make_gravity(controls.gravity, {}, world, is_in_motion));
    for (const auto& barrier : fold_barriers)
      if (barrier) sum.push_back(barrier);
    for (const FaceLoad& load : face_loads) sum.push_back(load.term);
    sum.insert(sum.end(), anchors.begin(), anchors.end());
    if (floor) sum.push_back(floor->barrier());
    if (ball) sum.push_back(ball->barrier());
    if (floor && controls.ground_friction > 0) {
      const std::vector<std::shared_ptr<const FrictionSource>> source = {floor->barrier()};
      const double speed = description.contact.friction_speed.value_or(default_friction_speed(world));
      sum.push_back(std::make_shared<Friction>(world.dimension, source, speed, std::vector<TimeFunction>(1)));
    }
    return sum;
  };
  terms = all(true);
  if (controls.damping > 0)
    terms.push_back(std::make_shared<MassDamping>(
        std::make_shared<const MassMatrix>(world.mass->times(controls.damping))));
  terms_at_rest = terms_without(EnergyCategory::damping, all(false));
}

/// As stiff as the material against a change of volume at rest. What rests does so still.
void LiveScene::Contents::renew_fold_barriers() {
  std::vector<std::shared_ptr<FoldBarrier>> renewed;
  for (const Body& body : world.bodies)
    for (const Domain& domain : body.domains) {
      const std::size_t number = renewed.size();
      renewed.emplace_back();
      if (domain.law_info().needs_positive_J) continue;
      std::vector<double> stiffness;
      for_each_rest_tangent(domain.law_info(), constants_of(*domain.energy),
                            [&](std::size_t, const double* A) { stiffness.push_back(A[0]); });  // dP_00/dF_00
      renewed.back() = std::make_shared<FoldBarrier>(domain.energy, std::move(stiffness));
      if (number < fold_barriers.size() && fold_barriers[number] && fold_barriers[number]->is_resting())
        renewed.back()->rest();
    }
  fold_barriers = std::move(renewed);
}

/// Looks at bodies that were put where they are by a caller, not by steps that have kept cells upright.
void LiveScene::Contents::look_at_cells() {
  for (const auto& barrier : fold_barriers) {
    if (!barrier) continue;
    barrier->rest();
    barrier->look_at(state.positions);
  }
}

/// Places a floor below all bodies; it then rises to its height.
void LiveScene::Contents::renew_floor(double least_gap) {
  const Vector3 goal = controls.ground_height * up;
  const Vector3 begin = floor ? floor->barrier()->place({}) : goal;
  floor.reset();
  if (!controls.has_ground) return;
  ObstacleOptions options = floor_options;
  options.friction = controls.ground_friction;
  options.least_gap = least_gap;
  floor.emplace("ground", world, state.positions, std::make_shared<HalfSpace>(begin, up), -up, options);
  floor->set_goal(goal);
}

/// Floor and ball go where they shall be, as far as the bodies are out of their way.
void LiveScene::Contents::advance_obstacles() {
  if (floor && floor->advance(state.positions)) calm = {};
  if (ball && ball->advance(state.positions)) calm = {};
}

void LiveScene::Contents::renew_fixed() {
  is_fixed = world.is_fixed;
  const int dim = world.dimension;
  const auto fix = [&](Index node) {
    if (follows_others(node)) return;
    for (int k = 0; k < dim; ++k) is_fixed[static_cast<std::size_t>(node * dim + k)] = 1;
  };
  for (const Index node : pinned)
    if (!pinned_points.contains(node)) fix(node);
  for (const HeldFace& face : held_faces)
    for (const Index node : face.nodes) {
      fix(node);
      state.velocities.segment(Eigen::Index{node} * dim, dim).setZero();
    }
  renew_anchors();
}

bool LiveScene::Contents::follows_others(Index node) const {
  const Dependents* dependents = world.dependents();
  for (int k = 0; k < world.dimension; ++k)
    if (dependents != nullptr && dependents->is_dependent(node * world.dimension + k)) return true;
  return false;
}

void LiveScene::Contents::renew_anchors() {
  const bool had_any = !anchors.empty();
  anchors.clear();
  const auto add = [this](const MaterialPoint& point) {
    const Body& body = world.body_of(point.nodes.front());
    const double stiffness = anchor_stiffness(body, controls, world);
    anchors.push_back(std::make_shared<Hand>(world.dimension, point,
                                             point.position(world.dimension, state.positions), stiffness,
                                             std::numeric_limits<double>::infinity()));
  };
  const auto add_node = [&](Index node) {
    if (follows_others(node)) add({.nodes = {node}, .weights = {1}});
  };
  for (const Index node : pinned)
    if (const auto point = pinned_points.find(node); point != pinned_points.end())
      add(point->second);
    else
      add_node(node);
  for (const HeldFace& face : held_faces)
    for (const Index node : face.nodes) add_node(node);
  if (had_any || !anchors.empty()) renew_terms();
}

void LiveScene::Contents::change_materials(const std::vector<BodyControls>& wanted) {
  World changed = world;
  std::vector<BodyDescription> bodies = description.bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (wanted[b] == materials[b] || world.bodies[b].rigid) continue;
    bodies[b].material = material_of(wanted[b], bodies[b].material);
    bodies[b].material.place = "material";
    change_material(changed, b, bodies[b]);
    const double energy = changed.bodies[b].domains.value(state.positions);
    if (std::isfinite(energy)) continue;
    throw InputError("law", "a law that is finite for inverted elements, because there are some",
                     "\"" + wanted[b].law + "\", which needs J > 0 everywhere",
                     "reset the scene, or wait until no cell is inverted");
  }
  world = std::move(changed);
  description.bodies = std::move(bodies);
}

/// Materials, and with them the contact of bodies; all or nothing.
void LiveScene::Contents::change_world(LiveControls& wanted,
                                       const std::vector<BodyControls>& wanted_materials) {
  const World world_before = world;
  const Description description_before = description;
  try {
    if (wanted_materials != materials) change_materials(wanted_materials);
    if (!world.contact) return;
    change_contact(wanted);
  } catch (...) {
    world = world_before;
    description = description_before;
    throw;
  }
  wanted.contact_stiffness = std::ranges::min(world.contact->surface().stiffness);
  wanted.contact_distance = world.contact->activation_distance();
}

void LiveScene::Contents::change_contact(const LiveControls& wanted) {
  ContactDescription changed = description.contact;
  changed.friction = wanted.contact_friction;
  // Values that the scene leaves open follow the bodies until somebody chooses.
  if (wanted.contact_stiffness != controls.contact_stiffness) changed.stiffness = wanted.contact_stiffness;
  if (wanted.contact_distance != controls.contact_distance)
    changed.activation_distance = wanted.contact_distance;
  resilin::change_contact(world, changed);
  description.contact = std::move(changed);
}

void LiveScene::Contents::set_controls(const LiveControls& asked) {
  LiveControls wanted = asked;
  // The hand grows with the stiffness, unless both are set.
  if (wanted.max_force == controls.max_force)
    wanted.max_force *= wanted.youngs_modulus / controls.youngs_modulus;
  std::vector<BodyControls> wanted_materials = materials;
  for (std::size_t b = 0; b < wanted_materials.size(); ++b) {
    BodyControls& material = wanted_materials[b];
    if (world.bodies[b].rigid) continue;  // it keeps its stiffness
    if (wanted.law != controls.law) material.law = wanted.law;
    if (wanted.youngs_modulus != controls.youngs_modulus) material.youngs_modulus = wanted.youngs_modulus;
    if (wanted.poissons_ratio != controls.poissons_ratio) material.poissons_ratio = wanted.poissons_ratio;
  }
  take_over(std::move(wanted), std::move(wanted_materials));
}

void LiveScene::Contents::take_over(LiveControls wanted, std::vector<BodyControls> wanted_materials) {
  check_controls(wanted);
  for (std::size_t b = 0; b < materials.size(); ++b)
    if (wanted_materials[b] != materials[b]) check_controls(with_material(wanted, wanted_materials[b]));
  const bool changes_material = wanted_materials != materials;
  const bool changes_contact = wanted.contact_friction != controls.contact_friction ||
                               wanted.contact_stiffness != controls.contact_stiffness ||
                               wanted.contact_distance != controls.contact_distance;
  if (changes_material || changes_contact) change_world(wanted, wanted_materials);
  const bool changes_floor = wanted.has_ground != controls.has_ground ||
                             wanted.ground_height != controls.ground_height ||
                             wanted.ground_friction != controls.ground_friction || changes_material;
  controls = std::move(wanted);
  materials = std::move(wanted_materials);
  if (changes_floor) renew_floor();
  if (changes_material) renew_fold_barriers();
  renew_terms();
  wake();
}

}  // namespace resilin
