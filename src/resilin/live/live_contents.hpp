#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "resilin/energy/hand.hpp"
#include "resilin/live/drive.hpp"
#include "resilin/live/fold_barrier.hpp"
#include "resilin/live/live_scene.hpp"
#include "resilin/live/obstacle.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/stage_solver.hpp"

/// Contents of a live scene. For the sources of this module alone.
namespace resilin {

/// A material point that the mouse drags, and its target [m].
struct Held {
  MaterialPoint place;
  Vector3 target;
};

/// Number of consecutive quiet steps before the scene seeks its equilibrium.
constexpr int quiet_steps_before_seeking = 10;

/// Nothing moves any more: from here on steps lead straight to the equilibrium.
struct Calm {
  int quiet_steps = 0;    ///< in a row in which nothing moved to speak of
  int seeking_steps = 0;  ///< since then, towards the equilibrium
};

/// State of a live scene, its controls and its energy terms.
struct LiveScene::Contents {
  Contents(const Description& scene, const std::optional<State>& given_start);

  void reset();
  void wake() { calm = {}, report.at_rest = false; }
  void renew_terms();
  void renew_fixed();
  void renew_floor(double least_gap = ObstacleOptions{}.least_gap);
  void check_places(const VectorX& positions, const VectorX& velocities, const char* place) const;
  void renew_fold_barriers();  ///< the terms are then to be renewed
  void look_at_cells();
  void advance_obstacles();
  void set_controls(const LiveControls& asked);
  /// Takes over controls and the materials of all bodies.
  void take_over(LiveControls wanted, std::vector<BodyControls> wanted_materials);
  /// The terms are then to be renewed.
  void change_world(LiveControls& wanted, const std::vector<BodyControls>& wanted_materials);
  void change_materials(const std::vector<BodyControls>& wanted);
  void change_contact(const LiveControls& wanted);

  bool is_seeking() const;
  /// Time from which nothing changes by itself [s].
  double changes_end() const {
    return std::min(drives.any_is_endless() ? path_time : end_of_changes, path_time);
  }
  /// Time of loads and boundary conditions: that of a static scene ends with its path.
  double scene_time(double time) const { return std::min(time, path_time); }
  /// Likewise the load factor: that of the start, unless a static run goes on along its path.
  double scene_load(double time) const { return goes_on ? scene_time(time) / path_time : state.load; }
  /// Places that pins and held faces hold by stiff springs: points of rigid bodies, and nodes that ties,
  /// joints and constraints couple to others.
  void renew_anchors();
  /// Whether a node follows others, so that it cannot be fixed for itself.
  bool follows_others(Index node) const;
  /// Whether supports, or constants of constraints, lead nodes from one state to the next.
  bool are_nodes_led(const Conditions& after, const VectorX& targets) const;
  Conditions conditions() const {
    return {.time = scene_time(state.time), .load = scene_load(state.time), .delay = state.collider_delay};
  }
  void step(const StepBudget& budget);
  NewtonReport minimize(Potential& potential, const Flight& guess, const VectorX& targets, double tolerance,
                        const StepBudget& budget, VectorX& x);
  std::shared_ptr<const Hand> hand() const;  ///< null: nothing is held
  Vector3 hand_force() const;
  Terms with_hand(Terms all) const;
  void move_in_parts(const StepBudget& budget);
  void move_in_time(double dt, const StepBudget& budget);
  void move_to_equilibrium(const StepBudget& budget);
  void count_mending_steps();
  double mending_factor() const;  ///< factor by which a step in time is longer than asked for
  void measure(const NewtonReport& newton_report);
  std::optional<LiveContact> contact() const;
  void note_calm(double dt);
  void estimate_now_and_then();
  void say();  ///< the words of the report
  double unloaded_scale() const;

  Description description;
  World world;  ///< world of the scene, without gravity, floor and damping by mass, which can be changed
  Terms terms;  ///< those of the world, and what controls have added
  Terms terms_at_rest;  ///< the same for the equilibrium that a static run finds: see make_gravity
  std::vector<std::uint8_t> is_fixed;  ///< by supports, pins and held faces
  Newton newton;
  LiveControls controls;                ///< with the material of the first body
  std::vector<BodyControls> materials;  ///< one for each body
  State start;                          ///< to which a reset comes back
  State state;
  LiveReport report;
  std::optional<Held> held;
  std::vector<std::shared_ptr<FoldBarrier>>
      fold_barriers;  ///< by domain, body after body; null where the law has its own
  std::optional<Obstacle> floor, ball;
  ObstacleOptions floor_options;  ///< the scene's own settings
  double ball_radius = 0;
  Vector3 up = Vector3::UnitZ();  ///< normal of the floor, whatever gravity becomes
  std::vector<Index> pinned;
  std::map<Index, MaterialPoint> pinned_points;  ///< by pinned node of a rigid body: the point that is held
  Terms anchors;                                 ///< see renew_anchors
  Drives drives;
  std::vector<HeldFace> held_faces;
  std::vector<FaceLoad> face_loads;
  Calm calm;
  double overrun = 0;     ///< time that steps take after their last iteration should have begun [s]
  int mending_steps = 0;  ///< in a row that are longer, since cells were inside out
  double extent = 1;
  double end_of_changes = 0;  ///< [s]
  double path_time = 0;       ///< path time of a static scene: when it has its full load [s]
  bool goes_on = false;       ///< a static scene from where a run has left it on such a path
  bool was_run = false;       ///< the start is that of a run
  bool is_as_run = false;     ///< since a run has left it here, nobody has laid hand on it
};

}  // namespace resilin
