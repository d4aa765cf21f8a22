#pragma once

#include <cstddef>
#include <vector>

#include "resilin/core/types.hpp"

namespace resilin {

/// A part of a body that somebody holds while the scene runs: a support until it is let go.
struct HeldFace {
  int number = 0;               ///< from 1 on, each once
  std::size_t body = 0;         ///< in World::bodies
  std::vector<Index> vertices;  ///< vertices of the body's mesh, as `where = { vertices = [...] }` names them
  std::vector<Index> nodes;     ///< nodes of the world: what that `where` selects
};

}  // namespace resilin
