#pragma once

#include "bindings.hpp"
#include "resilin/scene/value.hpp"

namespace resilin::python {

/// A scene out of dicts, lists, texts, numbers, float64 arrays (rows, columns) and meshes.
SceneValue scene_value(nb::handle object);

}  // namespace resilin::python
