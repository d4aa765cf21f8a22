#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "resilin/contact/catalog.hpp"
#include "resilin/contact/collider_motion.hpp"
#include "resilin/core/spelling.hpp"
#include "resilin/core/types.hpp"
#include "resilin/energy/time_function.hpp"
#include "resilin/energy/viscoelastic_form.hpp"
#include "resilin/mesh/mesh.hpp"

/// A simulation as plain data: the scene file, the Python dict and C++ programs all fill these structs, and
/// `World` is made from them. Defaults stand here and nowhere else.
///
/// `place` says where a struct came from ("beam.toml: [[load]] 1") and begins every message about it.
namespace resilin {

// Choices with their spellings in a scene file, in order (core/spelling.hpp).

/// Mass matrix.
enum class MassKind { lumped, consistent };
constexpr std::array<std::string_view, 2> spellings(MassKind) { return {"lumped", "consistent"}; }

/// Projection of negative eigenvalues of the element Hessians; `automatic` chooses for statics and dynamics.
enum class ProjectionChoice { automatic, none, clamp, absolute };
constexpr std::array<std::string_view, 4> spellings(ProjectionChoice) {
  return {"auto", "none", "clamp", "absolute"};
}

/// Contact surface of a body: the boundary of its cells, or its skin.
enum class MeetingSurface { boundary, skin };
constexpr std::array<std::string_view, 2> spellings(MeetingSurface) { return {"boundary", "skin"}; }

/// Where laws that need J > 0 enforce it: at the quadrature points, or everywhere in each cell.
enum class InversionBound { points, everywhere };
constexpr std::array<std::string_view, 2> spellings(InversionBound) { return {"points", "everywhere"}; }

/// Control of a static run: load increments, or arc length along the equilibrium path.
enum class LoadControlKind { load, arc_length };
constexpr std::array<std::string_view, 2> spellings(LoadControlKind) { return {"load", "arc_length"}; }

/// Whether a static run goes on where bodies jump to another equilibrium.
enum class OnJump { follow, stop };
constexpr std::array<std::string_view, 2> spellings(OnJump) { return {"follow", "stop"}; }

/// Count of unstable modes of each equilibrium; `automatic` counts where it is cheap.
enum class UnstableModes { automatic, count, skip };
constexpr std::array<std::string_view, 3> spellings(UnstableModes) { return {"auto", "count", "skip"}; }

/// Output of a run: files for ParaView, a page for browsers, a USD stage for Blender and Houdini.
enum class OutputFormat { vtu, html, usda };
constexpr std::array<std::string_view, 3> spellings(OutputFormat) { return {"vtu", "html", "usda"}; }

/// Constants of a viscoelastic material: those of a sudden load, or those after a long time.
enum class Moduli { instantaneous, long_term };
constexpr std::array<std::string_view, 2> spellings(Moduli) { return {"instantaneous", "long_term"}; }

/// Selection of vertices of a body, in its reference configuration after scale, rotate and translate.
struct Where {
  enum class Kind { all, group, box, plane, sphere, vertices, face };
  Kind kind = Kind::all;
  std::string group;              ///< group: physical group of the mesh
  Vector3 min = Vector3::Zero();  ///< box: corners, inclusive [m]
  Vector3 max = Vector3::Zero();
  int axis = 0;                      ///< plane: 0, 1, 2 for x, y, z
  double at = 0;                     ///< plane: coordinate [m]
  std::optional<double> tolerance;   ///< plane: half thickness [m]; default 1e-6 of the body's largest extent
  Vector3 center = Vector3::Zero();  ///< sphere [m]
  double radius = 0;                 ///< sphere [m]
  std::vector<Index> vertices;       ///< vertices: numbers in the body's mesh, from 0
  Vector3 face_at = Vector3::Zero();  ///< face: a point on the surface; its face is meant [m]
  /// Restricts the selection to facets whose outward normals differ from this one by `angle` at most.
  std::optional<Vector3> normal;
  double angle = 35;  ///< face: between the normals of neighbours; normal: from it [degrees]

