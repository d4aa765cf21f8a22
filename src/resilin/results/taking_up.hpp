#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "resilin/world/state.hpp"
#include "resilin/world/world.hpp"

/// Recorded runs that somebody goes on with by hand, from any of their frames.
namespace resilin {

/// The recording and the report of a run, by which a page shows it.
struct RecordedFiles {
  std::filesystem::path recording, report;

  /// @throws InputError  when the folder lacks one of them, or the report is none
  explicit RecordedFiles(const std::filesystem::path& folder);
};

/// The scene of a run of which every frame can be gone on from.
/// @throws InputError  when the folder holds no recording or no scene, or shapes of vibrations, which are no
/// states
std::shared_ptr<const World> world_to_take_up(const std::filesystem::path& folder);

/// The state of a frame with this number of the report, from which a scene goes on as it stood there.
/// @throws InputError  when the folder has no such frame of this world
State state_to_take_up(const std::filesystem::path& folder, const World& world, std::size_t number);

/// One page with the recording of a folder, the scene, what simulates it and the states of all frames: it
/// plays, and is taken up by hand where it stands (docs/view_protocol.md, "Addresses").
///
/// @param engine  the WebAssembly module of the preset wasm (apps/play)
/// @param world   of `world_to_take_up`
/// @param notes   what is played otherwise than it was recorded, one line each
/// @throws InputError  when a frame is missing, or when all would be too much for a page
std::string recorded_page_to_take_up(std::string_view engine, const std::filesystem::path& folder,
                                     const World& world, std::span<const std::string> notes);

}  // namespace resilin
