#include "resilin/world/world.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/energy/dead_load.hpp"
#include "resilin/energy/history_term.hpp"
#include "resilin/energy/inertia.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/body_material.hpp"
#include "resilin/world/body_mesh.hpp"
#include "resilin/world/body_overlap.hpp"
#include "resilin/world/cell_material.hpp"
#include "resilin/world/colliders.hpp"
#include "resilin/world/constraints.hpp"
#include "resilin/world/contact.hpp"
#include "resilin/world/damping.hpp"
#include "resilin/world/description_check.hpp"
#include "resilin/world/event_times.hpp"
#include "resilin/world/friction.hpp"
#include "resilin/world/joint_maker.hpp"
#include "resilin/world/loads.hpp"
#include "resilin/world/meeting_surface.hpp"
#include "resilin/world/plausibility.hpp"
#include "resilin/world/resultants.hpp"
#include "resilin/world/rigid_shape.hpp"
#include "resilin/world/scene_origin.hpp"
#include "resilin/world/selection.hpp"
#include "resilin/world/start_check.hpp"
#include "resilin/world/start_distance.hpp"
#include "resilin/world/support_phase.hpp"
#include "resilin/world/viscoelastic_material.hpp"

namespace resilin {
namespace {

/// The mesh of a body in the world: scaled, rotated, translated.
VectorX placed_vertices(const BodyDescription& description, const Mesh& mesh, int dim) {
  const Placement placement(description);
  VectorX positions(static_cast<Eigen::Index>(mesh.vertices.size()) * dim);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    positions.segment(static_cast<Eigen::Index>(v) * dim, dim) = placement(mesh.vertices[v]).head(dim);
  }
  return positions;
}

void append(VectorX& all, const VectorX& more) {
  const Eigen::Index size = all.size();
  all.conservativeResize(size + more.size());
  all.tail(more.size()) = more;
}

/// Values given for the mesh's vertices; further nodes have the mean of their edge's ends.
VectorX values_of_nodes(const std::vector<double>& given, const BodyMesh& body_mesh, int dim,
                        const std::string& place) {
  const auto num_nodes = static_cast<Eigen::Index>(body_mesh.mesh.vertices.size());
  const Eigen::Index num_vertices = num_nodes - static_cast<Eigen::Index>(body_mesh.ends.size());
  if (static_cast<Eigen::Index>(given.size()) != num_vertices * dim) {
    throw InputError(
        place, std::to_string(dim) + " numbers for each of " + std::to_string(num_vertices) + " vertices",
        std::to_string(given.size()) + " numbers");
  }
  VectorX values(num_nodes * dim);
  values.head(num_vertices * dim) = Eigen::Map<const VectorX>(given.data(), num_vertices * dim);
  if (!values.head(num_vertices * dim).allFinite()) throw InputError(place, "finite numbers", "inf or nan");
  for (std::size_t i = 0; i < body_mesh.ends.size(); ++i) {
    const auto [a, b] = body_mesh.ends[i];
    values.segment((num_vertices + static_cast<Eigen::Index>(i)) * dim, dim) =
        0.5 * (values.segment(Eigen::Index{a} * dim, dim) + values.segment(Eigen::Index{b} * dim, dim));
  }
  return values;
}

VectorX start_velocities_of(const BodyDescription& description, const VectorX& positions, int dim) {
  VectorX velocities(positions.size());
  for (Eigen::Index i = 0; i < positions.size() / dim; ++i) {
    const Vector3 X = node_position(dim, static_cast<Index>(i), positions);
    velocities.segment(i * dim, dim) = (description.velocity + description.velocity_gradient * X).head(dim);
  }
  return velocities;
}

/// Throws InputError when a world, complete but for this, has fewer unknowns than modes are asked for; warns
/// of loads that do not act. Every mode becomes a frame.
void check_modes(const Description& description, const ModesOptions& modes, World& world) {
  world.output.every = 1;  // each mode is a frame
  if (modes.count < 1 || modes.count > world.num_free_unknowns()) {
    throw InputError(
        world.place + ": simulation.modes.count",
        "from 1 to " + std::to_string(world.num_free_unknowns()) + ", the free DOFs of the scene",
        std::to_string(modes.count));
  }
  const bool has_loads = description.gravity.norm() > 0 || !description.loads.empty();
  if (has_loads && !modes.is_loaded) {
    world.warnings.push_back(world.place +
                             ": loads do not affect modes about the reference configuration; for modes about "
                             "the loaded state set simulation.modes.about = \"load\"");
  }
}

/// Makes a world out of its description, part by part.
class Builder {
 public:
  /// @param part  of a scene that several processes share; null: the whole
  /// @param shapes  of the rigid bodies, null for others; empty: there is none
  Builder(const Description& description, World& world, const ScenePart* part = nullptr,
          std::vector<std::shared_ptr<const RigidShape>> shapes = {})
      : description_(description), world_(world), part_(part), shapes_(std::move(shapes)) {
    shapes_.resize(description.bodies.size());
  }
  void build();

