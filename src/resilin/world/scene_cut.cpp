#include "resilin/world/scene_cut.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

#include "resilin/core/error.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/world/body_mesh.hpp"
#include "resilin/world/cell_material.hpp"
#include "resilin/world/load_catalog.hpp"
#include "resilin/world/scene_origin.hpp"
#include "resilin/world/selection.hpp"

namespace resilin {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

[[noreturn]] void refuse(const std::string& place, const std::string& what,
                         const std::string& cure = "run it on one process") {
  throw InputError(place, "a scene for several MPI processes", what, cure);
}

/// The body's cells with its own vertex numbers.
CellBlock own_cells(const Body& body) {
  CellBlock block{.kind = body.cell_kind, .nodes = body.cells};
  for (Index& node : block.nodes) node -= body.first_node;
  return block;
}

/// Entries of the cells of a part; all where there is one for all cells.
template <class T>
std::vector<T> of_cells(const std::vector<T>& values, const std::vector<Index>& cells) {
  if (values.size() <= 1) return values;
  std::vector<T> picked;
  for (const Index cell : cells) picked.push_back(values[at(cell)]);
  return picked;
}

std::vector<double> of_nodes(const VectorX& values, std::span<const Index> nodes, int dim) {
  std::vector<double> picked;
  for (const Index node : nodes)
    for (int k = 0; k < dim; ++k) picked.push_back(values[Eigen::Index{node} * dim + k]);
  return picked;
}

}  // namespace

void require_distributable(const World& world) {
  const std::string scene = world.place;
  if (world.modes) refuse(scene + ": simulation.kind", "modal analysis");
  if (world.follows_path) refuse(scene + ": simulation.load_control", "\"arc_length\"");
  if (world.unstable_modes == UnstableModes::count)
    refuse(scene + ": simulation.unstable_modes", "a count of unstable modes");
  if (world.contact)
    refuse(scene + ": contact", "contact between bodies or self-contact",
           "run it on one process; without contact set [contact] enabled = false");
  if (!world.mesh_colliders.empty()) refuse(scene + ": collider", "a collider of facets");
  for (const auto& collider : world.colliders)
    if (collider->facets() != nullptr)
      refuse(scene + ": collider \"" + std::string(collider->name()) + '"',
             "a sphere that is small beside the facets of a body",
             "refine the mesh or run it on one process");
  if (!world.joints.empty()) refuse(scene + ": joint", "joints");
  if (!world.cables.empty()) refuse(scene + ": spring or cable", "springs and cables");
  if (world.constraints) refuse(scene + ": tie or constraint", "ties and linear constraints");
  if (world.friction) refuse(scene + ": friction", "friction");
  if (!world.sections.empty()) refuse(scene + ": section", "a section force");
  for (const Body& body : world.bodies)
    if (body.domains.have_history())
      refuse(scene + ": body \"" + body.name + "\"", "a viscoelastic or softening material");
  for (const Body& body : world.bodies)
    if (body.rigid) refuse(scene + ": body \"" + body.name + "\"", "a rigid body");
  for (const Body& body : world.bodies)
    if (body.skin) refuse(scene + ": body \"" + body.name + "\"", "a skin");
  for (const std::string& field : world.output.fields)
    if (field.starts_with("contact_") || field.starts_with("nodal_"))
      refuse(scene + ": output.fields", '"' + field + "\", which is made of the whole body");
}

SceneCut::SceneCut(const World& world, std::span<const std::vector<std::int32_t>> cell_ranks, int num_ranks)
    : world_(world), cell_ranks_(cell_ranks), num_ranks_(num_ranks) {
  require_distributable(world);
  rest_ = world.origin.isZero(0) ? *world.made_from : with_origin(*world.made_from, world.origin);
  find_owners();
  find_load_sites();
  for (BodyDescription& body : rest_.bodies) {
    body.mesh = {};
    body.initial_positions.clear();
    body.initial_velocities.clear();
    body.contact_shape.clear();
    body.scale = 1;
    body.rotate.reset();
    body.translate.setZero();
  }
  for (std::size_t k = 0; k < rest_.colliders.size(); ++k)
    rest_.colliders[k].activation_distance = world.colliders[k]->activation_distance();
  rest_.contact.is_enabled = false;
  rest_.contact.pairs.clear();
}

