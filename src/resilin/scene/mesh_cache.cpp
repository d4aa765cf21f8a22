#include "resilin/scene/mesh_cache.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

namespace resilin {

std::shared_ptr<const MeshFile> MeshCache::read(const std::filesystem::path& path) {
  std::error_code failure, other_failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  const auto changed = std::filesystem::last_write_time(path, other_failure);
  if (failure || other_failure) return std::make_shared<const MeshFile>(read_mesh(path));  // it says why
  {
    const std::lock_guard lock(mutex_);
    const auto entry = std::ranges::find(entries_, path, &Entry::path);
    if (entry != entries_.end() && entry->size == size && entry->changed == changed) {
      entries_.splice(entries_.begin(), entries_, entry);
      return entry->mesh;
    }
  }
  auto mesh = std::make_shared<const MeshFile>(read_mesh(path));  // two threads may read the same: no harm
  const std::lock_guard lock(mutex_);
  entries_.remove_if([&path](const Entry& entry) { return entry.path == path; });
  entries_.push_front({path, size, changed, mesh});
  if (entries_.size() > most_files) entries_.pop_back();
  return mesh;
}

}  // namespace resilin
