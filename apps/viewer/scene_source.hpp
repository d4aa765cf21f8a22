#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "resilin/scene/value.hpp"
#include "served_live_scene.hpp"

/// Where the scenes come from that `resilin view` shows, and how they are written when a page saves them.
namespace resilin::viewer {

/// A file that a page has sent.
struct SentFile {
  std::string name;  ///< harmless: see harmless_name
  std::string bytes;
};

/// The last part of a path, without what could mean another place or a command: letters, digits, '.', '-' and
/// '_' (and UTF-8 beyond ASCII), at most 100 bytes, no point at its beginning.
std::string harmless_name(std::string_view path);

struct SceneSource {
  std::function<SceneValue()> load;  ///< the scene's values, anew at each reload
  std::string name;                  ///< begins messages
  std::filesystem::path folder;      ///< folder of relative paths, and of what is saved
  std::string stem;                  ///< stem of the file that is saved
  bool is_bare_mesh = false;         ///< it was no scene: what is saved is at rest where something is held
  std::shared_ptr<const SentFile> sent{};  ///< the mesh, which no disk has
};

SceneSource scene_file(const std::filesystem::path& path, std::vector<std::string> overrides);

/// A mesh or a surface alone: soft, weightless, held by nothing.
SceneSource mesh_file(const std::filesystem::path& path, std::vector<std::string> overrides);

/// The same of a mesh that a page has sent; saved in `folder`, with the mesh beside it.
SceneSource sent_mesh(SentFile file, const std::filesystem::path& folder);

/// The scene to play with. @throws InputError
std::unique_ptr<ServedLiveScene> served_scene(const SceneSource& source);

}  // namespace resilin::viewer