 private:
  void add_body(const BodyDescription& body);
  void add_support(std::size_t number);
  void hold_rigid_regions(const Body& body, const FixDescription& fix, std::vector<Index>& nodes);
  void add_load(std::size_t number);
  void add_probe(std::size_t number);
  void add_section(const SectionDescription& section);
  void note_origin(const TermOrigin& origin);
  void add_joints();
  void add_coupled(std::shared_ptr<Energy> term, const TermOrigin& origin);
  void add_constraints();
  void build_pattern();
  void add_masses();
  void find_fixed_unknowns();
  void add_contact();
  void add_contact_terms(const ContactWishes& wishes);
  void find_oddities();

  const Description& description_;  ///< in the world's coordinates
  World& world_;
  const ScenePart* part_;
  std::vector<std::shared_ptr<const RigidShape>> shapes_;
  std::vector<BodyMesh> meshes_;
  std::vector<std::vector<DomainMaterial>> materials_;  ///< materials of each body
  std::vector<std::shared_ptr<Energy>> coupling_;       ///< terms whose couplings make up the pattern
  std::vector<TermOrigin> coupled_origins_;             ///< origins of those of joints, springs and cables
};

void Builder::build() {
  check_description(description_);
  check_history(description_);
  check_axisymmetry(description_);
  if (part_ != nullptr && is_axisymmetric(description_))
    throw InputError(world_.place + ": simulation.dimension", "2 or 3 for several MPI processes",
                     "\"axisymmetric\"", "run it on one process");
  if (description_.bodies.empty()) throw InputError(world_.place, "at least one [[body]]", "none");
  for (const BodyDescription& body : description_.bodies) add_body(body);
  if (world_.other_contact_shape == world_.rest_positions) world_.other_contact_shape.resize(0);
  if (!world_.is_dynamic) world_.start_velocities.resize(0);
  // Once all bodies are placed, so that every energy sees the whole world's vertices.
  for (std::size_t b = 0; b < world_.bodies.size(); ++b)
    for (auto& energy : give_material(world_, description_.bodies[b], materials_[b], world_.bodies[b]))
      coupling_.push_back(std::move(energy));
  if (part_ == nullptr) check_start(description_, world_);
  for (std::size_t i = 0; i < description_.fixes.size(); ++i) add_support(i);
  check_support_conflicts(world_.dimension, world_.supports, world_.rest_positions);
  world_.switch_times = switch_times(world_.supports, description_.contact);
  for (std::size_t i = 0; i < description_.loads.size(); ++i) add_load(i);
  for (std::size_t i = 0; i < description_.probes.size(); ++i) add_probe(i);
  for (const SectionDescription& section : description_.sections) add_section(section);
  if (part_ == nullptr) add_joints();
  add_constraints();
  build_pattern();
  add_masses();
  using Kind = TermOrigin::Kind;
  world_.terms.assign(coupling_.begin(), coupling_.end());
  for (std::size_t b = 0; b < world_.bodies.size(); ++b)
    for (std::size_t d = 0; d < world_.bodies[b].domains.size(); ++d)
      world_.origins.push_back({Kind::domain, b, d});
  for (std::size_t i = 0; i < description_.loads.size(); ++i) world_.origins.push_back({Kind::load, i});
  world_.origins.insert(world_.origins.end(), coupled_origins_.begin(), coupled_origins_.end());
  if (description_.gravity.head(world_.dimension).norm() > 0)
    world_.terms.push_back(
        make_gravity(description_.gravity, description_.gravity_function, world_, world_.is_dynamic));
  note_origin({Kind::gravity});
  if (!world_.is_dynamic && !world_.switch_times.empty()) {
    world_.terms.push_back(std::make_shared<DeadLoad>("release", VectorX::Zero(world_.rest_positions.size()),
                                                      world_.rest_positions));
    note_origin({Kind::release});
  }
  for (std::size_t b = 0; b < world_.bodies.size(); ++b)
    check_contact_skin(world_.bodies[b], world_, description_.bodies[b].place);
  find_fixed_unknowns();
  add_contact();
  if (world_.is_dynamic) {
    world_.terms.push_back(std::make_shared<Inertia>(world_.mass));
    note_origin({Kind::inertia});
    add_damping(description_, world_);
  }
  find_events(description_, world_);
  if (part_ != nullptr) return;  // the whole has been checked
  if (world_.modes) check_modes(description_, *world_.modes, world_);
  const bool finds_equilibrium = !world_.is_dynamic && (!world_.modes || world_.modes->is_loaded);
  check_releases(description_, world_);
  if (finds_equilibrium && world_.switch_times.empty()) check_is_held(world_);
  if (world_.switch_times.empty())
    for (std::string& line : locked_motors(description_, world_)) world_.warnings.push_back(std::move(line));
  find_oddities();
}

/// Finds problems that do not keep a complete world from running.
void Builder::find_oddities() {
  for (const BodyOverlap& overlap : overlapping_bodies(world_, world_.start_positions, world_.contact.get()))
    world_.warnings.push_back(world_.place + ": " + describe(world_, overlap) +
                              ": contact between them is disabled ([contact]), and they pass through each "
                              "other; move one of them (translate), or enable contact");
  for (std::string& line : supports_in_colliders(world_)) world_.warnings.push_back(std::move(line));
  for (std::string& line : starts_pushed_off(world_)) world_.warnings.push_back(std::move(line));
  for (const std::string& line : starts_without_volume(world_))
    world_.warnings.push_back(world_.place + ": " + line);
  for (std::string& line : opposite_side_warnings(world_)) world_.warnings.push_back(std::move(line));
  world_.run_warnings = implausible_numbers(description_);
  if (world_.modes || !is_idle(world_)) return;
  const std::string nothing = "no gravity, load, velocity or prescribed motion acts on a free vertex";
  world_.run_warnings.push_back(world_.place + ": " +
                                (world_.is_dynamic ? "nothing moves the bodies: " + nothing + " up to the end"
                                                   : "nothing loads the bodies: " + nothing) +
                                "; every frame will be the start");
}

void Builder::add_body(const BodyDescription& description) {
  for (const Body& other : world_.bodies) {
    if (other.name == description.name) {
      throw InputError(description.place + ".name", "a name of its own for each body",
                       "\"" + other.name + "\" twice");
    }
  }
  const CellBlock& cells = solid_cells(description, world_.dimension);
  materials_.push_back(
      domain_materials(description, world_.dimension, part_ != nullptr,
                       part_ != nullptr && part_->bodies[world_.bodies.size()].has_own_cells));
  const ElementCase element_case{.cells = cells.kind,
                                 .law = limiting_law(materials_.back()),
                                 .poissons_ratio = largest_poissons_ratio(materials_.back())};
  const BodyMesh& made =
      meshes_.emplace_back(make_body_mesh(description, world_.dimension, element_case, world_.warnings));
  Body body;
  body.name = description.name;
  body.element = made.element->name;
  body.element_reason = made.reason;
  if (!made.reason.empty())
    world_.notes.push_back(description.place + ": element " + body.element + ": " + made.reason);
  body.mass_kind = description.mass;
  body.rigid = shapes_[world_.bodies.size()];
  body.contact_surface = description.contact_surface;
  body.first_node = world_.num_nodes();
  body.num_nodes = static_cast<Index>(made.mesh.vertices.size());
  body.num_vertices = static_cast<Index>(description.mesh.vertices.size());
  body.ends_of_added = made.ends;
  body.cell_kind = cell_kind(*made.element);
  body.cells = cells_in_world(made, body.first_node, world_.made_from, world_.bodies.size());

  const VectorX rest = placed_vertices(description, made.mesh, world_.dimension);
  append(world_.rest_positions, rest);
  if (is_axisymmetric(description_)) check_radii(description, world_.rest_positions, body.first_node);
  const auto of_nodes = [&](const auto& given, const char* key, const VectorX& otherwise) {
    return given.empty() ? otherwise
                         : values_of_nodes(given, made, world_.dimension, description.place + key);
  };
  append(world_.other_contact_shape, of_nodes(description.contact_shape, ".contact_shape", rest));
  body.skin = make_skin(description, body, world_.other_contact_shape, world_.dimension, world_.warnings);
  append(world_.start_positions, of_nodes(description.initial_positions, ".initial_positions", rest));
  append(world_.start_velocities, of_nodes(description.initial_velocities, ".initial_velocities",
                                           start_velocities_of(description, rest, world_.dimension)));
  world_.bodies.push_back(std::move(body));
}

void Builder::add_support(std::size_t number) {
  const FixDescription& fix = description_.fixes[number];
  const std::size_t b = find_body(world_, fix.body, fix.place + ".body");
  const Body& body = world_.bodies[b];
  const std::string where = fix.place + ".where";
  std::vector<Index> nodes;
  if (part_ != nullptr) {
    nodes = part_->fixes[number].nodes;
  } else if (body.rigid) {
    const RigidShape& shape = *body.rigid;
    if (!fix.gradient.isZero(0))
      throw InputError(fix.place + ".gradient", "none on a rigid body", "one", "turn it with rotate");
    nodes = shape.nodes_held_by(
        select_vertices(fix.where, shape.mesh, shape.body, shape.rest_positions, world_.dimension, where));
  } else {
    nodes = select_vertices(fix.where, meshes_[b].mesh, body, world_.rest_positions, world_.dimension, where);
  }
  Support support{.place = fix.place,
                  .name = fix.name,
                  .nodes = std::move(nodes),
                  .components = fix.components,
                  .displacement = fix.displacement,
                  .gradient = fix.gradient,
                  .rotate = fix.rotate,
                  .velocity = fix.velocity,
                  .until = fix.until,
                  .time_function = fix.time_function,
                  .switches = fix.switches,
                  .reports_stiffness = fix.reports_stiffness};
  if (world_.dimension == 2) support.components[2] = false;
  if (world_.is_dynamic && fix.rotate && turns_at_once(fix)) ease_turn(*fix.rotate, world_, support);
  for (Index& node : support.nodes) node += body.first_node;
  hold_rigid_regions(body, fix, support.nodes);
  world_.supports.push_back(std::move(support));
}

/// In place of nodes that follow a rigid region it holds the control nodes of this region.
void Builder::hold_rigid_regions(const Body& body, const FixDescription& fix, std::vector<Index>& nodes) {
  if (!body.domains.have_rigid_ones()) return;
  for (const Body& rigid : world_.bodies) {
    if (!rigid.rigid || rigid.rigid->region_of != body.name) continue;
    const std::vector<Index> followers = followers_of(world_, rigid);
    std::vector<Vector3> points;
    std::erase_if(nodes, [&](Index node) {
      const bool follows = std::ranges::binary_search(followers, node);
      if (follows) points.push_back(node_position(world_.dimension, node, world_.rest_positions));
      return follows;
    });
    if (points.empty()) continue;
    if (!fix.gradient.isZero(0))
      throw InputError(fix.place + ".gradient", "none on the rigid region \"" + rigid.name + '"', "one",
                       "turn it with rotate, or hold vertices outside of it");
    if (!rigid.rigid->is_held_by(points))
      throw InputError(fix.place + ".where",
                       "vertices that hold the rigid region \"" + rigid.name + "\" as a whole, or none of it",
                       points.size() == 1 ? "a point of it" : "points in a line",
                       "hold it by a [[joint]] of bodies = [\"" + rigid.name + "\"]");
    for (Index node = rigid.first_node; node < rigid.first_node + rigid.num_nodes; ++node)
      nodes.push_back(node);
  }
  std::ranges::sort(nodes);
}

void Builder::add_load(std::size_t number) {
  const LoadDescription& load = description_.loads[number];
  const std::size_t b = find_body(world_, load.body, load.place + ".body");
  coupling_.push_back(make_load(load, world_, world_.bodies[b], meshes_[b].mesh,
                                part_ == nullptr ? nullptr : &part_->loads[number]));
}

void Builder::add_probe(std::size_t number) {
  const ProbeDescription& probe = description_.probes[number];
  if (part_ != nullptr) {
    world_.probes.push_back({.name = probe.name, .node = part_->probes[number]});
    return;
  }
  const Body& body = world_.bodies[find_body(world_, probe.body, probe.place + ".body")];
  world_.probes.push_back(find_probe(probe, body, world_));
}

void Builder::add_section(const SectionDescription& section) {
  const Body& body = world_.bodies[find_body(world_, section.body, section.place + ".body")];
  if (body.rigid)
    throw InputError(section.place + ".body", "a deformable body", "the rigid body \"" + body.name + '"');
  if (body.domains.have_rigid_ones())
    throw InputError(section.place + ".body", "a body without rigid regions", '"' + body.name + '"',
                     "the reactions of supports and frames[].joints have forces");
  world_.sections.emplace_back(section, body, world_.dimension, world_.rest_positions);
}

/// Whatever the last lines have added to the terms is made of this.
void Builder::note_origin(const TermOrigin& origin) { world_.origins.resize(world_.terms.size(), origin); }

/// Joints, springs and cables.
void Builder::add_joints() {
  for (std::size_t i = 0; i < description_.joints.size(); ++i) {
    const JointDescription& joint = description_.joints[i];
    std::vector<std::shared_ptr<Energy>> terms;
    world_.joints.push_back(make_joint(joint, world_, terms));
    for (std::size_t k = 0; k < terms.size(); ++k)
      add_coupled(std::move(terms[k]), {TermOrigin::Kind::joint, i, k});
  }
  const auto add = [&](const std::vector<CableDescription>& list, TermOrigin::Kind kind) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      std::shared_ptr<Cable> cable = make_cable(list[i], world_);
      std::shared_ptr<CableFriction> friction =
          make_cable_friction(list[i], cable, description_.contact, world_);
      world_.cables.push_back(cable);
      world_.cable_frictions.push_back(friction);
      add_coupled(std::move(cable), {kind, i});
      if (friction) add_coupled(std::move(friction), {kind, i, 1});
    }
  };
  add(description_.springs, TermOrigin::Kind::spring);
  add(description_.cables, TermOrigin::Kind::cable);
}

