#include "mesh_box.hpp"

#include "resilin/core/text.hpp"

namespace resilin::cli {

std::string box_text(const BoundingBox& box) {
  return format_point(box.min) + " to " + format_point(box.max);
}

std::string file_box_text(const Mesh& mesh) {
  constexpr double largest_usual = 30;  // [m]
  const BoundingBox box = bounding_box(mesh);
  const bool is_large = (box.max - box.min).maxCoeff() > largest_usual;
  return box_text(box) + " m" + (is_large ? " (millimetres? scale = 0.001 in the scene)" : "");
}

}  // namespace resilin::cli
