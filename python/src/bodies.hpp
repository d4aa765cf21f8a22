#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/world/world.hpp"

/// The bodies of a world as arrays.
namespace resilin::python {

inline std::vector<std::string> body_names(const World& world) {
  std::vector<std::string> names;
  for (const Body& body : world.bodies) names.push_back(body.name);
  return names;
}

/// The number of the body with this name. @throws InputError
inline std::size_t find_body(const World& world, const std::string& name) {
  const std::vector<std::string> names = body_names(world);
  for (std::size_t b = 0; b < names.size(); ++b)
    if (names[b] == name) return b;
  throw InputError("body", "one of " + join(names), "\"" + name + "\"");
}

inline const Body& body_of(const World& world, const std::string& name) {
  return world.bodies[find_body(world, name)];
}

/// (M, n), in the world's numbering; mid-edge nodes of quadratic elements behind the corners, as in MSH.
inline NumpyArray<Index> cells_of(const World& world, const std::string& name) {
  const Body& body = body_of(world, name);
  return numpy_array<Index>(body.cells, {static_cast<std::size_t>(body.num_cells()),
                                         static_cast<std::size_t>(num_nodes(body.cell_kind))});
}

inline CellKind cell_kind_of(const World& world, const std::string& name) {
  return body_of(world, name).cell_kind;
}

/// The nodes of a body: first, and behind the last.
inline std::pair<Index, Index> vertex_range_of(const World& world, const std::string& name) {
  const Body& body = body_of(world, name);
  return {body.first_node, body.first_node + body.num_nodes};
}

}  // namespace resilin::python
