#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/energy/energy.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

/// A load that somebody has put on a face of a body while the scene runs.
struct FaceLoad {
  int number = 0;                      ///< from 1 on, each once
  std::size_t body = 0;                ///< in World::bodies
  LoadDescription description{};       ///< as a scene file has it
  std::shared_ptr<const Energy> term;  ///< term of the scene's energy
};

/// How strong it is, in the words of a user.
struct FaceLoadChoice {
  enum class Kind { force, pressure };
  Kind kind = Kind::force;
  double value = 0;  ///< total force against the mean normal [N], in 2D [N/m], or follower pressure [Pa]
};

}  // namespace resilin