void SceneCut::find_owners() {
  std::vector<std::uint64_t> pairs;  // node, rank
  for (std::size_t b = 0; b < world_.bodies.size(); ++b) {
    const Body& body = world_.bodies[b];
    const auto width = at(num_nodes(body.cell_kind));
    for (std::size_t i = 0; i < body.cells.size(); ++i)
      pairs.push_back(static_cast<std::uint64_t>(body.cells[i]) << 32 |
                      static_cast<std::uint32_t>(cell_ranks_[b][i / width]));
  }
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  const Index num_nodes = world_.num_nodes();
  std::size_t next = 0;
  for (Index node = 0; node < num_nodes; ++node) {
    copies_begin_.push_back(static_cast<Offset>(copies_.size()));
    const std::size_t first = copies_.size();
    for (; next < pairs.size() && pairs[next] >> 32 == static_cast<std::uint64_t>(node); ++next)
      copies_.push_back(static_cast<std::int32_t>(pairs[next] & 0xffffffffU));
    if (copies_.size() == first) copies_.push_back(0);  // a vertex that no cell uses
    // In turn, so that all have about as many.
    owners_.push_back(copies_[first + at(node) % (copies_.size() - first)]);
  }
  copies_begin_.push_back(static_cast<Offset>(copies_.size()));
  std::vector<Offset> numbers(at(num_ranks_) + 1, 0);
  for (const std::int32_t owner : owners_) ++numbers[at(owner) + 1];
  for (std::size_t rank = 0; rank < at(num_ranks_); ++rank) numbers[rank + 1] += numbers[rank];
  for (const std::int32_t owner : owners_) ranked_numbers_.push_back(numbers[at(owner)]++);
}

void SceneCut::find_load_sites() {
  const int dim = world_.dimension;
  for (const LoadDescription& load : rest_.loads) {
    const auto is_its_body = [&](const Body& body) { return load.body.empty() || body.name == load.body; };
    const auto found = std::ranges::find_if(world_.bodies, is_its_body);
    const auto b = static_cast<std::size_t>(found - world_.bodies.begin());
    const Body& body = *found;
    BodyDescription description = rest_.bodies[b];
    description.element = body.element;
    const LawInfo& law = body.domains.front().law_info();
    std::vector<std::string> told_before;
    const BodyMesh made = make_body_mesh(
        description, dim, {.cells = solid_cells(description, dim).kind, .law = law, .poissons_ratio = 0},
        told_before);
    const std::vector<Index> selected =
        select_vertices(load.where, made.mesh, body, world_.rest_positions, dim, load.place + ".where");
    const LoadKind& kind = require_load_kind(load.kind, load.place);
    LoadSites& sites = loads_.emplace_back();
    sites.is_on_each_node = kind.is_on_each_node;
    for (const Index node : selected) sites.nodes.push_back(body.first_node + node);
    const std::vector<bool> is_meant =
        meant_facets(load.where, selected, body, world_.rest_positions, dim, load.place + ".where");
    const Boundary surface = boundary(own_cells(body));
    sites.nodes_per_facet = at(num_nodes(surface.facets.kind));
    for (Index facet = 0; facet < surface.facets.num_cells(); ++facet) {
      const std::span<const Index> nodes = surface.facets.cell(facet);
      if (!is_meant[at(facet)]) continue;
      for (const Index node : nodes) sites.facets.push_back(body.first_node + node);
      sites.facet_ranks.push_back(cell_ranks_[b][at(surface.owners[at(facet)].cell)]);
    }
  }
}

bool SceneCut::has_copy(Index node, int rank) const {
  const auto first = copies_.begin() + copies_begin_[at(node)],
             last = copies_.begin() + copies_begin_[at(node) + 1];
  return std::find(first, last, rank) != last;
}

