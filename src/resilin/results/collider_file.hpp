#pragma once

#include <filesystem>

#include "resilin/io/vtu.hpp"
#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

/// The colliders of a run as files beside its frames, for ParaView and for pictures: colliders/NNNN.vtu with
/// the number of the frame; where none moves colliders/0000.vtu is that of all.
namespace resilin {

/// The name of a frame's file in the folder of a run.
std::string collider_file_name(const World& world, std::size_t frame);

/// Whether the world has a collider that can be drawn.
bool has_colliders(const World& world);

/// Triangles, lines and points with the number of the collider.
VtuContent collider_content(const World& world, const State& state);

/// Collider file beside the file of a frame, frames/NNNN.vtu, and what it holds; both empty without
/// colliders.
std::filesystem::path saved_collider_file(const std::filesystem::path& frame_file);
Mesh saved_colliders(const std::filesystem::path& frame_file);

/// Takes away those of frames from `end` on.
void remove_collider_files(const std::filesystem::path& folder, std::size_t end);

}  // namespace resilin