  /// Whether it means facets of the surface, and vertices as theirs.
  bool means_facets() const { return kind == Kind::face || normal.has_value(); }
  /// Whether other vertices may be meant once these move.
  bool is_by_place() const {
    return means_facets() || kind == Kind::box || kind == Kind::plane || kind == Kind::sphere;
  }
};

/// Finite-strain viscoelasticity by a Prony series (docs/theory/viscoelasticity.md).
struct ViscoelasticDescription {
  std::string place = "material.viscoelastic";
  /// Share of each branch in the moduli that relax: of the instantaneous or of the long-term ones, as
  /// `moduli` says.
  std::vector<double> g;
  std::vector<double> k{};  ///< likewise in the bulk modulus; empty: the pressure does not relax by itself
  std::vector<double> tau;  ///< relaxation time of each branch [s]
  Moduli moduli = Moduli::instantaneous;
  ViscoelasticForm formulation = ViscoelasticForm::simo;
};

/// Softening by the largest strain energy so far (docs/theory/mullins.md).
struct MullinsDescription {
  std::string place = "material.mullins";
  double r = 2;     ///< > 1: at most 1/r of the isochoric stress is lost
  double m = 0;     ///< [J/m^3]
  double beta = 0;  ///< share of the largest energy
};

/// Constitutive model and constants of a body or region.
struct MaterialDescription {
  std::string place = "material";
  std::string law = "stable_neo_hookean";  ///< a name of material/catalog.hpp
  /// "youngs_modulus" and "poissons_ratio", or the constants of the law's formula by name.
  std::map<std::string, double> constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.4}};
  /// A value for each cell in place of the single one of the same name.
  std::map<std::string, std::vector<double>> cell_constants;
  /// For a law with fibres: the reference directions of each family, one for all cells or one for each, in
  /// the axes of the mesh; they rotate with the body's `rotate`. Their length does not matter.
  std::vector<std::vector<Vector3>> fibres;
  double density = 1000;  ///< reference density [kg/m^3]
  std::optional<ViscoelasticDescription> viscoelastic{};
  std::optional<MullinsDescription> mullins{};
};

/// A prescribed rotation about an axis.
struct Rotation {
  Vector3 axis = Vector3::UnitZ();
  Vector3 center = Vector3::Zero();  ///< [m]
  double degrees = 0;                ///< at load factor 1
};

/// Damping forces in dynamics (docs/theory/damping.md).
struct DampingDescription {
  double mass = 0;             ///< mass-proportional [1/s]
  double stiffness = 0;        ///< stiffness-proportional, on the Green strain rate [s]
  double shear_viscosity = 0;  ///< [Pa s]
  double bulk_viscosity = 0;   ///< [Pa s]
};

/// A fine surface embedded in a body's cells; transformed with the body's mesh.
struct SkinDescription {
  std::string place = "skin";
  Mesh surface{};            ///< triangles; in 2D also lines
  std::string surface_name;  ///< the file, for messages
  bool is_smooth = false;    ///< see Embedding
};

/// A body that keeps its shape (docs/rigid.md).
struct RigidDescription {
  std::string place = "body.rigid";
  std::optional<double> density{};  ///< [kg/m^3]; needed in motion
  std::optional<double>
      stiffness{};  ///< Young's modulus against stretching [Pa]; default: see with_control_nodes
  /// The body of which this one is a region (rigid_region.hpp); empty: it stands alone
  std::string region_of{};
};

/// Cells of a body that are of another material than the body. They share the body's nodes.
struct RegionDescription {
  std::string place = "body.region";
  std::string name;
  /// Cells whose centroid it holds; of a group its cells, of listed vertices the cells that have no others.
  /// A cell belongs to the first region that means it.
  Where where;
  std::optional<std::vector<Index>> cells;  ///< their numbers in the mesh, in place of `where`
  /// Lists by cell have an entry for each cell of the body.
  MaterialDescription material;
  std::optional<RigidDescription> rigid{};  ///< in place of a material
};

/// A deformable body of a scene.
struct BodyDescription {
  std::string place = "body";
  std::string name = "body";
  Mesh mesh;
  std::string mesh_name;         ///< the file, or "box", for messages
  std::string element = "auto";  ///< a name of element/catalog.hpp, or auto: see choose_element
  std::string quadrature;        ///< a rule's name; empty: the element's own
  MaterialDescription material;  ///< material of the cells that belong to no region
  std::vector<RegionDescription> regions;
  double scale = 1;
  std::optional<Rotation> rotate;                               ///< about the origin, after scale
  Vector3 translate = Vector3::Zero();                          ///< [m], after rotate
  Vector3 velocity = Vector3::Zero();                           ///< at the start [m/s]
  Eigen::Matrix3d velocity_gradient = Eigen::Matrix3d::Zero();  ///< adds G X [1/s]
  /// dim per vertex of the mesh [m]; empty: the rest shape. Nodes that the element adds start in the middle
  /// of their edges.
  std::vector<double> initial_positions;
  std::vector<double>
      initial_velocities;  ///< dim per vertex [m/s]; empty: from velocity and velocity_gradient
  /// dim per vertex of the mesh [m]: the rest shape by which contact measures, from which it takes areas and
  /// its reach and in which a skin is carried; empty: that of the mesh. Derivatives by rest positions hold
  /// it.
  std::vector<double> contact_shape;
  MassKind mass = MassKind::lumped;
  DampingDescription damping;
  MeetingSurface contact_surface = MeetingSurface::boundary;
  std::optional<SkinDescription> skin;
  std::optional<RigidDescription> rigid{};  ///< in place of materials
};