/// @param nodes     of the body that the part has, in the world's numbering
/// @param local_of  by node of the world: its number in the body's part
BodyDescription SceneCut::body_part(std::size_t body, int rank, std::span<const Index> nodes,
                                    std::span<const Index> local_of, std::vector<Index>& cells) const {
  const Body& whole = world_.bodies[body];
  const auto width = at(num_nodes(whole.cell_kind));
  BodyDescription part = rest_.bodies[body];
  part.element = whole.element;
  CellBlock& block = part.mesh.block(whole.cell_kind);
  for (Index cell = 0; cell < whole.num_cells(); ++cell) {
    if (cell_ranks_[body][at(cell)] != rank) continue;
    cells.push_back(cell);
    for (std::size_t a = 0; a < width; ++a)
      block.nodes.push_back(local_of[at(whole.cells[at(cell) * width + a])]);
  }
  for (const Index node : nodes)
    part.mesh.vertices.push_back(node_position(world_.dimension, node, world_.rest_positions));
  part.initial_positions = of_nodes(world_.start_positions, nodes, world_.dimension);
  if (world_.is_dynamic) part.initial_velocities = of_nodes(world_.start_velocities, nodes, world_.dimension);
  const Eigen::Matrix3d turn = rotation_matrix(world_.made_from->bodies[body].rotate);
  const auto cut = [&](MaterialDescription& material) {
    for (auto& [name, values] : material.cell_constants) values = of_cells(values, cells);
    for (std::vector<Vector3>& directions : material.fibres) {
      directions = of_cells(directions, cells);
      for (Vector3& direction : directions) direction = turn * direction;
    }
  };
  cut(part.material);
  for (RegionDescription& region : part.regions) {
    cut(region.material);
    region.cells.emplace();
  }
  for (std::size_t i = 0; i < cells.size() && !part.regions.empty(); ++i)
    if (const int region = whole.domains.of_cell(cells[i]).region; region >= 0)
      part.regions[static_cast<std::size_t>(region)].cells->push_back(static_cast<Index>(i));
  return part;
}

ScenePart SceneCut::part(int rank) const {
  ScenePart part;
  part.description = rest_;
  part.origin = world_.origin;
  part.fingerprint = world_.fingerprint;
  part.num_ranked = world_.num_nodes();
  std::vector<Index> local_of(at(world_.num_nodes()), -1), first_of_body;
  part.copies_begin.push_back(0);
  for (std::size_t b = 0; b < world_.bodies.size(); ++b) {
    const Body& body = world_.bodies[b];
    first_of_body.push_back(static_cast<Index>(part.numbers.size()));
    for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node) {
      if (!has_copy(node, rank)) continue;
      local_of[at(node)] = static_cast<Index>(part.numbers.size()) - first_of_body.back();
      part.numbers.push_back(node);
      part.ranked_numbers.push_back(ranked_numbers_[at(node)]);
      part.owners.push_back(owners_[at(node)]);
      part.copies.insert(part.copies.end(), copies_.begin() + copies_begin_[at(node)],
                         copies_.begin() + copies_begin_[at(node) + 1]);
      part.copies_begin.push_back(static_cast<Offset>(part.copies.size()));
    }
    BodyPart& own = part.bodies.emplace_back();
    own.mass = body.mass;
    own.has_own_cells = body.domains.front().region < 0;
    part.description.bodies[b] =
        body_part(b, rank, std::span(part.numbers).subspan(at(first_of_body.back())), local_of, own.cells);
  }
  select(rank, local_of, first_of_body, part);
  return part;
}

void SceneCut::select(int rank, std::span<const Index> local_of, std::span<const Index> first_of_body,
                      ScenePart& part) const {
  const auto in_world = [&](Index node) {
    const auto body = static_cast<std::size_t>(&world_.body_of(node) - world_.bodies.data());
    return first_of_body[body] + local_of[at(node)];
  };
  for (const Support& support : world_.supports) {
    SelectionPart& own = part.fixes.emplace_back();
    for (const Index node : support.nodes)
      if (local_of[at(node)] >= 0) own.nodes.push_back(local_of[at(node)]);
  }
  for (const LoadSites& sites : loads_) {
    SelectionPart& own = part.loads.emplace_back();
    for (const Index node : sites.nodes)
      if (local_of[at(node)] >= 0 && (!sites.is_on_each_node || owners_[at(node)] == rank))
        own.nodes.push_back(local_of[at(node)]);
    for (std::size_t facet = 0; facet < sites.facet_ranks.size(); ++facet)
      for (std::size_t a = 0; a < sites.nodes_per_facet && sites.facet_ranks[facet] == rank; ++a)
        own.facets.push_back(local_of[at(sites.facets[facet * sites.nodes_per_facet + a])]);
  }
  for (const auto& collider : world_.colliders) {
    ContactPart& own = part.colliders.emplace_back();
    const ContactPoints& points = collider->points();
    for (std::size_t i = 0; i < points.numbers.size(); ++i) {
      if (owners_[at(points.numbers[i])] != rank) continue;
      own.nodes.push_back(in_world(points.numbers[i]));
      own.stiffness.push_back(points.stiffness[i]);
    }
  }
  for (const Probe& probe : world_.probes)
    part.probes.push_back(owners_[at(probe.node)] == rank ? in_world(probe.node) : -1);
}

}  // namespace resilin
