#include "resilin/contact/catalog.hpp"

#include <algorithm>

#include "resilin/contact/half_space.hpp"
#include "resilin/contact/sphere.hpp"

namespace resilin {
namespace {

std::shared_ptr<const ColliderShape> make_half_space(const ShapeDescription& d) {
  return std::make_shared<HalfSpace>(d.point, d.normal);
}

std::shared_ptr<const ColliderShape> make_sphere(const ShapeDescription& d) {
  return std::make_shared<Sphere>(d.center, d.radius);
}

/// Whether a line goes through a point along a direction; rounding of what users write does not count.
bool goes_along(const ColliderTurn& line, const Vector3& point, const Vector3& direction, double size) {
  const Vector3 axis = line.axis.normalized();
  return direction.cross(axis).norm() <= 1e-9 * direction.norm() &&
         (point - line.center).cross(axis).norm() <= 1e-9 * size;
}

bool half_space_is_round(const ShapeDescription& d, const ColliderTurn& turn) {
  return goes_along({.axis = turn.axis, .center = d.point}, d.point, d.normal, 1);
}

bool sphere_is_round(const ShapeDescription& d, const ColliderTurn& turn) {
  return goes_along(turn, d.center, turn.axis, d.radius);
}

bool shaft_is_round(const ShapeDescription& d, const ColliderTurn& turn) {
  return goes_along(turn, d.start, d.end - d.start, d.radius);
}

ColliderMesh make_box_mesh(const ShapeDescription& d, int dim) { return box_mesh(d.center, d.size, dim); }

ColliderMesh make_capsule(const ShapeDescription& d, int dim) {
  return capsule_mesh(d.start, d.end, d.radius, dim);
}

ColliderMesh make_cylinder(const ShapeDescription& d, int) { return cylinder_mesh(d.start, d.end, d.radius); }

ColliderMesh make_mesh(const ShapeDescription& d, int dim) {
  ColliderMesh mesh = collider_mesh(d.mesh, dim);
  for (Vector3& vertex : mesh.vertices) vertex = d.scale * vertex + d.translate;
  return mesh;
}

}  // namespace

const std::vector<ShapeKind>& shape_kinds() {
  static const std::vector<ShapeKind> kinds = {
      {.name = "half_space",
       .keys = {"point", "normal"},
       .make = make_half_space,
       .is_round_about = half_space_is_round},
      {.name = "sphere",
       .keys = {"center", "radius"},
       .make = make_sphere,
       .is_round_about = sphere_is_round},
      {.name = "box", .keys = {"center", "size"}, .make_mesh = make_box_mesh},
      {.name = "capsule",
       .keys = {"start", "end", "radius"},
       .make_mesh = make_capsule,
       .is_round_about = shaft_is_round},
      {.name = "cylinder",
       .keys = {"start", "end", "radius"},
       .make_mesh = make_cylinder,
       .is_flat_too = false,
       .is_round_about = shaft_is_round},
      {.name = "mesh", .keys = {"mesh"}, .make_mesh = make_mesh, .more_keys = {"scale", "translate"}},
  };
  return kinds;
}

const ShapeKind* find_shape_kind(std::string_view name) {
  const auto found = std::ranges::find(shape_kinds(), name, &ShapeKind::name);
  return found == shape_kinds().end() ? nullptr : &*found;
}

}  // namespace resilin
