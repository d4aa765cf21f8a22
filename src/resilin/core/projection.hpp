#pragma once

#include <string_view>

namespace resilin {

/// Change of the eigenvalues of an element's Hessian before it is assembled.
enum class Projection {
  none,      ///< the exact Hessian
  clamp,     ///< negative eigenvalues become zero (Teran et al. 2005)
  absolute,  ///< negative eigenvalues change their sign (Chen et al. 2024, arXiv 2406.05928)
};

}  // namespace resilin
