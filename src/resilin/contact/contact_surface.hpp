#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "resilin/collision/surface.hpp"
#include "resilin/contact/carried_points.hpp"
#include "resilin/contact/collider_mesh.hpp"
#include "resilin/contact/collider_motion.hpp"
#include "resilin/contact/sharpness.hpp"
#include "resilin/energy/energy.hpp"
#include "resilin/mesh/depth.hpp"
#include "resilin/mesh/embedding.hpp"
#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// A body's part in contact.
struct ContactBody {
  CellBlock facets;  ///< facets of its surface, by the nodes of the world: seen from outside anticlockwise
  double stiffness = 0;  ///< kappa of its layer [Pa]
  /// Where set, the facets are lines or triangles by its points, which it carries by the nodes of the world.
  std::shared_ptr<const Embedding> carrier = nullptr;
};

/// A rigid contact surface with its own motion.
struct ContactObstacle {
  ColliderMesh mesh;
  ColliderMotion motion;
};

/// The surfaces of bodies as they touch each other: flat parts, whose vertices follow from the nodes by a
/// fixed linear map, and what they lend to the pairs that they make. The last of the bodies may be an
/// obstacle, whose vertices follow no node.
///
/// Lines and triangles are parts themselves; those of second order are cut at their nodes, quadrilaterals
/// into four triangles around their middle. Those of a fine surface that the cells carry follow the nodes of
/// their cells.
struct ContactSurface {
  CollisionSurface parts;
  CarriedPoints vertices;             ///< those of the obstacle follow no node
  std::vector<Index> numbers;         ///< numbers of each vertex: its node or its point of the carrier
  std::vector<double> point_areas;    ///< at rest, what faces one thing (facing_area.hpp) [m^2]
  std::vector<double> edge_areas;     ///< in 3D likewise: a third of each triangle beside the edge
  std::vector<double> edge_lengths;   ///< at rest [m]
  std::vector<Index> triangle_edges;  ///< in 3D three for each triangle; -1: none of its own
  std::vector<int> edge_counts;   ///< times that an edge's distance is to be counted besides its triangles'
  std::vector<int> point_counts;  ///< count of each vertex, besides its edges' and triangles'
  std::vector<double> stiffness;  ///< kappa of each body [Pa]; infinite for the obstacle
  std::vector<double> mean_point_areas;  ///< mean point areas of each body; where turned, mean lengths [m]
  std::vector<double> radii;             ///< radii of the vertices at rest, where turned about the axis [m]
  std::optional<ContactObstacle> obstacle;
  Sharpness sharpness;  ///< at rest

  /// Vertex positions, dim numbers each [m].
  VectorX places(const VectorX& x, const Conditions& c = {}) const;
  /// Their displacements for those of the nodes; the obstacle stands.
  VectorX displacements(const VectorX& of_nodes) const;
  /// Mean area of a body's points beside a vertex of something else [m^2].
  double mean_area_beside(Index vertex, Index body) const;
  bool is_obstacle(Index vertex) const {
    return obstacle && parts.bodies[static_cast<std::size_t>(vertex)] == parts.bodies.back();
  }
  Index num_body_vertices() const {
    return static_cast<Index>(parts.num_vertices() - (obstacle ? obstacle->mesh.vertices.size() : 0));
  }
  /// Adds what acts on the vertices to what acts on the nodes.
  void add_to_nodes(const VectorX& of_vertices, VectorX& of_nodes) const;
  /// The same of magnitudes.
  void add_magnitudes_to_nodes(const VectorX& of_vertices, VectorX& of_nodes) const;
};

/// Facets of bodies on the axis of axisymmetric solids are no surface.
/// @param rest_positions  of all nodes [m]
ContactSurface make_contact_surface(int dim, std::span<const ContactBody> bodies,
                                    const VectorX& rest_positions,
                                    std::optional<ContactObstacle> obstacle = std::nullopt,
                                    const Depth& depth = {});

/// Takes out points, edges and triangles whose nodes are all held, one number per node: where they are is not
/// for contact to say.
void leave_held_out(ContactSurface& surface, std::span<const std::uint8_t> is_held);

}  // namespace resilin
