#include "resilin/fields/contact_traction.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "resilin/contact/contact_node.hpp"
#include "resilin/mesh/cell_kind.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/friction.hpp"
#include "resilin/world/meeting_surface.hpp"

namespace resilin {
namespace {

/// Nodes in the middle of edges where forces go to the ends of the edges, half each, as those of the linear
/// shape functions: an even pressure leaves nothing to the corners of quadratic triangles.
class MiddleNodes {
 public:
  MiddleNodes() = default;
  explicit MiddleNodes(const CellBlock& cells) {
    if (!is_second_order(cells.kind)) return;
    const auto num_corners = static_cast<std::size_t>(resilin::num_corners(cells.kind));
    for (Index cell = 0; cell < cells.num_cells(); ++cell) {
      const std::span<const Index> nodes = cells.cell(cell);
      auto middle = num_corners;
      for (const auto& [i, j] : cell_edges(cells.kind))
        ends_[nodes[middle++]] = {nodes[static_cast<std::size_t>(i)], nodes[static_cast<std::size_t>(j)]};
    }
  }

  /// Calls `visit(corner, share)`: a corner is its own.
  template <class Visit>
  void for_each_corner(Index node, const Visit& visit) const {
    const auto found = ends_.find(node);
    if (found == ends_.end()) return visit(node, 1.0);
    for (const Index end : found->second) visit(end, 0.5);
  }
  /// Gathers values of nodes, dim each.
  void gather(VectorX& values, int dim) const {
    for (const auto& [middle, ends] : ends_)
      for (int k = 0; k < dim; ++k) {
        double& value = values[Eigen::Index{middle} * dim + k];
        for (const Index end : ends) values[Eigen::Index{end} * dim + k] += 0.5 * value;
        value = 0;
      }
  }
  void fill(VectorX& values, int dim) const {
    for (const auto& [middle, ends] : ends_)
      for (int k = 0; k < dim; ++k)
        values[Eigen::Index{middle} * dim + k] =
            0.5 * (values[Eigen::Index{ends[0]} * dim + k] + values[Eigen::Index{ends[1]} * dim + k]);
  }

 private:
  std::map<Index, std::array<Index, 2>> ends_;
};

/// A face beside a node: its normal out of the deformed body, and the node's share of it.
struct TouchedFace {
  Vector3 normal;
  double area = 0, rest_area = 0;  ///< deformed, at rest [m^2]
  double length = 0;               ///< deformed, in the plane [m]
};

/// Area that a force presses on.
struct PressedArea {
  Vector3 normal = Vector3::Zero();
  double area = 0, rest_area = 0, length = 0;
};

/// Surfaces of bodies that contact acts on, and the forces there, moved to the nodes that bear an even
/// pressure evenly.
class TouchedFaces {
 public:
  /// @param forces  that tell where bodies are touched
  TouchedFaces(const World& world, const VectorX& x, const VectorX& forces) : dim_(world.dimension) {
    for (const Body& body : world.bodies) {
      const auto own =
          forces.segment(Eigen::Index{body.first_node} * dim_, Eigen::Index{body.num_nodes} * dim_);
      if (!own.isZero(0))
        body.meets_with_skin() ? add_skin(world, body, x) : add_facets(world, body, x, forces);
    }
  }

  void gather(VectorX& forces) const {
    for (const MiddleNodes& middles : middles_) middles.gather(forces, dim_);
  }
  /// Values of middle nodes from those of the ends, as far as these are pressed on there.
  /// @param forces  gathered
  /// @param count   of values for each node
  void fill(const VectorX& forces, VectorX& values, int count) const {
    for (const std::size_t skin : skins_) middles_[skin].fill(values, count);
    for (const auto& [facet, normal] : quadratic_facets_) {
      std::array<double, 3> shares{};
      for (std::size_t i = 0; i < 3; ++i) {
        const PressedArea pressed = pressed_at(facet[i], forces);
        shares[i] = pressed.area > 0 && normal.dot(pressed.normal) > least_facing ? 0.5 : 0;
      }
      std::size_t middle = 3;
      for (const auto& [i, j] : cell_edges(CellKind::triangle6)) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        const Eigen::Index at = Eigen::Index{facet[middle++]} * count;
        if (shares[a] == 0 && shares[b] == 0) continue;
        values.segment(at, count) = shares[a] * values.segment(Eigen::Index{facet[a]} * count, count) +
                                    shares[b] * values.segment(Eigen::Index{facet[b]} * count, count);
      }
    }
  }