void Builder::add_coupled(std::shared_ptr<Energy> term, const TermOrigin& origin) {
  coupling_.push_back(std::move(term));
  coupled_origins_.push_back(origin);
}

void Builder::add_constraints() {
  if (part_ != nullptr) return;  // a part has none
  if (world_.modes) refuse_constraints(description_, "modal analysis");
  if (world_.follows_path) refuse_constraints(description_, "arc length");
  world_.constraints = make_constraints(description_, world_, meshes_);
}

/// One pattern for all energies; each looks up its slots in it.
void Builder::build_pattern() {
  BlockPatternBuilder builder(world_.num_nodes());
  for (const auto& energy : coupling_) energy->add_pattern(builder);
  BlockPattern pattern = builder.build();
  if (const Dependents* dependents = world_.dependents())
    pattern = dependents->extended(pattern, std::move(builder));
  world_.pattern = std::make_shared<const BlockPattern>(std::move(pattern));
  for (const auto& energy : coupling_) energy->bind(*world_.pattern);
}

void Builder::add_masses() {
  MassMatrix mass;
  mass.dim = world_.dimension;
  mass.nodal = VectorX::Zero(world_.num_nodes());
  const bool is_multiplied = world_.is_dynamic || world_.modes;
  const auto is_consistent = [is_multiplied](const Body& body) {
    return is_multiplied && has_consistent_mass(body);
  };
  if (std::ranges::any_of(world_.bodies, is_consistent)) {
    mass.pattern = world_.pattern;
    mass.slots.assign(static_cast<std::size_t>(world_.pattern->num_slots()), 0.0);
  }
  for (const Body& body : world_.bodies) add_body_masses(mass, body, world_.rest_positions, world_.thickness);
  world_.mass = std::make_shared<const MassMatrix>(std::move(mass));
}

