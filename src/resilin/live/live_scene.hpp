#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "resilin/energy/material_point.hpp"
#include "resilin/fields/discretisation_error.hpp"
#include "resilin/live/drive.hpp"
#include "resilin/live/face_load.hpp"
#include "resilin/live/held_face.hpp"
#include "resilin/live/live_controls.hpp"
#include "resilin/simulation/simulation.hpp"

/// A scene that is simulated while someone plays with it.
namespace resilin {

/// Summary of a step, for the head-up line.
struct LiveReport {
  double time = 0;        ///< simulated so far [s]
  bool converged = true;  ///< the step met the tolerance
  bool at_rest = false;   ///< in exact equilibrium: steps change nothing until something is changed
  int newton_iterations = 0;
  int linear_iterations = 0;
  double residual = 0;           ///< force residual [N]
  double relative_residual = 0;  ///< as a share of the load
  double min_volume_ratio = 1;
  Index inverted_cells = 0;
  double elastic_energy = 0, kinetic_energy = 0;      ///< [J]
  double step_ms = 0, assembly_ms = 0, solve_ms = 0;  ///< wall time; the rest is searching and measuring
  DiscretisationErrors discretisation_errors{};       ///< estimated now and then, and at rest
  std::string state;                                  ///< unsolved parts, or that it is at rest
  std::vector<std::string> warnings;  ///< inverted cells, damping because of them; whose cells are too coarse
  std::string words;                  ///< both in one line
};

/// Contact in a live scene.
struct LiveContact {
  double smallest_gap = std::numeric_limits<double>::infinity();  ///< [m], of what is felt
  Index active_pairs = 0;  ///< parts of surfaces, and nodes near a floor or a ball, that feel each other
};

/// How long a step may take.
struct StepBudget {
  /// No Newton iteration begins that would end later, as far as the steps before tell; at least one is done.
  double seconds = 0.012;
};

/// A world that answers a hand.
///
/// Each step is one of backward Euler, solved by Newton's method until the tolerance or the end of the time
/// budget, whichever is first, and at least one iteration long. Cut short or not, a step never raises the
/// incremental potential, and never the total energy except by what the hand, the floor and the ball do:
/// docs/theory/real_time.md. When nothing moves, steps lead on to the exact equilibrium.
///
/// Not for several threads at once. Setters throw InputError with one line for a value that cannot be; the
/// scene is then as before.
class LiveScene {
 public:
  /// Static scenes move under their full loads. Throws InputError.
  ///
  /// @param start  a state that a run of this scene has left, from which it goes on, and to which `reset`
  ///               comes back: its places, velocities, time, load factor and delay of colliders; none: the
  ///               scene's own. What a static run left keeps its load factor, or goes on along its path.
  explicit LiveScene(const Description& description, const std::optional<State>& start = {});
  ~LiveScene();
  LiveScene(LiveScene&&) noexcept;
  LiveScene& operator=(LiveScene&&) noexcept;

  const World& world() const;
  const State& state() const;
  Conditions conditions() const;  ///< under which the state's forces are taken: where colliders are
  const LiveControls& controls() const;
  const LiveReport& report() const;  ///< report of the last step
  /// Searched for at each call; none where nothing can touch.
  std::optional<LiveContact> contact() const;

  /// Takes over all controls that differ from the present ones.
  void set_controls(const LiveControls& controls);

  /// Materials of the bodies, in their order.
  const std::vector<BodyControls>& materials() const;
  /// Gives one body another material; those of the others stay.
  void set_material(std::size_t body, const BodyControls& material);
  /// Contact as it was read or chosen since: what is left open follows the bodies.
  const ContactDescription& contact_choices() const;

  /// The hand takes hold of a place of a body and pulls it towards `target` [m] until `release`.
  void grab(MaterialPoint place, const Vector3& target);
  void drag(const Vector3& target);  ///< has no effect when nothing is held
  void release();
  bool is_grabbed() const;
  Vector3 hand_force() const;  ///< on the body; zero when nothing is held [N]

  /// Holds a node where it is now; all components. Of a rigid body the point `place`, by a stiff spring.
  /// @param place  used for a control node of a rigid body alone; none: the node itself
  void pin(Index node, const std::optional<MaterialPoint>& place = {});
  void unpin(Index node);
  void unpin_all();
  const std::vector<Index>& pinned() const;

  /// Holds vertices of a body's mesh, a rigid body as a whole, where they are now, and after a reset where
  /// they start; all components. Refuses vertices that a support of the scene moves.
  /// @return the number by which they are let go
  int hold(std::size_t body, std::vector<Index> vertices);
  void let_go(int number);
  const std::vector<HeldFace>& held_faces() const;  ///< in the order in which they were taken

  /// Puts a load on the facets of a body's mesh between these vertices; it stays after a reset.
  /// @return the number by which it is removed
  int put_load(std::size_t body, std::vector<Index> vertices, const FaceLoadChoice& choice);
  void remove_load(int number);
  const std::vector<FaceLoad>& face_loads() const;  ///< in the order in which they were put there

  /// Motors of joints, then cables, with their present values.
  const std::vector<Drive>& drives() const;
  /// Drives a motor or a cable towards a value, in place of the scene's time function. It goes there within
  /// half a second, stays driven after a reset, and begins there where the scene has it.
  void drive(std::size_t number, double value);
  /// Leaves all of them to the scene again, at once.
  void stop_driving();

  /// Stops all motion: the steps that follow lead to the equilibrium. Refused where that depends on the way,
  /// as with friction, and while loads or supports change.
  void settle();

  /// A ball that pushes bodies away; it goes towards `center` as fast as they let it.
  void poke(const Vector3& center, double radius);
  void stop_poking();
  std::optional<Vector3> ball() const;  ///< where its centre is now [m]
  /// Where the floor is now, on its way to the height of the controls; along `up` [m].
  std::optional<double> ground() const;
  Vector3 up() const;  ///< against the gravity that the scene began with

  /// Puts all nodes elsewhere at once, dim numbers each [m], [m/s]; what is held and pinned stays so.
  /// @param time  that loads and supports then have [s]; none: they go on
  void place(const VectorX& positions, const VectorX& velocities, std::optional<double> time = {});

  /// Back to the start; the controls and the held faces stay.
  void reset();

  /// One time step. When the scene is at rest this returns at once.
  const LiveReport& step(const StepBudget& budget = {});

 private:
  struct Contents;
  std::unique_ptr<Contents> contents_;
};

}  // namespace resilin
