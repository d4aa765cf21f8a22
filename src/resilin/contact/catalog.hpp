#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/contact/collider_mesh.hpp"
#include "resilin/contact/collider_motion.hpp"
#include "resilin/contact/collider_shape.hpp"

namespace resilin {

/// Description of a collider's shape; each kind reads its own members.
struct ShapeDescription {
  Vector3 point = Vector3::Zero();      ///< point of a half-space's boundary [m]
  Vector3 normal = Vector3::Zero();     ///< normal of a half-space, out of it
  Vector3 center = Vector3::Zero();     ///< center of a sphere or a box [m]
  double radius = 0;                    ///< radius of a sphere, a capsule or a cylinder [m]
  Vector3 size = Vector3::Zero();       ///< size of a box, its edge lengths [m]
  Vector3 start = Vector3::Zero();      ///< start of the axis of a capsule or a cylinder [m] ...
  Vector3 end = Vector3::Zero();        ///< ... and where it ends
  Mesh mesh{};                          ///< triangles, edges, points; of solid cells the surface
  std::string mesh_name{};              ///< the file, for messages
  double scale = 1;                     ///< scale of the mesh
  Vector3 translate = Vector3::Zero();  ///< translation of the mesh, after scale [m]
};

/// A kind of collider: its keys in a scene and how its shape is made.
struct ShapeKind {
  std::string_view name;
  std::vector<std::string> keys;  ///< keys of the scene file that this kind must have
  std::shared_ptr<const ColliderShape> (*make)(const ShapeDescription&) = nullptr;  ///< exact: its distance
  ColliderMesh (*make_mesh)(const ShapeDescription&, int dim) = nullptr;  ///< or of facets: its surface
  std::vector<std::string> more_keys{};                                   ///< optional keys
  bool is_flat_too = true;                                                ///< there is such a thing in 2D
  /// Whether a turn leaves all its points within it; none: no turn does.
  bool (*is_round_about)(const ShapeDescription&, const ColliderTurn&) = nullptr;
};

/// Every kind of collider. The scene reader, the documentation and the property tests walk this list.
const std::vector<ShapeKind>& shape_kinds();

/// The kind of this name, or nullptr.
const ShapeKind* find_shape_kind(std::string_view name);

}  // namespace resilin