/// Colliders, contact between bodies and friction.
void Builder::add_contact() {
  ContactWishes wishes{description_.colliders, contact_beside_ties(description_)};
  const std::size_t num_terms = world_.terms.size(), num_warnings = world_.warnings.size();
  add_contact_terms(wishes);
  if (part_ != nullptr || world_.modes || !shorten_activation_distances(wishes, world_)) return;
  world_.terms.resize(num_terms);
  world_.origins.resize(num_terms);
  world_.warnings.resize(num_warnings);
  world_.colliders.clear();
  world_.mesh_colliders.clear();
  add_contact_terms(wishes);
}

void Builder::add_contact_terms(const ContactWishes& wishes) {
  using Kind = TermOrigin::Kind;
  for (std::size_t i = 0; i < wishes.colliders.size(); ++i) {
    add_collider(wishes.colliders[i], world_, part_ == nullptr ? nullptr : &part_->colliders[i]);
    note_origin({Kind::collider, i});
  }
  world_.contact = make_contact(wishes.contact, world_);
  if (world_.contact) world_.terms.push_back(world_.contact);
  note_origin({Kind::contact});
  for (const ColliderDescription& collider : wishes.colliders)
    world_.friction_factors[collider.name] = collider.friction_factor;
  world_.friction_factors[""] = wishes.contact.friction_factor;
  world_.friction = make_friction(wishes.contact, world_);
  if (world_.friction) world_.terms.push_back(world_.friction);
  note_origin({Kind::friction});
}

