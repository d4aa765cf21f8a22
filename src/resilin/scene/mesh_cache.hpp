#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>

#include "resilin/io/mesh_file.hpp"

namespace resilin {

/// Mesh files that have been read, for scenes that share them. Several threads may ask at once.
///
/// A file that has changed since (size or time of the last change) is read again. Holds the meshes asked for
/// last, so that a million scenes of as many meshes take no more memory than a few.
class MeshCache {
 public:
  static constexpr std::size_t most_files = 16;

  /// @throws InputError, FileError  as read_mesh
  std::shared_ptr<const MeshFile> read(const std::filesystem::path& path);

 private:
  struct Entry {
    std::filesystem::path path;
    std::uintmax_t size;
    std::filesystem::file_time_type changed;
    std::shared_ptr<const MeshFile> mesh;
  };

  std::mutex mutex_;
  std::list<Entry> entries_;  ///< asked for last: first
};

}  // namespace resilin
