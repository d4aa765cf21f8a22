#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "resilin/sweep/scene_row.hpp"

namespace resilin {

/// Runs one scene of a sweep. What is wrong about it is in its row, and so is memory that ran out.
///
/// @param folder      of the sweep, for results that are kept; each is written beside and renamed, so that it
///                    is there whole or not at all. Empty: none are kept
/// @param is_stopped  asked after every Newton iteration; may be empty
/// @return  nothing when it was stopped
/// @throws FileError  when results cannot be written, which is no fault of the scene;
///         InputError when the scene's files changed while it ran
std::optional<SceneRow> run_scene(const Sweep& sweep, std::uint64_t scene,
                                  const std::filesystem::path& folder = {},
                                  const std::function<bool()>& is_stopped = {});

}  // namespace resilin
