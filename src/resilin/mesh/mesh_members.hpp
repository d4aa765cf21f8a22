#pragma once

#include <tuple>

#include "resilin/core/archive.hpp"
#include "resilin/mesh/mesh.hpp"

/// What a mesh consists of, for archives (core/archive.hpp).
namespace resilin {

template <OneOf<CellBlock> T>
auto members(T& block) {
  auto& [kind, nodes] = block;
  return std::tie(kind, nodes);
}

template <OneOf<Group> T>
auto members(T& group) {
  auto& [name, cells, vertices] = group;
  return std::tie(name, cells, vertices);
}

template <OneOf<CellField> T>
auto members(T& field) {
  auto& [name, block, values] = field;
  return std::tie(name, block, values);
}

template <OneOf<Mesh> T>
auto members(T& mesh) {
  auto& [vertices, blocks, groups, cell_fields] = mesh;
  return std::tie(vertices, blocks, groups, cell_fields);
}

}  // namespace resilin
