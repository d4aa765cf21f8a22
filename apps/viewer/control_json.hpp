#pragma once

#include <nlohmann/json_fwd.hpp>

#include <span>

#include "resilin/live/control_table.hpp"
#include "resilin/live/drive.hpp"

/// The table of controls as the page reads it: docs/view_protocol.md, "Controls".
namespace resilin::viewer {

/// @param initial      the controls that the scene begins with
/// @param extent       of the scene [m]
/// @param has_contact  whether bodies meet in it
nlohmann::json control_entries(const LiveControls& initial, double extent, bool has_contact);

/// Sliders of motors and cables, in the same form.
nlohmann::json drive_entries(std::span<const Drive> drives);
/// Where each of these sliders stands: where it was set, else where the scene has it.
nlohmann::json drive_values(std::span<const Drive> drives);

/// The value of each of these controls, by its key.
nlohmann::json control_values(const LiveControls& controls, bool has_contact);

/// Likewise of those that each body has of its own.
nlohmann::json body_values(const LiveControls& controls);

}  // namespace resilin::viewer