/// Dirichlet boundary condition: prescribed displacement.
struct FixDescription {
  std::string place = "fix";
  std::string name;  ///< name of the reaction in the report
  std::string body;  ///< may stay empty when there is one body
  Where where;
  std::array<bool, 3> components = {true, true, true};
  Vector3 displacement = Vector3::Zero();              ///< at load factor 1 [m]
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();  ///< adds G X, X the reference position
  std::optional<Rotation> rotate;                      ///< in place of displacement and gradient
  Vector3 velocity = Vector3::Zero();                  ///< prescribed velocity [m/s] ...
  std::optional<double> until;                         ///< ... until this time; then it stays [s]
  TimeFunction time_function;  ///< on displacement, gradient and rotate, in place of the load factor
  /// Times at which it lets go of its vertices, takes hold of them where they are, and so on, rising [s].
  std::vector<double> switches;
  bool reports_stiffness = false;  ///< static: its tangent stiffness at the end is in the report
};

/// A load of a scene: Neumann condition, body force or spring.
struct LoadDescription {
  std::string place = "load";
  std::string name;
  std::string body;
  std::string kind = "body_force";  ///< a name of world/load_catalog.cpp
  Where where;
  /// body_force [N/m^3], traction [N/m^2] (dead load on the reference surface), force [N] in total, moment
  /// [N m], nodal_force [N] on each vertex.
  Vector3 value = Vector3::Zero();
  double pressure = 0;           ///< follower pressure [Pa], positive inwards; in 2D also a moment [N m]
  std::optional<Vector3> point;  ///< where a force attacks [m]; without one at the centroid of its area
  double stiffness = 0;          ///< spring [N/m] on each vertex
  Vector3 displacement =
      Vector3::Zero();                 ///< spring: its far end stands at rest position + displacement [m] ...
  Vector3 velocity = Vector3::Zero();  ///< ... and moves on at this speed [m/s]
  double from = 0;                     ///< acts from this time [s] ...
  std::optional<double> until;         ///< ... until this time [s]
  TimeFunction time_function;  ///< on the load, of a spring on its displacement, in place of the load factor
};

/// A rigid obstacle with prescribed motion.
struct ColliderDescription {
  std::string place = "collider";
  std::string name;                 ///< name of the contact force in the report
  std::string kind = "half_space";  ///< a name of contact/catalog.cpp
  ShapeDescription shape;
  Vector3 velocity = Vector3::Zero();         ///< [m/s] ...
  std::optional<double> until;                ///< ... until this time [s]
  Vector3 displacement = Vector3::Zero();     ///< at load factor 1 [m]
  TimeFunction time_function;                 ///< on displacement, in place of the load factor
  std::optional<ColliderTurn> rotate;         ///< until the same time
  std::optional<double> activation_distance;  ///< [m]; default: see default_activation_distance
  std::optional<double>
      stiffness;        ///< stiffness of the barrier [Pa]; default 0.1 of each body's Young's modulus
  double friction = 0;  ///< Coulomb friction coefficient
  TimeFunction friction_factor;  ///< on it; a constant one is 1
};

/// A contact pair (two bodies, or one and itself) with its own settings.
struct ContactPairDescription {
  std::string place = "contact.pair";
  std::array<std::string, 2> bodies;
  bool is_enabled = true;
  std::optional<double> friction;  ///< Coulomb friction coefficient; default that of all bodies
  /// When the steps of a scene end its contact and let it begin again, in turn, rising [s].
  std::vector<double> switches{};
};