  /// Calls `visit(node, pressed)` of what forces, gathered, press on.
  template <class Visit>
  void for_each_pressed(const VectorX& forces, const Visit& visit) const {
    for (const auto& [node, faces] : faces_)
      if (const PressedArea pressed = pressed_at(node, forces); pressed.area > 0 && pressed.rest_area > 0)
        visit(node, pressed);
  }

 private:
  /// A facet looks the way of what is pressed on, by the cosine.
  static constexpr double least_facing = 0.1;

  /// Without area where nothing is.
  PressedArea pressed_at(Index node, const VectorX& forces) const {
    PressedArea pressed;
    const auto found = faces_.find(node);
    const Vector3 force = node_position(dim_, node, forces);
    if (found == faces_.end() || force.isZero(0)) return pressed;
    for (const TouchedFace& face : found->second)
      pressed.normal += face.area * std::max(0.0, -face.normal.dot(force.normalized())) * face.normal;
    if (pressed.normal.isZero(0)) return pressed;
    pressed.normal.normalize();
    for (const TouchedFace& face : found->second) {
      const double share = std::max(0.0, face.normal.dot(pressed.normal));
      pressed.area += share * face.area;
      pressed.rest_area += share * face.rest_area;
      pressed.length += share * face.length;
    }
    return pressed;
  }

  void add_facets(const World& world, const Body& body, const VectorX& x, const VectorX& forces) {
    const Depth depth = depth_of(world);
    const CellBlock facets = boundary({.kind = body.cell_kind, .nodes = body.cells}).facets;
    // Edges of quadratic lines bear an even pressure by their shares as they are.
    const MiddleNodes& middles = middles_.emplace_back(dim_ == 3 ? MiddleNodes(facets) : MiddleNodes());
    const VectorX gathered = [&] {
      VectorX moved = forces.cwiseAbs();
      middles.gather(moved, dim_);
      return moved;
    }();
    for (Index facet = 0; facet < facets.num_cells(); ++facet) {
      const std::span<const Index> nodes = facets.cell(facet);
      if (std::ranges::all_of(nodes,
                              [&](Index node) { return node_position(dim_, node, gathered).isZero(0); }))
        continue;
      const CellBlock one{.kind = facets.kind, .nodes = {nodes.begin(), nodes.end()}};
      const Vector3 normal = area_vector(dim_, facets.kind, nodes, x).normalized();
      const auto add = [&](const VectorX& places, const Depth& deep, double TouchedFace::* share) {
        for (const ContactNode& of : contact_nodes(dim_, one, places, 1, deep))
          middles.for_each_corner(of.node, [&](Index corner, double half) {
            TouchedFace& face = faces_[corner].emplace_back(TouchedFace{.normal = normal});
            face.*share = half * of.stiffness;
          });
      };
      add(x, depth, &TouchedFace::area);
      add(world.rest_positions, depth, &TouchedFace::rest_area);
      if (dim_ == 2) add(x, {}, &TouchedFace::length);
      if (facets.kind == CellKind::triangle6) {
        QuadraticFacet& added = quadratic_facets_.emplace_back(QuadraticFacet{.nodes = {}, .normal = normal});
        std::ranges::copy(nodes, added.nodes.begin());
      }
    }
  }

