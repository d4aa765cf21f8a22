#pragma once

#include <string>
#include <string_view>

#include "resilin/world/scene_part.hpp"

namespace resilin {

/// The bytes of a part, to be sent to its process, and back.
std::string serialize(const ScenePart& part);
ScenePart deserialize_scene_part(std::string_view bytes);

}  // namespace resilin
