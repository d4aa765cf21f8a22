#include "resilin/world/mesh_collider.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "resilin/collision/pair_distance.hpp"
#include "resilin/contact/crossing.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/colliders.hpp"
#include "resilin/world/meeting_surface.hpp"

namespace resilin {
namespace {

// ---- the collider by itself

void check_mesh(const ColliderMesh& mesh, const World& world, const std::string& place) {
  if (mesh.facets.empty())
    throw InputError(place, "triangles, edges or points", "none",
                     "a collider in 2D is a polyline, in 3D a surface");
  for (const Vector3& X : mesh.vertices) {
    if (!X.allFinite()) throw InputError(place, "finite coordinates", world.place_text(X));
    if (world.dimension == 2 && X.z() != 0)
      throw InputError(place, "vertices in the plane z = 0", "one at " + format_point(X));
  }
  if (world.dimension == 2) return;
  require_areas(mesh, world, place);
}

/// Triangles that lie upon each other along an edge.
void check_folds(const ContactSurface& surface, const World& world, const VectorX& places,
                 const std::string& place) {
  const CollisionSurface& parts = surface.parts;
  const auto corner = [&](Index v) { return node_position(3, v, places); };
  std::vector<std::pair<Index, Vector3>> sides;  // edges with the ways that triangles have from them
  for (std::size_t k = 0; k < surface.triangle_edges.size(); ++k) {
    const std::size_t t = k - k % 3;
    const Index a = parts.triangles[k], b = parts.triangles[t + (k + 1) % 3],
                c = parts.triangles[t + (k + 2) % 3];
    if (!surface.is_obstacle(a) || surface.triangle_edges[k] < 0 || a == c || b == c) continue;
    const Vector3 along = (corner(b) - corner(a)).normalized(), other = corner(c) - corner(a);
    sides.emplace_back(surface.triangle_edges[k], (other - other.dot(along) * along).normalized());
  }
  std::ranges::stable_sort(sides, {}, &std::pair<Index, Vector3>::first);
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].first != sides[i - 1].first || (sides[i].second - sides[i - 1].second).norm() > 1e-6)
      continue;
    const Index* ends = &parts.edges[static_cast<std::size_t>(2 * sides[i].first)];
    throw InputError(place, "triangles beside each other",
                     "two upon each other along the edge from " +
                         world.place_text(world.origin + corner(ends[0])) + " to " +
                         world.place_text(world.origin + corner(ends[1])),
                     "unfold the mesh, or leave one of them out");
  }
}

// ---- where bodies are

/// Bodies as an obstacle finds them at the start.
class ObstacleStart {
 public:
  ObstacleStart(const ObstacleContact& contact, const World& world, std::string place)
      : contact_(contact),
        world_(world),
        place_(std::move(place)),
        surface_(contact.surface()),
        places_(surface_.places(world.start_positions)),
        is_closed_(is_closed(contact.obstacle().mesh, world.dimension)) {}

  void check() const {
    const auto crossing = first_crossing(surface_.parts, contact_.meetings(), places_);
    if (crossing || body_inside()) refuse_deepest();
    if (crossing) refuse(*crossing);
    if (const auto body = body_around()) refuse_around(*body);
    check_gap();
  }
  /// For an obstacle in which no vertex is.
  void check_is_beside() const {
    if (const auto crossing = first_crossing(surface_.parts, contact_.meetings(), places_)) refuse(*crossing);
    if (const auto body = body_around()) refuse_around(*body);
  }

