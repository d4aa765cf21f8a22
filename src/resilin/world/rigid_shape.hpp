#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "resilin/contact/carried_points.hpp"
#include "resilin/element/element.hpp"
#include "resilin/mesh/mesh.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Shape of a rigid body, and the control nodes that carry it: x(X) = sum_a N_a(X) x_a with the shape
/// functions of one linear tetrahedron, in 2D of one triangle (docs/rigid.md).
struct RigidShape {
  Body body;  ///< its cells, nodes numbered from 0, for selections; it has no domains
  const ElementInfo* element = nullptr;
  Mesh mesh;                           ///< as placed in the world
  VectorX rest_positions;              ///< dim numbers for each vertex [m]
  std::vector<Vector3> control_nodes;  ///< their reference positions [m]
  /// The first control nodes span the point, or the line, where supports hold the body; 0: none does.
  Index num_held = 0;
  double mass = 0;             ///< [kg]
  Eigen::MatrixXd masses;      ///< the exact mass matrix of the control nodes [kg]
  VectorX centre_shares;       ///< shares of the control nodes in the centre of mass
  double modulus = 0;          ///< Young's modulus against stretching [Pa]
  double contact_modulus = 0;  ///< stands in contact for Young's modulus [Pa]
  bool has_own_skin = false;   ///< the scene gives a surface beside the mesh, or in its place
  std::string region_of;       ///< name of the body whose cells these are (rigid_region.hpp); empty: none

  /// Whether another body has its cells and its surface.
  bool is_region() const { return !region_of.empty(); }

  int dimension() const { return element->dim; }
  /// Whether the mass matrix is diagonal.
  bool is_lumped() const;
  /// N_a(X). @return dimension + 1 numbers
  VectorX weights(const Vector3& X) const;
  /// All vertices, carried by the control nodes, of which this is the number of the first.
  CarriedPoints carried_vertices(Index first_node) const;
  /// The same shares of numbers: `components` for each vertex from as many for each node of the world.
  std::vector<double> at_vertices(std::span<const double> nodal, int components, Index first_node) const;
  /// The control nodes that a support of these vertices fixes: all for vertices of a plane (in 2D a line) or
  /// of more, else those that span them.
  std::vector<Index> nodes_held_by(const std::vector<Index>& vertices) const;
  /// Whether points lie in no line, in 2D in no point: who holds them holds the body.
  bool is_held_by(std::span<const Vector3> points) const;
};

/// A description in which the mesh of each rigid body is the cell of its control nodes and its surface a
/// skin.
struct RigidBodies {
  Description description;
  std::vector<std::shared_ptr<const RigidShape>> shapes;  ///< one for each body; null: deformable
};

/// Whether at least one body is rigid.
bool has_rigid_bodies(const Description& description);

/// @throws InputError  for keys that a rigid body does not have, a missing density, supports that no control
/// nodes
///                     can span
RigidBodies with_control_nodes(const Description& description, std::vector<std::string>& warnings);

/// Whether a body is shown by its skin: that of a rigid body is the surface of its mesh, unless the scene
/// gives one.
bool is_shown_by_skin(const Body& body);

/// Adds the mass of a body times a factor: that of its cells, or of a rigid body's control nodes.
void add_body_masses(MassMatrix& mass, const Body& body, const VectorX& rest_positions, double factor);
/// Whether its mass matrix needs entries beside the diagonal.
bool has_consistent_mass(const Body& body);

/// A term on the vertices of a shape as one on its control nodes.
std::shared_ptr<Energy> carried_term(std::shared_ptr<Energy> of_vertices, const RigidShape& shape,
                                     Index first_node, const std::vector<Index>& vertices);

}  // namespace resilin
