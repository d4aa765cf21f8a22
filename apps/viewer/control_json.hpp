#pragma once

#include <nlohmann/json_fwd.hpp>

#include "resilin/live/control_table.hpp"

/// The table of controls as the page reads it: docs/view_protocol.md, "Controls".
namespace resilin::viewer {

/// @param initial  the controls that the scene begins with
/// @param extent   of the scene [m]
nlohmann::json control_entries(const LiveControls& initial, double extent);

/// The value of each control, by its key.
nlohmann::json control_values(const LiveControls& controls);

}  // namespace resilin::viewer
