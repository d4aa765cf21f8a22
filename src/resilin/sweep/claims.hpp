#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>

#include "resilin/sweep/scene_hash.hpp"

namespace resilin {

/// Scenes of a shared folder that this process runs, so that no other one runs them.
///
/// A claim is a lock of the system on one byte of a file (fcntl with F_OFD_SETLK): it ends with the process,
/// however the process ends, and holds between machines where the file system has locks.
class Claims {
 public:
  explicit Claims(const std::filesystem::path& file);
  ~Claims();
  Claims(const Claims&) = delete;
  Claims& operator=(const Claims&) = delete;

  /// False when another process has it. Where there are no locks all is claimed, with a warning in the log.
  bool claim(const SceneHash& scene);
  void release(const SceneHash& scene);

  /// Keeps other processes out of what concerns the whole folder; waits for them.
  class Whole {
   public:
    explicit Whole(Claims& claims);
    ~Whole();
    Whole(const Whole&) = delete;
    Whole& operator=(const Whole&) = delete;

   private:
    Claims& claims_;
  };

 private:
  bool lock(short kind, std::int64_t place, bool waits);

  int descriptor_ = -1;
  std::atomic<bool> has_locks_ = true;
};

}  // namespace resilin