/// Contact between bodies and self-contact.
struct ContactDescription {
  std::string place = "contact";
  bool is_enabled = true;                     ///< false: bodies pass through each other
  bool with_themselves = false;               ///< self-contact of each body
  std::optional<double> activation_distance;  ///< [m]; default: see default_activation_distance
  std::optional<double>
      stiffness;        ///< stiffness of the barrier [Pa]; default 0.1 of each body's Young's modulus
  double friction = 0;  ///< Coulomb friction coefficient of bodies on each other and on themselves
  std::optional<double> friction_speed;  ///< [m/s]; default: see default_friction_speed
  TimeFunction friction_factor;          ///< on all of these coefficients; a constant one is 1
  int friction_iterations = 50;          ///< limit of lagged friction iterations per stage
  std::vector<ContactPairDescription> pairs;
};

/// A surface that a tie glues to another one; their meshes need not match.
struct TiedSurface {
  std::string place = "tie.surfaces";
  std::string body;
  Where where;
};
struct TieDescription {
  std::string place = "tie";
  std::string name;                     ///< name of the force in the report
  std::array<TiedSurface, 2> surfaces;  ///< the first follows the second
  bool closes_gap = false;              ///< the surfaces are brought together; else the gap at rest stays
  std::optional<double> max_distance;   ///< [m]; default half the size of the facets that follow
};

/// Kinds of joints between rigid bodies.
enum class JointKind { ball, hinge, slider, cylindrical, planar, universal, fixed, distance };
constexpr std::array<std::string_view, 8> spellings(JointKind) {
  return {"ball", "hinge", "slider", "cylindrical", "planar", "universal", "fixed", "distance"};
}

/// The motor of a hinge or a slider: it moves the second body against the first, or against the ground.
struct MotorDescription {
  double position = 0;              ///< at a factor 1 [rad or m]
  std::optional<double> velocity;   ///< in place of a position, at a factor 1 [rad/s or m/s]
  std::optional<double> effort;     ///< in place of a position: torque or force at a factor 1 [N m or N]
  std::optional<double> stiffness;  ///< [N m/rad or N/m]; default from the stiffness of the rigid bodies
  TimeFunction time_function;
};

struct JointDescription {
  std::string place = "joint";
  std::string name;
  JointKind kind = JointKind::ball;
  std::vector<std::string> bodies;     ///< two, or one that is joined to the ground
  Vector3 at = Vector3::Zero();        ///< as placed [m]
  Vector3 axis = Vector3::UnitZ();     ///< hinge, slider, cylindrical, universal; planar: the normal
  std::optional<Vector3> second_axis;  ///< universal: the axis that the second body, or the only one, carries
  std::optional<Vector3> to;           ///< distance: the point of the second body, or of the ground [m]
  // Angle of a hinge or way of a slider:
  double stiffness = 0;        ///< spring [N m/rad or N/m]
  double rest = 0;             ///< where it has no force [rad or m]
  double damping = 0;          ///< [N m s or N s/m]
  std::vector<double> limits;  ///< lowest and highest value [rad or m]; empty: none
  std::optional<MotorDescription> motor;
};

/// A point that a body carries.
struct AnchorDescription {
  std::string place = "points";
  std::string body;              ///< empty: the ground
  Vector3 at = Vector3::Zero();  ///< as placed [m]
};

/// A spring between two points, or a cable through several.
struct CableDescription {
  std::string place = "cable";
  std::string name;
  std::vector<AnchorDescription> points;
  double stiffness = 0;               ///< [N/m]
  std::vector<double> elongations;    ///< rising: a spring with a table [m]
  std::vector<double> forces;         ///< at these, in place of a stiffness [N]
  std::optional<double> rest_length;  ///< [m]; default its length at rest
  bool tension_only = false;
  std::optional<double> tension;  ///< in place of a stiffness, at a factor 1 [N]
  double shortening = 0;          ///< change of the rest length at a factor 1 [m]
  double friction = 0;            ///< Coulomb friction coefficient at guides
  TimeFunction time_function;
};

/// Forms of a linear constraint.
enum class ConstraintKind { equal, equation, periodic };
constexpr std::array<std::string_view, 3> spellings(ConstraintKind) {
  return {"equal", "equation", "periodic"};
}

/// The mean displacement of some vertices along an axis, times a coefficient.
struct ConstraintTerm {
  std::string place = "constraint.terms";
  std::string body;
  Where where;
  int axis = 0;
  double coefficient = 1;
};

