#pragma once

#include <algorithm>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/material/law_sum.hpp"

namespace resilin::testing {

/// As many of these families of fibres as a law can have; none for an isotropic one. All parts of a sum have
/// them.
inline std::vector<Vector3> fibres_for(const LawInfo& law, std::vector<Vector3> directions) {
  if (is_sum(law)) {
    const std::size_t count = directions.size();
    for (std::size_t k = count; k < static_cast<std::size_t>(law.max_fibres); ++k)
      directions.push_back(Vector3(directions[k % count]));
  }
  directions.resize(std::min(directions.size(), static_cast<std::size_t>(law.max_fibres)));
  return directions;
}

}  // namespace resilin::testing
