#pragma once

#include <algorithm>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/material/law.hpp"

namespace resilin::testing {

/// As many of these families of fibres as a law can have; none for an isotropic one.
inline std::vector<Vector3> fibres_for(const LawInfo& law, std::vector<Vector3> directions) {
  directions.resize(std::min(directions.size(), static_cast<std::size_t>(law.max_fibres)));
  return directions;
}

}  // namespace resilin::testing
