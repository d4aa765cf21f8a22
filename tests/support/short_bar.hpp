#pragma once

#include <string>

#include "derivative_checks.hpp"
#include "resilin/element/catalog.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {

/// A short bar under its weight, of few distorted cells.
inline Description short_bar(int dimension, bool is_dynamic, const std::string& element = "P1") {
  Description scene = small_bar(dimension, is_dynamic);
  scene.newton.tolerance = 1e-12;
  scene.time_step = 0.01;
  scene.end_time = 0.04;
  BodyDescription& body = scene.bodies[0];
  body.element = element;
  if (is_simplex(require_element(element, dimension, "test").shape))
    body.mesh = dimension == 3 ? make_box({0.5, 0.25, 0.25}, {2, 1, 1}) : make_rectangle({0.5, 0.25}, {3, 2});
  else
    body.mesh = dimension == 3 ? make_hexahedron_box({0.5, 0.25, 0.25}, {2, 1, 1})
                               : make_quadrilateral_rectangle({0.5, 0.25}, {3, 2});
  const VectorX shifts = random_numbers(static_cast<Eigen::Index>(3 * body.mesh.vertices.size()), 7);
  for (std::size_t v = 0; v < body.mesh.vertices.size(); ++v)
    for (int k = 0; k < dimension; ++k)
      if (body.mesh.vertices[v][0] > 0)
        body.mesh.vertices[v][k] += 0.02 * shifts[static_cast<Eigen::Index>(v) * 3 + k];
  scene.probes.clear();
  // By number: a moved vertex would leave a plane.
  scene.fixes[0].where.kind = Where::Kind::vertices;
  for (std::size_t v = 0; v < body.mesh.vertices.size(); ++v)
    if (body.mesh.vertices[v][0] == 0) scene.fixes[0].where.vertices.push_back(static_cast<Index>(v));
  return scene;
}

}  // namespace resilin::testing
