#pragma once

#include "resilin/core/members.hpp"
#include "resilin/mesh/mesh.hpp"

/// The members of a mesh.
namespace resilin {

RESILIN_MEMBERS(CellBlock, kind, nodes)
RESILIN_MEMBERS(Group, name, cells, vertices)
RESILIN_MEMBERS(CellField, name, block, values)
RESILIN_MEMBERS(Mesh, vertices, blocks, groups, cell_fields)

}  // namespace resilin
