#pragma once

#include <nlohmann/json_fwd.hpp>

#include "resilin/scene/value.hpp"

namespace resilin {

/// A value of a scene as JSON; long arrays and meshes by their hash.
nlohmann::ordered_json value_json(const SceneValue& value);

}  // namespace resilin