 private:
  Index obstacle_number() const { return surface_.parts.bodies.back(); }
  bool is_inside(Index vertex) const {
    return is_closed_ && resilin::is_inside(surface_.parts, obstacle_number(), corner(vertex), places_);
  }
  /// Where nothing crosses.
  std::optional<Index> body_inside() const {
    for (Index body = 0; is_closed_ && body < obstacle_number(); ++body)
      if (has_piece_inside(surface_.parts, body, obstacle_number(), places_)) return body;
    return std::nullopt;
  }
  std::optional<Index> body_around() const {
    for (Index body = 0; body < obstacle_number(); ++body)
      if (has_inside(world_, world_.bodies[static_cast<std::size_t>(body)]) &&
          has_piece_inside(surface_.parts, obstacle_number(), body, places_))
        return body;
    return std::nullopt;
  }
  double distance_to_obstacle(Index vertex) const {
    const CollisionSurface& parts = surface_.parts;
    double least = std::numeric_limits<double>::infinity();
    const auto look_at = [&](PairKind kind, const std::vector<Index>& all, std::size_t corners) {
      for (std::size_t k = 0; k + corners <= all.size(); k += corners) {
        if (!surface_.is_obstacle(all[k])) continue;
        std::array<Vector3, most_pair_vertices> pair{corner(vertex)};
        for (std::size_t c = 0; c < corners; ++c) pair[c + 1] = corner(all[k + c]);
        least = std::min(least, squared_distance<3>(kind, std::span(pair).first(corners + 1)));
      }
    };
    if (parts.dim == 3) look_at(PairKind::point_triangle, parts.triangles, 3);
    if (parts.dim == 2) look_at(PairKind::point_edge, parts.edges, 2);
    return std::sqrt(least);
  }
  void refuse_deepest() const {
    Index deepest = -1;
    double depth = -1;
    for (const Index v : surface_.parts.points) {
      if (surface_.is_obstacle(v) || !is_inside(v)) continue;
      const double d = distance_to_obstacle(v);
      if (d > depth) {
        depth = d;
        deepest = v;
      }
    }
    if (deepest < 0) return;
    throw InputError(place_, "bodies that start outside, with a gap",
                     vertex_text(deepest) + ", " + format_short(depth) + " m inside", cure(depth));
  }
  [[noreturn]] void refuse(const Crossing& crossing) const {
    const auto [first, other] = vertices_of(crossing, surface_.parts);
    const Index vertex = surface_.is_obstacle(first) ? other : first;
    const Index end = surface_.parts.edges[static_cast<std::size_t>(2 * crossing.edge + 1)];
    // The body's nearest way out is along an end of what goes through.
    const double depth = std::min(distance_to_obstacle(vertex), (corner(end) - corner(first)).norm());
    throw InputError(place_, "bodies that start beside it",
                     "\"" + body_of(vertex).name + "\" goes through it near " + vertex_text(vertex),
                     cure(depth));
  }
  [[noreturn]] void refuse_around(Index body) const {
    throw InputError(place_, "bodies that start beside it",
                     "one that is inside \"" + world_.bodies[static_cast<std::size_t>(body)].name + "\"",
                     "move the body (translate) or the collider away");
  }
  void check_gap() const {
    if (!contact_.touches(world_.start_positions)) return;
    const SurfaceContact::Gap nearest = contact_.smallest_gap(world_.start_positions);
    const auto second = static_cast<std::size_t>(num_first(nearest.kind));
    const Index vertex = nearest.vertices[surface_.is_obstacle(nearest.vertices[0]) ? second : 0];
    throw InputError(place_, "bodies that start with a gap", vertex_text(vertex) + ", on its surface",
                     cure(0));
  }

  Vector3 corner(Index vertex) const { return node_position(surface_.parts.dim, vertex, places_); }
  const Body& body_of(Index vertex) const {
    return world_.bodies[static_cast<std::size_t>(surface_.parts.bodies[static_cast<std::size_t>(vertex)])];
  }
  std::string vertex_text(Index vertex) const {
    return point_name(body_of(vertex), surface_.numbers[static_cast<std::size_t>(vertex)]) + " at " +
           world_.place_text(vertex, places_);
  }
  std::string cure(double depth) const {
    return "move the body (translate) or the collider by " +
           format_short(depth + 0.5 * contact_.activation_distance()) + " m or more";
  }

  const ObstacleContact& contact_;
  const World& world_;
  std::string place_;
  const ContactSurface& surface_;
  VectorX places_;
  bool is_closed_;
};

}  // namespace

void check_is_beside(ColliderMesh mesh, const ColliderDescription& description, double activation_distance,
                     const World& world) {
  ContactSurface surface =
      make_contact_surface(world.dimension, contact_bodies(world, description.stiffness),
                           world.contact_shape(), ContactObstacle{std::move(mesh), {}}, depth_of(world));
  leave_held_out(surface, held_nodes(world));
  const ObstacleContact contact(description.name, surface, activation_distance, world.start_positions);
  ObstacleStart(contact, world, description.place).check_is_beside();
}

std::shared_ptr<const ObstacleContact> make_mesh_collider(const ColliderDescription& description,
                                                          const ShapeKind& kind, double activation_distance,
                                                          const World& world) {
  ColliderMesh mesh = kind.make_mesh(description.shape, world.dimension);
  const std::string& file = description.shape.mesh_name;
  const std::string mesh_place = description.place + (file.empty() ? "" : ".mesh: " + file);
  check_mesh(mesh, world, mesh_place);
  ContactSurface surface = make_contact_surface(
      world.dimension, contact_bodies(world, description.stiffness), world.contact_shape(),
      ContactObstacle{std::move(mesh), motion_of(description, world.end_time)}, depth_of(world));
  if (world.dimension == 3) check_folds(surface, world, surface.places(world.contact_shape()), mesh_place);
  leave_held_out(surface, held_nodes(world));
  const std::size_t num_bodies = surface.stiffness.size();
  auto collider = std::make_shared<ObstacleContact>(description.name, surface, activation_distance,
                                                    world.start_positions);
  if (description.friction > 0)
    collider->set_friction(std::vector<double>(num_bodies * num_bodies, description.friction));
  ObstacleStart(*collider, world, description.place).check();
  return collider;
}

}  // namespace resilin
