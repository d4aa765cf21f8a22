#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "resilin/io/vtu.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// The frames of a run, frames/0000.vtu ..., in their order; none when there are none.
std::vector<std::filesystem::path> frame_files(const std::filesystem::path& folder);

/// Keeps the scene of a run in its folder as `scene.bin`, from which fields of the frames are computed when
/// somebody asks for them. A world whose description is not known takes away what an earlier run has left.
void save_scene(const std::filesystem::path& folder, const World& world);

/// The world of the run that has left this folder; null when there is no scene.bin.
/// @throws InputError  when there is one that cannot be used
std::shared_ptr<const World> saved_world(const std::filesystem::path& folder);

/// The same for the run that has left a file in its `frames`.
std::shared_ptr<const World> saved_world_of_frame(const std::filesystem::path& file);

/// The state whose frame this is: positions, velocities where time passes, time or load factor, and how
/// far colliders are behind.
/// @throws InputError  when `file` is not a frame of this world
State state_of_frame(const World& world, const VtuContent& frame, const std::filesystem::path& file);

}  // namespace resilin