/// A linear constraint between displacements, which is eliminated.
struct ConstraintDescription {
  std::string place = "constraint";
  std::string name;  ///< name of the force in the report
  ConstraintKind kind = ConstraintKind::equation;
  std::string body;
  Where where;                                          ///< equal
  std::array<bool, 3> components = {true, true, true};  ///< equal; the axes of pairs of faces where periodic
  std::vector<ConstraintTerm> terms;                    ///< equation: their sum is `value`
  double value = 0;                                     ///< at load factor 1 [m]
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();   ///< periodic: mean displacement gradient
  TimeFunction time_function;  ///< on value and gradient, in place of the load factor
};

/// A point whose displacement is reported.
struct ProbeDescription {
  std::string place = "probe";
  std::string name;
  std::string body;
  Vector3 at = Vector3::Zero();  ///< reference position; the nearest vertex is used [m]
};

/// A plane cut through a body whose section force is reported.
struct SectionDescription {
  std::string place = "section";
  std::string name;
  std::string body;
  int axis = 0;   ///< 0, 1, 2 for x, y, z
  double at = 0;  ///< coordinate in the reference configuration [m]
};

/// Tolerances and limits of the nonlinear solver.
struct NewtonOptions {
  double tolerance = 1e-8;   ///< force residual relative to the load (docs/theory/stopping.md)
  int max_iterations = 100;  ///< per load or time step; a smaller number truncates a step, safely
  int max_failures = 5;      ///< dynamics: ends after so many failed steps in a row; 0: never
  ProjectionChoice projection = ProjectionChoice::automatic;
  InversionBound inversion_bound = InversionBound::points;
};

/// Choice and limits of the linear solver.
struct SolverOptions {
  std::string kind = "auto";  ///< a name of linear/catalog.cpp
  int max_iterations = 2000;  ///< maximum iterations of an iterative solver, per solve
};

/// Frames, fields and formats of the results.
struct OutputOptions {
  int every = 1;  ///< frames are written for each n-th step
  std::vector<std::string> fields = {"displacement"};
  std::vector<OutputFormat> formats = {OutputFormat::vtu, OutputFormat::html};

  bool writes(OutputFormat format) const { return std::ranges::find(formats, format) != formats.end(); }
};

/// Adaptive time steps by an error estimate.
struct AdaptiveSteps {
  double tolerance = 1e-4;         ///< position error per step over the scene's largest extent
  std::optional<double> min_step;  ///< [s]; default 1e-6 of the first step
  std::optional<double> max_step;  ///< [s]; default the end time
};

/// Modal analysis.
struct ModesOptions {
  int count = 10;          ///< number of modes, from the lowest frequency on
  bool is_loaded = false;  ///< about the equilibrium under the loads, not the reference
};

/// One of the steps in sequence that a run goes through.
struct StepDescription {
  std::string place = "step";
  std::string name;
  double end = 0;  ///< [s]
};

/// A whole simulation.
struct Description {
  std::string place = "scene";
  std::string title;
  bool is_dynamic = false;
  int dimension = 3;                  ///< 3, or 2: plane strain, plane stress, axisymmetric
  double thickness = 1;               ///< thickness of plane scenes [m]
  Vector3 gravity = Vector3::Zero();  ///< [m/s^2]
  TimeFunction gravity_function;      ///< on gravity, in place of the load factor
  double time_step = 0.01;            ///< dynamics [s]
  double end_time = 1;                ///< end of the run; static: the time at load factor 1 [s]
  std::string integrator = "backward_euler";
  std::optional<AdaptiveSteps> adaptive;                    ///< dynamics; `time_step` is then the first step
  std::optional<ModesOptions> modes;                        ///< modal analysis; not in dynamics
  int load_steps = 1;                                       ///< static: load increments; cutbacks halve them
  LoadControlKind load_control = LoadControlKind::load;     ///< static
  int max_steps = 500;                                      ///< arc_length: the path ends after so many steps
  UnstableModes unstable_modes = UnstableModes::automatic;  ///< static
  OnJump on_jump = OnJump::follow;                          ///< static
  std::vector<StepDescription> steps;                       ///< in order; empty: one without a name
  std::vector<BodyDescription> bodies;
  std::vector<FixDescription> fixes;
  std::vector<TieDescription> ties;
  std::vector<ConstraintDescription> constraints;
  std::vector<JointDescription> joints;
  std::vector<CableDescription> springs, cables;
  std::vector<LoadDescription> loads;
  std::vector<ColliderDescription> colliders;
  ContactDescription contact;
  std::vector<ProbeDescription> probes;
  std::vector<SectionDescription> sections;
  NewtonOptions newton;
  SolverOptions solver;
  OutputOptions output;
};

}  // namespace resilin
