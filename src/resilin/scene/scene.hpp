#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/scene/value.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

class MeshCache;

/// How a scene is read.
struct SceneOptions {
  std::vector<std::string> overrides;      ///< "KEY=VALUE" each, as after --set
  std::int64_t max_box_cells = 100000000;  ///< a box of more cells than this is taken for a slip
  MeshCache* meshes = nullptr;             ///< where mesh files have been read for other scenes; may be null
  bool is_for_real_time = false;  ///< surfaces get a lattice where the scene does not choose a mesher
};

/// A scene that has been read and checked.
struct Scene {
  Description description;
  std::vector<std::string> warnings;  ///< one line each: what is odd but not wrong
};

/// Reads a scene file with its meshes and tables.
///
/// Every key is known, has the right type, length and range, and every name that is referred to exists; a
/// key of a later version is refused. docs/scene.md lists the keys.
///
/// @throws InputError  "FILE:LINE: KEY: expected ..., got ...; CURE", one line
Scene read_scene(const std::filesystem::path& path, const SceneOptions& options = {});

/// The same from memory. `name` begins the messages; relative paths start at `folder`.
Scene read_scene_from_text(std::string_view text, const std::string& name,
                           const std::filesystem::path& folder, const SceneOptions& options = {});

/// The same from values that came from elsewhere, such as a dictionary.
Scene read_scene_from_values(SceneValue scene, const std::string& name, const std::filesystem::path& folder,
                             const SceneOptions& options = {});

/// The page docs/scene.md: every key, its type, unit, default and meaning, from the table that the reader
/// uses.
std::string scene_reference();

/// The same keys as a JSON schema (draft 2020-12) of the scene, for editors that complete and check TOML. It
/// refuses nothing that the reader takes; what depends on other keys is left to the reader.
std::string scene_schema();

}  // namespace resilin
