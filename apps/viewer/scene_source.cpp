#include "scene_source.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "bare_mesh.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/quoted_text.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/scene/scene.hpp"
#include "scene_changes.hpp"

namespace resilin::viewer {
namespace {

/// A scene around the mesh of the one body, soft, weightless, held by nothing.
SceneValue bare_scene(const std::string& title, int dimension, SceneValue mesh,
                      const std::vector<std::string>& overrides) {
  SceneValue scene =
      parse_toml("title = " + quoted_text(one_line(title)) +
                     "\n[simulation]\nkind = \"dynamic\"\ndimension = " + std::to_string(dimension) +
                     "\ntime_step = 0.0166667\nend_time = 1\n[[body]]\nname = "
                     "\"body\"\ndamping = { mass = 2 }\n",
                 title);
  scene.find("body")->array()[0].table().push_back({"mesh", std::move(mesh)});
  for (const std::string& assignment : overrides) apply_override(scene, assignment);
  return scene;
}

SceneValue text_value(const std::string& text) {
  SceneValue value;
  value.data = text;
  return value;
}

std::shared_ptr<const MeshFile> mesh_of(const SentFile& sent) {
  return std::make_shared<const MeshFile>(
      read_mesh_from_memory(sent.name, sent.bytes, [&sent](const std::string& name) -> std::string {
        throw InputError(sent.name, "a mesh in one file", "one that needs " + one_line(name) + " beside it",
                         "`resilin view " + sent.name + "` finds it beside");
      }));
}

/// Calls `write(path)` with "STEM.EXT", "STEM-2.EXT", ... until it says that the file was not there.
template <class Write>
std::filesystem::path write_under_new_name(const std::filesystem::path& folder, const std::string& stem,
                                           const std::string& extension, const Write& write) {
  constexpr int most = 1000;
  for (int number = 1; number < most; ++number) {
    std::string name = stem;
    if (number > 1) name += "-" + std::to_string(number);
    const std::filesystem::path path = folder / (name += extension);
    if (write(path)) return path;
  }
  throw FileError((folder / (stem + extension)).string(),
                  "exists already, and so do all names up to -" + std::to_string(most - 1));
}

/// Writes a file that is not there yet, or holds the same.
bool write_or_find(const std::filesystem::path& path, const std::string& bytes) {
  if (write_new_file(path, bytes)) return true;
  std::error_code failure;
  return std::filesystem::is_regular_file(path, failure) &&
         std::filesystem::file_size(path, failure) == bytes.size() && read_file(path) == bytes;
}

/// A scene at rest, which needs no time; in motion it would only tremble.
void come_to_rest(SceneValue& scene) {
  set_value(scene, "simulation.kind", text_value("static"), "save");
  std::erase_if(scene.find("simulation")->table(), [](const SceneMember& member) {
    return member.key == "time_step" || member.key == "end_time";
  });
  std::erase_if(scene.find("body")->array()[0].table(),
                [](const SceneMember& member) { return member.key == "damping"; });
}

std::string save(const SceneSource& source, SceneValue scene, const SceneChanges& changes) {
  apply_changes(scene, changes);
  if (source.is_bare_mesh) write_material(scene, changes, /*writes_all=*/true);
  if (source.is_bare_mesh && !changes.held.empty()) come_to_rest(scene);
  read_scene_from_values(scene, source.stem + ".toml", source.folder);  // before anything is written
  if (source.sent) {
    const std::filesystem::path name = source.sent->name;
    const std::filesystem::path mesh =
        write_under_new_name(source.folder, name.stem().string(), name.extension().string(),
                             [&](const auto& path) { return write_or_find(path, source.sent->bytes); });
    scene.find("body")->array()[0].find("mesh")->data = mesh.filename().string();
  }
  const std::string text =
      "# " + one_line(source.name) + " as it was on its page. All keys: docs/scene.md\n" + toml_text(scene);
  const std::filesystem::path path = write_under_new_name(
      source.folder, source.stem, ".toml", [&text](const auto& p) { return write_new_file(p, text); });
  const std::string shown = one_line(path.lexically_normal().string());
  const std::size_t count = changes.held.size();
  const std::string what =
      count == 0 ? "" : " with " + std::to_string(count) + " fixed face" + (count > 1 ? "s" : "");
  return "Saved" + what + ". Next: resilin run " + shown;
}

}  // namespace

std::string harmless_name(std::string_view path) {
  constexpr std::size_t longest = 100;
  constexpr std::string_view harmless = ".-_";
  path.remove_prefix(std::min(path.find_last_of("/\\") + 1, path.size()));
  std::string name;
  for (const char c : one_line(path)) {
    const auto code = static_cast<unsigned char>(c);
    const bool is_plain = code >= 0x80 || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || harmless.find(c) != std::string_view::npos;
    name += is_plain ? c : '_';
  }
  if (name.size() > longest) name.erase(0, name.size() - longest);  // the ending stays
  while (!name.empty() &&
         (name[0] == '.' || name[0] == '-' || (static_cast<unsigned char>(name[0]) & 0xc0) == 0x80))
    name.erase(0, 1);
  return name.empty() ? "mesh" : name;
}

SceneSource scene_file(const std::filesystem::path& path, std::vector<std::string> overrides) {
  return {.load =
              [path, overrides = std::move(overrides)] {
                SceneValue scene = parse_toml(read_file(path), path.string());
                for (const std::string& assignment : overrides) apply_override(scene, assignment);
                return scene;
              },
          .name = path.string(),
          .folder = path.parent_path(),
          .stem = path.stem().string()};
}

SceneSource mesh_file(const std::filesystem::path& path, std::vector<std::string> overrides) {
  const std::filesystem::path absolute = std::filesystem::absolute(path);
  return {.load =
              [path, overrides = std::move(overrides)] {
                const std::string name = path.filename().string();
                return bare_scene(name, dimension_of(read_mesh(path)), text_value(name), overrides);
              },
          .name = one_line(path.string()),
          .folder = absolute.parent_path(),
          .stem = absolute.stem().string(),
          .is_bare_mesh = true};
}

SceneSource sent_mesh(SentFile file, const std::filesystem::path& folder) {
  const auto sent = std::make_shared<const SentFile>(std::move(file));
  return {.load =
              [sent] {
                const auto mesh = mesh_of(*sent);
                SceneValue value;
                value.data = mesh;
                return bare_scene(sent->name, dimension_of(*mesh), std::move(value), {});
              },
          .name = sent->name,
          .folder = folder,
          .stem = std::filesystem::path(sent->name).stem().string(),
          .is_bare_mesh = true,
          .sent = sent};
}

std::unique_ptr<ServedLiveScene> served_scene(const SceneSource& source) {
  const auto values = std::make_shared<SceneValue>();  // as they were read last
  return std::make_unique<ServedLiveScene>(
      [source, values] {
        *values = source.load();
        SceneOptions options;
        options.is_for_real_time = true;
        return read_scene_from_values(*values, source.name, source.folder, options);
      },
      [source, values](const SceneChanges& changes) { return save(source, *values, changes); });
}

}  // namespace resilin::viewer
