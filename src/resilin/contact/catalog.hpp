#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/contact/collider_shape.hpp"

namespace resilin {

/// What a user says of a collider's shape; each kind reads what it needs.
struct ShapeDescription {
  Vector3 point = Vector3::Zero();   ///< of a half-space's boundary [m]
  Vector3 normal = Vector3::Zero();  ///< of a half-space, out of it
  Vector3 center = Vector3::Zero();  ///< of a sphere [m]
  double radius = 0;                 ///< of a sphere [m]
};

struct ShapeKind {
  std::string_view name;
  std::vector<std::string> keys;  ///< of the scene file that this kind must have
  std::shared_ptr<const ColliderShape> (*make)(const ShapeDescription&);
};

/// Every kind of collider. The scene reader, the documentation and the property tests walk this list.
const std::vector<ShapeKind>& shape_kinds();

/// The kind of this name, or nullptr.
const ShapeKind* find_shape_kind(std::string_view name);

}  // namespace resilin
