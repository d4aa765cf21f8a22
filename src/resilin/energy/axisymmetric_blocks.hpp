#pragma once

#include "resilin/energy/kernels/element_blocks.hpp"

namespace resilin {

/// Whether these cells have the arrays of axisymmetric solids (kernels/axisymmetric_kernels.hpp).
inline bool is_axisymmetric(const ElementBlocks& blocks) {
  return blocks.dim == 2 && blocks.num_nodes > 0 &&
         blocks.reference_gradients.size() ==
             3 * blocks.num_points * static_cast<std::size_t>(blocks.num_nodes);
}

/// Number of rows and columns of the deformation gradient that the kernels of these cells know.
inline int state_dim(const ElementBlocks& blocks) { return is_axisymmetric(blocks) ? 3 : blocks.dim; }

}  // namespace resilin
