#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "resilin/contact/cable_friction.hpp"
#include "resilin/contact/collider_barrier.hpp"
#include "resilin/contact/friction.hpp"
#include "resilin/contact/obstacle_contact.hpp"
#include "resilin/core/process_group.hpp"
#include "resilin/core/shared_indices.hpp"
#include "resilin/energy/elastic.hpp"
#include "resilin/energy/mass.hpp"
#include "resilin/world/description.hpp"
#include "resilin/world/domain.hpp"
#include "resilin/world/fingerprint.hpp"
#include "resilin/world/joint.hpp"
#include "resilin/world/probe.hpp"
#include "resilin/world/scene_part.hpp"
#include "resilin/world/section.hpp"
#include "resilin/world/skin.hpp"
#include "resilin/world/support.hpp"

namespace resilin {

class Dependents;
struct LinearConstraints;
struct RigidShape;

/// One body in the world's numbering of nodes.
struct Body {
  std::string name;
  std::string element;
  std::string element_reason;  ///< why `element` was chosen; empty when the user chose it
  MassKind mass_kind = MassKind::lumped;
  Index first_node = 0;
  Index num_nodes = 0;     ///< those of the mesh, then those that the element adds
  Index num_vertices = 0;  ///< number of vertices of the mesh
  /// For each further node, also such as no cell uses: the vertices, from the body's first, between which it
  /// was added.
  std::vector<std::array<Index, 2>> ends_of_added;
  CellKind cell_kind = CellKind::tetrahedron;
  SharedIndices cells;  ///< nodes of the cells, in the world's numbering
  Domains domains;
  std::shared_ptr<const Skin> skin;           ///< null for a body without
  std::shared_ptr<const RigidShape> rigid{};  ///< null for a deformable body
  MeetingSurface contact_surface = MeetingSurface::boundary;
  double mass = 0;  ///< [kg]

  bool has_regions() const { return domains.size() > 1 || domains.front().region >= 0; }
  bool meets_with_skin() const { return contact_surface == MeetingSurface::skin; }
  Index num_cells() const { return static_cast<Index>(cells.size()) / resilin::num_nodes(cell_kind); }
};

/// Origin of a term of a world.
struct TermOrigin {
  enum class Kind {
    domain,
    load,
    gravity,
    collider,
    contact,
    friction,
    inertia,
    joint,  ///< a term of a joint; `domain` is its number there
    spring,
    cable,
    viscous_damping,  ///< viscous damping of a domain
    mass_damping,
    release  ///< forces of supports while they let go, in statics
  };
  Kind kind;
  std::size_t number = 0;  ///< number of the load or the collider in the description, or of the body
  std::size_t domain = 0;  ///< its number in the body

  bool operator==(const TermOrigin&) const = default;
};

/// From where to where something reaches along an axis [m].
struct Reach {
  double low, high;
  double length() const { return high - low; }
};

class World;

/// The number of the body with this name, or of the only one where no name is given. Throws InputError, which
/// begins with `place`, where there is none.
std::size_t find_body(const World& world, const std::string& name, const std::string& place);

/// Reach of all nodes of the body, at the positions of all bodies (`dim` numbers per node).
Reach reach_along(int axis, const Body& body, const VectorX& positions, int dim);

/// The longest reach of the body along the axes [m].
double largest_extent(const Body& body, const VectorX& positions, int dim);

/// Everything about a simulation that does not change while it runs. A value: no step changes it, but for
/// supports that the steps of a scene release or activate (support_phase.hpp).
class World {
 public:
  /// Checks and assembles a description. Throws InputError, whose message begins with the place of the fault.
  explicit World(Description description)
      : World(std::make_shared<const Description>(std::move(description))) {}
  explicit World(const std::shared_ptr<const Description>& shared) : World(*shared, shared) {}
  /// One process's part of a scene, which has been checked as a whole. All processes make theirs together.
  World(const ScenePart& part, ProcessGroup share_of_part);

  int dimension = 3;
  double thickness = 1;  ///< thickness of plane scenes [m]
  bool is_dynamic = false;
  std::string title;
  std::string place;
  std::shared_ptr<const Description> made_from;  ///< null once a material or contact was changed
  Vector3 gravity = Vector3::Zero();             ///< [m/s^2]
  TimeFunction gravity_function;                 ///< see Description
  double time_step = 0;
  double end_time = 0;
  double path_time = 0;  ///< static: the time at load factor 1, where anything follows time; else 0 [s]
  int load_steps = 1;
  bool follows_path = false;  ///< static: by arc length
  int max_steps = 0;
  UnstableModes unstable_modes = UnstableModes::automatic;
  OnJump on_jump = OnJump::follow;
  std::string integrator;
  std::optional<AdaptiveSteps> adaptive;
  std::optional<ModesOptions> modes;  ///< set for a modal analysis
  std::vector<StepDescription> steps;
  std::vector<double> event_times;  ///< where loads and prescribed motions are not smooth, rising [s]
  /// On the coefficients of friction, by the collider; those between bodies under "". None: 1.
  std::map<std::string, TimeFunction> friction_factors;
  int friction_iterations = 0;  ///< friction iterations of ContactDescription
  NewtonOptions newton;
  SolverOptions solver;
  OutputOptions output;
  Fingerprint fingerprint;  ///< fingerprint of the description; a caller's own terms are not in it

  ProcessGroup share;  ///< the whole scene, unless other processes have parts of it
  std::vector<std::vector<Index>>
      cell_numbers;  ///< cell numbers of a part, by body: numbers of its cells in the whole