void Builder::find_fixed_unknowns() {
  const int dim = world_.dimension;
  world_.support_of = supports_of_unknowns(dim, world_.num_nodes(), world_.supports);
  world_.is_fixed.assign(world_.support_of.size(), 0);
  // A vertex that no cell uses has no stiffness: it stays where it is.
  std::vector<bool> is_used(static_cast<std::size_t>(world_.num_nodes()), false);
  for (const Body& body : world_.bodies)
    for (const Index node : body.cells) is_used[static_cast<std::size_t>(node)] = true;
  for (std::size_t i = 0; i < world_.is_fixed.size(); ++i)
    if (!is_used[i / static_cast<std::size_t>(dim)]) world_.is_fixed[i] = 1;
  if (const Dependents* dependents = world_.dependents())
    for (const Dependents::Relation& relation : dependents->relations())
      world_.is_fixed[static_cast<std::size_t>(relation.unknown)] = 1;
  fix_axis(world_);
  if (!world_.switch_times.empty()) world_.is_fixed_otherwise = world_.is_fixed;
  for (std::size_t i = 0; i < world_.is_fixed.size(); ++i)
    if (world_.support_of[i] >= 0) world_.is_fixed[i] = 1;
}

}  // namespace

World::World(const Description& description, std::shared_ptr<const Description> shared, const ScenePart* part,
             ProcessGroup share_of_part)
    : dimension(description.dimension),
      thickness(description.thickness),
      is_dynamic(description.is_dynamic),
      title(description.title),
      place(description.place),
      made_from(std::move(shared)),
      gravity(description.gravity),
      gravity_function(description.gravity_function),
      time_step(description.time_step),
      end_time(description.end_time),
      path_time(!description.is_dynamic && follows_time(description) ? description.end_time : 0),
      load_steps(description.load_steps),
      follows_path(!description.is_dynamic && !description.modes &&
                   description.load_control == LoadControlKind::arc_length),
      max_steps(description.max_steps),
      unstable_modes(description.unstable_modes),
      on_jump(description.on_jump),
      integrator(description.integrator),
      adaptive(description.adaptive),
      modes(description.modes),
      steps(description.steps),
      newton(description.newton),
      solver(description.solver),
      output(description.output),
      share(std::move(share_of_part)) {
  if (part != nullptr) {
    for (const BodyPart& body : part->bodies) cell_numbers.push_back(body.cells);
    Builder(description, *this, part).build();
    for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b].mass = part->bodies[b].mass;
    origin = part->origin;
    fingerprint = part->fingerprint;
    warnings.clear();  // those of the whole scene are told once
    notes.clear();
    return;
  }
  origin = find_scene_origin(description);
  const auto build = [this](const Description& of) {
    if (!has_rigid_bodies(of)) return Builder(of, *this).build();
    RigidBodies rigid = with_control_nodes(of, warnings);
    Builder(rigid.description, *this, nullptr, std::move(rigid.shapes)).build();
  };
  if (origin.isZero(0)) {
    build(description);
  } else {
    build(with_origin(description, origin));
  }
  fingerprint = fingerprint_of(description);
  // The element's own rule by its name is the same scene as none.
  for (const Body& body : bodies)
    for (auto& [name, value] : fingerprint)
      if (name == "body." + body.name + ".quadrature" &&
          value == '"' + std::string(body.domains.element().default_quadrature) + '"')
        value = "\"\"";
}

