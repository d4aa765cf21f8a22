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

}  // namespace

const std::vector<ShapeKind>& shape_kinds() {
  static const std::vector<ShapeKind> kinds = {
      {"half_space", {"point", "normal"}, make_half_space},
      {"sphere", {"center", "radius"}, make_sphere},
  };
  return kinds;
}

const ShapeKind* find_shape_kind(std::string_view name) {
  const auto found = std::ranges::find(shape_kinds(), name, &ShapeKind::name);
  return found == shape_kinds().end() ? nullptr : &*found;
}

}  // namespace resilin
