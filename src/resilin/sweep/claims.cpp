#include "resilin/sweep/claims.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "resilin/core/error.hpp"
#include "resilin/core/log.hpp"
#include "resilin/core/output_file.hpp"

namespace resilin {
namespace {

/// The byte of the whole folder lies behind those of scenes.
constexpr std::int64_t whole_folder = std::int64_t{1} << 62;

std::int64_t byte_of(const SceneHash& scene) { return static_cast<std::int64_t>(scene.high >> 2); }

}  // namespace

Claims::Claims(const std::filesystem::path& file)
    : descriptor_(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw FileError(file.string(), "cannot be written: " + reason_of_failed_write(errno));
}

Claims::~Claims() { ::close(descriptor_); }

bool Claims::lock(short kind, std::int64_t place, bool waits) {
  if (!has_locks_) return true;
  struct flock part = {};
  part.l_type = kind;
  part.l_whence = SEEK_SET;
  part.l_start = place;
  part.l_len = 1;
  while (::fcntl(descriptor_, waits ? F_OFD_SETLKW : F_OFD_SETLK, &part) != 0) {
    if (errno == EINTR) continue;
    if (errno == EAGAIN || errno == EACCES) return false;
    has_locks_ = false;
    log_warning("this file system has no locks (" + reason_of_failed_write(errno) +
                "): two processes may run the same scene and write its row twice; give each its --shard");
    return true;
  }
  return true;
}

bool Claims::claim(const SceneHash& scene) { return lock(F_WRLCK, byte_of(scene), false); }

void Claims::release(const SceneHash& scene) { lock(F_UNLCK, byte_of(scene), false); }

Claims::Whole::Whole(Claims& claims) : claims_(claims) { claims_.lock(F_WRLCK, whole_folder, true); }

Claims::Whole::~Whole() { claims_.lock(F_UNLCK, whole_folder, false); }

}  // namespace resilin