World::World(const ScenePart& part, ProcessGroup share_of_part)
    : World(part.description, nullptr, &part, std::move(share_of_part)) {}

double largest_turn(const World& world, const Conditions& from, const Conditions& to) {
  double turn = largest_turn(world.supports, from, to);
  for (const auto& collider : world.colliders)
    turn = std::max(turn, collider->motion().degrees_between(from.time, to.time));
  for (const auto& collider : world.mesh_colliders)
    turn = std::max(turn, collider->obstacle().motion.degrees_between(from.time, to.time));
  return turn;
}

std::vector<std::string> all_warnings(const World& world) {
  std::vector<std::string> warnings = world.warnings;
  warnings.insert(warnings.end(), world.run_warnings.begin(), world.run_warnings.end());
  return warnings;
}

std::vector<std::string> names_of_terms(const World& world, EnergyCategory category) {
  std::vector<std::string> names;
  for (const auto& term : world.terms)
    if (term->properties().category == category) names.emplace_back(term->name());
  return names;
}

std::size_t find_body(const World& world, const std::string& name, const std::string& place) {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    if (world.bodies[b].name == name || (name.empty() && world.bodies.size() == 1)) return b;
    names.push_back(world.bodies[b].name);
  }
  if (name.empty()) throw InputError(place, "one of " + join(names), "nothing");
  refuse_word(place, name, names);
}

