#pragma once

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/picture/picture.hpp"

/// Scene that the tests of pictures draw.
namespace resilin::testing {

inline const Color white = {255, 255, 255};

/// A bar of 2 x 1 x 1 with x as a field on its points, the number of the cell on its cells, and a
/// displacement of 0.5 m along x, which its points have already made.
inline VtuContent bar() {
  VtuContent frame;
  frame.file.mesh = make_box({2, 1, 1}, {4, 2, 2});
  frame.file.mesh.groups.clear();
  VtuValues x{"x", 1, {}}, displacement{"displacement", 3, {}}, number{"number", 1, {}},
      tensor{"stress", 9, {}};
  for (Vector3& vertex : frame.file.mesh.vertices) {
    x.values.push_back(vertex.x());
    displacement.values.insert(displacement.values.end(), {0.5, 0, 0});
    vertex.x() += 0.5;
  }
  const Index num_cells = frame.file.mesh.blocks[0].num_cells();
  for (Index cell = 0; cell < num_cells; ++cell) number.values.push_back(cell);
  tensor.values.assign(static_cast<std::size_t>(9 * num_cells), 1.0);
  frame.point_data = {x, displacement};
  frame.cell_data = {number, tensor};
  return frame;
}

inline PictureOptions small(const std::string& field) {
  PictureOptions options;
  options.field = field;
  options.width = 300;
  options.height = 200;
  options.view = "front";
  options.edges = "off";
  return options;
}

inline int count(const Image& image, const auto& is_meant) {
  return static_cast<int>(std::ranges::count_if(image.pixels, is_meant));
}

inline std::string error_of(const VtuContent& frame, const PictureOptions& options) {
  try {
    draw_picture(frame, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

/// Two walls across the line of sight, one before the bar and one behind it.
inline Mesh walls() {
  Mesh mesh;
  for (const double y : {-1.0, 2.0})
    for (const auto& [x, z] : {std::pair(-0.2, -0.2), {1.0, -0.2}, {1.0, 1.2}, {-0.2, 1.2}})
      mesh.vertices.emplace_back(x, y, z);
  mesh.block(CellKind::triangle).nodes = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
  return mesh;
}

}  // namespace resilin::testing