  /// Where the coordinates of positions begin, in those of the scene: zero, but for scenes far from there
  /// (find_scene_origin). Whatever goes out to the user as a place adds it [m].
  Vector3 origin = Vector3::Zero();
  VectorX rest_positions;       ///< [m], dim numbers per node, body after body
  VectorX other_contact_shape;  ///< see contact_shape; empty where that is the rest shape of all bodies
  VectorX start_positions;      ///< [m]
  VectorX start_velocities;     ///< dynamics [m/s]
  std::vector<Body> bodies;
  std::vector<Support> supports;
  std::vector<Probe> probes;
  std::vector<Section> sections;
  std::vector<std::string> warnings;      ///< one line each
  std::vector<std::string> run_warnings;  ///< likewise, of a run to which no hand adds: see all_warnings
  std::vector<std::string> notes;         ///< choices made for the user, one line each

  /// All energy terms: strain energies domain by domain, loads and gravity, colliders, inertia, damping. A
  /// caller may add terms of its own.
  Terms terms;
  std::vector<TermOrigin> origins;         ///< origins of `terms`, but for those that a caller has added
  std::shared_ptr<const MassMatrix> mass;  ///< lumped in statics, however bodies in motion would have it
  // Colliders are among the terms; here they are for who draws them.
  std::vector<std::shared_ptr<const ColliderBarrier>> colliders;       ///< colliders with an exact distance
  std::vector<std::shared_ptr<const ObstacleContact>> mesh_colliders;  ///< those of facets
  std::shared_ptr<const SurfaceContact> contact;  ///< one of `terms`; null without contact between bodies
  /// Contact by phase (support_phase.hpp); empty where no step switches a contact pair.
  std::vector<std::shared_ptr<const SurfaceContact>> contact_of_phases;
  std::shared_ptr<const Friction> friction;  ///< one of `terms`; null without friction
  std::shared_ptr<const BlockPattern> pattern;
  std::vector<std::uint8_t> is_fixed;    ///< per DOF: prescribed, or of a vertex that no cell uses
  std::vector<std::int32_t> support_of;  ///< per DOF: index of its boundary condition; -1: none
  std::vector<double> switch_times;      ///< see support_phase.hpp; empty: there is one phase [s]
  // Empty where no step releases a support or switches a contact pair:
  std::vector<std::uint8_t> is_fixed_otherwise;  ///< per DOF: fixed without supports
  std::vector<std::int32_t> released_from;       ///< per DOF: the support that is letting go of it; -1: none
  VectorX support_places;                        ///< see held_from
  /// Ties and linear constraints, whose dependent DOFs are among the fixed ones; null without any.
  std::shared_ptr<const LinearConstraints> constraints;
  /// Activation distances that were chosen shorter than the default, by contact term [m].
  std::vector<std::pair<TermOrigin, double>> shorter_distances;
  std::vector<Joint> joints;
  std::vector<std::shared_ptr<const Cable>> cables;  ///< springs, then cables
  std::vector<std::shared_ptr<const CableFriction>>
      cable_frictions;  ///< friction of each of them; null: none
  /// The unknowns that follow from others by these; null: none.
  const Dependents* dependents() const;

  /// Conditions of a static run at a load factor: time is the path parameter.
  Conditions at_load(double load) const { return {.time = load * path_time, .load = load}; }
  /// The rest shape by which contact measures, likewise.
  const VectorX& contact_shape() const {
    return other_contact_shape.size() > 0 ? other_contact_shape : rest_positions;
  }
  /// Where supports move their nodes from [m].
  const VectorX& held_from() const { return support_places.size() > 0 ? support_places : rest_positions; }
  /// The number of the term that this has made, if it has made one.
  std::optional<std::size_t> find_term(const TermOrigin& of) const;
  /// Likewise of a load, which makes one, and of a domain.
  std::size_t term_of_load(std::size_t load) const;
  std::size_t term_of_domain(std::size_t body, std::size_t domain) const;
  /// Number of internal variables of all terms: those of one term after another make up State::history.
  Eigen::Index num_history_values() const;
  bool keeps_history() const { return num_history_values() > 0; }
  /// Those of a domain, of all of a state.
  VectorX history_of_domain(std::size_t body, std::size_t domain, const VectorX& history) const;
  Index num_nodes() const { return static_cast<Index>(rest_positions.size() / dimension); }
  /// In the scene's coordinates [m].
  Vector3 place_of(Index node, const VectorX& positions) const;
  /// "(0.1, 0.2, 0)": a place given in the scene's coordinates [m], as a message shows it.
  std::string place_text(const Vector3& point) const;
  /// Words for a node, or for a vertex of a surface, the places being those of its vertices.
  std::string place_text(Index vertex, const VectorX& places) const;
  Index num_free_unknowns() const;
  double largest_extent() const;  ///< largest extent of the rest shapes of all bodies, along the axes [m]
  double largest_extent(const Body& body) const;  ///< likewise, of a body
  /// Number of a cell in the whole body.
  Index cell_number(std::size_t body, Index cell) const {
    return share.is_whole() ? cell : cell_numbers[body][static_cast<std::size_t>(cell)];
  }
  const Body& body_of(Index node) const;
  /// Whether contact acts between two bodies, by their numbers.
  bool meet(std::size_t a, std::size_t b) const;

 private:
  World(const Description& description, std::shared_ptr<const Description> shared,
        const ScenePart* part = nullptr, ProcessGroup share_of_part = {});
};

/// Largest rotation of a boundary condition or collider between two conditions [degrees].
double largest_turn(const World& world, const Conditions& from, const Conditions& to);

/// All warnings about running a world, one line each.
std::vector<std::string> all_warnings(const World& world);

/// The names of terms of a category.
std::vector<std::string> names_of_terms(const World& world, EnergyCategory category);

/// Throws InputError naming the part of a body that neither boundary conditions nor terms constrain: its free
/// rigid-body motions would make the static problem singular.
void check_is_held(const World& world);

}  // namespace resilin