std::optional<std::size_t> World::find_term(const TermOrigin& of) const {
  const auto found = std::ranges::find(origins, of);
  if (found == origins.end()) return std::nullopt;
  return static_cast<std::size_t>(found - origins.begin());
}

std::size_t World::term_of_load(std::size_t load) const {
  const std::optional<std::size_t> term = find_term({TermOrigin::Kind::load, load});
  if (!term) throw std::logic_error("World::term_of_load: no term of load " + std::to_string(load));
  return *term;
}

std::size_t World::term_of_domain(std::size_t body, std::size_t domain) const {
  const std::optional<std::size_t> term = find_term({TermOrigin::Kind::domain, body, domain});
  if (!term) throw std::logic_error("World::term_of_domain: no term of body " + std::to_string(body));
  return *term;
}

Eigen::Index World::num_history_values() const {
  Eigen::Index count = 0;
  for (const auto& term : terms)
    if (const HistoryTerm* of = term->history_term()) count += of->num_history_values();
  return count;
}

VectorX World::history_of_domain(std::size_t body, std::size_t domain, const VectorX& history) const {
  const std::size_t number = term_of_domain(body, domain);
  Eigen::Index first = 0;
  for (std::size_t i = 0; i < number; ++i)
    if (const HistoryTerm* of = terms[i]->history_term()) first += of->num_history_values();
  const HistoryTerm* of = terms[number]->history_term();
  if (of == nullptr) return {};
  return history.segment(first, of->num_history_values());
}

const Dependents* World::dependents() const { return constraints ? &constraints->dependents : nullptr; }

Index World::num_free_unknowns() const {
  return static_cast<Index>(std::count(is_fixed.begin(), is_fixed.end(), std::uint8_t{0}));
}

bool World::meet(std::size_t a, std::size_t b) const {
  return contact && contact->meetings().meet(static_cast<Index>(a), static_cast<Index>(b));
}

const Body& World::body_of(Index node) const {
  const auto after = std::find_if(bodies.begin(), bodies.end(), [node](const Body& body) {
    return node < body.first_node + body.num_nodes;
  });
  return *after;
}

}  // namespace resilin