  /// On a skin each node has as much of a facet as it carries of its vertices.
  void add_skin(const World& world, const Body& body, const VectorX& x) {
    skins_.push_back(middles_.size());
    const MiddleNodes& middles =
        middles_.emplace_back(MiddleNodes({.kind = body.cell_kind, .nodes = body.cells}));
    const CellBlock facets = meeting_body(body, dim_, 1.0).facets;
    const CarriedPoints vertices = skin_vertices(body);
    const VectorX rest = vertices.places(dim_, world.rest_positions), now = vertices.places(dim_, x);
    const double side = outward_side(dim_, facets, rest);
    for (Index facet = 0; facet < facets.num_cells(); ++facet) {
      const std::span<const Index> corners = facets.cell(facet);
      const double rest_share = area_vector(dim_, facets.kind, corners, rest).norm() / dim_;
      const Vector3 vector = area_vector(dim_, facets.kind, corners, now);
      const double share = vector.norm() / dim_;
      const Vector3 normal = side * vector.normalized();
      for (const Index vertex : corners)
        vertices.for_each_node(vertex, [&](Index node, double weight) {
          middles.for_each_corner(node, [&](Index corner, double half) {
            const double part = half * weight;
            faces_[corner].push_back({.normal = normal,
                                      .area = part * world.thickness * share,
                                      .rest_area = part * world.thickness * rest_share,
                                      .length = part * share});
          });
        });
    }
  }

  /// 1 for facets that are anticlockwise seen from outside, else -1: files have both.
  static double outward_side(int dim, const CellBlock& facets, const VectorX& places) {
    Vector3 center = Vector3::Zero();
    for (const Index vertex : facets.nodes) center += node_position(dim, vertex, places);
    center /= static_cast<double>(facets.nodes.size());
    double volume = 0;
    for (Index facet = 0; facet < facets.num_cells(); ++facet)
      volume += area_vector(dim, facets.kind, facets.cell(facet), places)
                    .dot(node_position(dim, facets.cell(facet)[0], places) - center);
    return volume < 0 ? -1 : 1;
  }

  struct QuadraticFacet {
    std::array<Index, 6> nodes;
    Vector3 normal;
  };

  int dim_;
  std::map<Index, std::vector<TouchedFace>> faces_;
  std::vector<MiddleNodes> middles_;  ///< one for each body that is touched
  std::vector<std::size_t> skins_;    ///< those of bodies that are touched on their skin
  std::vector<QuadraticFacet> quadratic_facets_;
};

VectorX contact_forces(const World& world, const State& state) {
  VectorX gradient = VectorX::Zero(state.positions.size());
  for (const auto& term : world.terms)
    if (term->properties().category == EnergyCategory::contact)
      term->add_gradient(state.positions, conditions_of(state), gradient);
  return -gradient;
}

}  // namespace

VectorX contact_traction(const World& world, const State& state) {
  const int dim = world.dimension;
  VectorX forces = contact_forces(world, state);
  VectorX along = VectorX::Zero(forces.size());  // minus friction
  if (const auto friction = friction_of(world, state))
    friction->add_gradient(state.positions, conditions_of(state), along);
  VectorX traction = VectorX::Zero(forces.size());
  const TouchedFaces faces(world, state.positions, forces);
  faces.gather(forces);
  faces.gather(along);
  faces.for_each_pressed(forces, [&](Index node, const PressedArea& pressed) {
    traction.segment(Eigen::Index{node} * dim, dim) =
        (forces - along).segment(Eigen::Index{node} * dim, dim) / pressed.rest_area;
  });
  faces.fill(forces, traction, dim);
  return traction;
}

VectorX contact_pressure(const World& world, const State& state) {
  VectorX forces = contact_forces(world, state);
  VectorX pressure = VectorX::Zero(world.num_nodes());
  const TouchedFaces faces(world, state.positions, forces);
  faces.gather(forces);
  faces.for_each_pressed(forces, [&](Index node, const PressedArea& pressed) {
    pressure[node] = -node_position(world.dimension, node, forces).dot(pressed.normal) / pressed.area;
  });
  faces.fill(forces, pressure, 1);
  return pressure;
}

