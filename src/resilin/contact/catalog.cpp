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
      {.name = "half_space", .keys = {"point", "normal"}, .make = make_half_space},
      {.name = "sphere", .keys = {"center", "radius"}, .make = make_sphere},
      {.name = "box", .keys = {"center", "size"}, .make_mesh = make_box_mesh},
      {.name = "capsule", .keys = {"start", "end", "radius"}, .make_mesh = make_capsule},
      {.name = "cylinder",
       .keys = {"start", "end", "radius"},
       .make_mesh = make_cylinder,
       .is_flat_too = false},
      {.name = "mesh", .keys = {"mesh"}, .make_mesh = make_mesh, .more_keys = {"scale", "translate"}},
  };
  return kinds;
}

const ShapeKind* find_shape_kind(std::string_view name) {
  const auto found = std::ranges::find(shape_kinds(), name, &ShapeKind::name);
  return found == shape_kinds().end() ? nullptr : &*found;
}

}  // namespace resilin
