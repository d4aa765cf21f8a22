#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "resilin/scene/value.hpp"

namespace resilin {

/// Key of a scene of a sweep: 128 bits of all that its results follow from.
struct SceneHash {
  std::uint64_t high = 0, low = 0;

  auto operator<=>(const SceneHash&) const = default;
  std::string text() const;  ///< 32 digits
  static std::optional<SceneHash> from_text(std::string_view text);
};
SceneHash scene_hash_of(std::string_view bytes);

/// Sixteen digits.
std::string hash_text(std::uint64_t hash);

/// Hashes of the files and meshes that scenes refer to, of each once. Several threads may ask at once.
class FileHashes {
 public:
  /// @param folder  that relative names start at
  explicit FileHashes(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Hash of the file that a text names, and of the one beside it where a format has two; nothing when
  /// there is no such file. A file whose size or time of change is another than before is read again.
  std::optional<std::uint64_t> of_file(const std::string& name);
  std::uint64_t of_mesh(const SceneValue::MeshHandle& mesh);

 private:
  struct Entry {
    std::uintmax_t size;
    std::filesystem::file_time_type changed;
    std::uint64_t hash;
  };
  static constexpr std::size_t most_entries = 4096;  // a million files take no more memory than these

  std::filesystem::path folder_;
  std::mutex mutex_;
  std::map<std::string, Entry> files_;
  std::map<SceneValue::MeshHandle, std::uint64_t> meshes_;
};

/// A value as text in which everything counts that a scene could read of it: the type of a number, its exact
/// value, the content of files and meshes; not the order of keys, nor where it stands in a file.
std::string canonical_text(const SceneValue& value, FileHashes& files);

/// A value for people and for tables: 0.5, "text", [1, 2], { a = 1 }; of files, meshes and long arrays the
/// hash.
std::string shown_value(const SceneValue& value, FileHashes& files);

}  // namespace resilin