namespace {

/// Forces of contact on the nodes, by what presses.
struct PressingForces {
  ContactPatch patch;
  VectorX forces;
};

std::vector<PressingForces> forces_by_source(const World& world, const State& state) {
  const Conditions conditions = conditions_of(state);
  std::vector<PressingForces> all;
  for (std::size_t t = 0; t < world.origins.size(); ++t) {
    if (world.origins[t].kind != TermOrigin::Kind::collider) continue;
    VectorX gradient = VectorX::Zero(state.positions.size());
    world.terms[t]->add_gradient(state.positions, conditions, gradient);
    if (gradient.isZero(0)) continue;
    PressingForces& pressing = all.emplace_back();
    pressing.patch.collider = world.terms[t]->name();
    pressing.forces = -gradient;
  }
  if (!world.contact) return all;
  const int dim = world.dimension;
  const ContactSurface& surface = world.contact->surface();
  std::map<std::array<Index, 2>, VectorX> of_bodies;
  for (const PartForce& part : world.contact->part_forces(state.positions, conditions)) {
    const auto split = static_cast<std::size_t>(num_first(part.kind));
    const auto body_of = [&](std::size_t i) {
      return surface.parts.bodies[static_cast<std::size_t>(part.vertices[i])];
    };
    const Index first = body_of(0), second = body_of(split);
    const auto [low, high] = std::minmax(first, second);
    if (low == high) continue;
    VectorX& forces = of_bodies.try_emplace({low, high}, VectorX::Zero(state.positions.size())).first->second;
    for (std::size_t i = 0; i < static_cast<std::size_t>(num_vertices(part.kind)); ++i) {
      if (body_of(i) != low) continue;
      surface.vertices.for_each_node(part.vertices[i], [&](Index node, double share) {
        forces.segment(Eigen::Index{node} * dim, dim) +=
            share * part.weights[i] * part.force * part.normal.head(dim);
      });
    }
  }
  for (auto& [bodies, forces] : of_bodies) {
    PressingForces& pressing = all.emplace_back();
    pressing.patch.body = bodies[0];
    pressing.patch.other = bodies[1];
    pressing.forces = std::move(forces);
  }
  return all;
}

/// A node of a patch.
struct PressedNode {
  Index node;
  PressedArea pressed;
  double force;
  double pressure() const { return force / pressed.area; }
};

void measure_patch(const World& world, const State& state, const std::vector<PressedNode>& nodes,
                   ContactPatch& patch) {
  constexpr double least_share = 0.01;
  for (const PressedNode& at : nodes)
    patch.largest_pressure = std::max(patch.largest_pressure, at.pressure());
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vector3 low = Vector3::Constant(infinity), high = -low;
  for (const PressedNode& at : nodes) {
    const Vector3 x = world.place_of(at.node, state.positions);
    patch.force += at.force;
    patch.center += at.force * x;
    if (!(at.pressure() > least_share * patch.largest_pressure)) continue;
    patch.area += at.pressed.area;
    patch.reference_area += at.pressed.rest_area;
    patch.width += at.pressed.length;
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  patch.center /= patch.force;
  patch.extent = high - low;
}

}  // namespace

std::vector<ContactPatch> contact_patches(const World& world, const State& state) {
  const int dim = world.dimension;
  std::vector<PressingForces> sources = forces_by_source(world, state);
  std::vector<ContactPatch> patches;
  if (sources.empty()) return patches;
  VectorX touched = VectorX::Zero(state.positions.size());
  for (const PressingForces& source : sources) touched += source.forces.cwiseAbs();
  const TouchedFaces faces(world, state.positions, touched);
  for (PressingForces& source : sources) {
    faces.gather(source.forces);
    std::vector<PressedNode> nodes;
    faces.for_each_pressed(source.forces, [&](Index node, const PressedArea& pressed) {
      const double force = -node_position(dim, node, source.forces).dot(pressed.normal);
      if (force > 0) nodes.push_back({.node = node, .pressed = pressed, .force = force});
    });
    if (nodes.empty()) continue;
    measure_patch(world, state, nodes, source.patch);
    patches.push_back(std::move(source.patch));
  }
  return patches;
}

}  // namespace resilin
