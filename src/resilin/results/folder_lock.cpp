#include "resilin/results/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>

#include "resilin/core/error.hpp"
#include "resilin/core/log.hpp"
#include "resilin/core/output_file.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

constexpr const char* lock_name = "run.lock";

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "this machine";
}

/// "process 1234 on host since 2025-01-31 12:00:00"
std::string own_words() {
  return "process " + std::to_string(::getpid()) + " on " + host_name() + " since " + local_time();
}

/// Words of the file about its holder; empty when it has none.
std::string words_in(int descriptor) {
  std::array<char, 400> text{};
  const ssize_t size = ::pread(descriptor, text.data(), text.size(), 0);
  std::string words(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  words.resize(std::min(words.find('\n'), words.size()));
  for (char& c : words)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return words;
}

/// Whether the path still leads to the open file: its last holder may have removed it in between.
bool is_at(int descriptor, const std::filesystem::path& path) {
  struct stat open_file = {};
  struct stat named_file = {};
  return ::fstat(descriptor, &open_file) == 0 && ::lstat(path.c_str(), &named_file) == 0 &&
         open_file.st_dev == named_file.st_dev && open_file.st_ino == named_file.st_ino;
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) : path_(folder / lock_name) {
  while (true) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (descriptor_ < 0)
      throw FileError(path_.string(), "cannot be written: " + reason_of_failed_write(errno));
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) {
      if (is_at(descriptor_, path_)) break;
      ::close(descriptor_);
      continue;
    }
    const int error = errno;
    if (error == EINTR) {
      ::close(descriptor_);
      continue;
    }
    if (error != EWOULDBLOCK) {
      ::close(descriptor_);
      descriptor_ = -1;
      log_warning(path_.string() + ": this file system has no locks (" + reason_of_failed_write(error) +
                  "); a second run into the folder would not be noticed");
      return;
    }
    const std::string holder = words_in(descriptor_);
    ::close(descriptor_);
    throw FileError(folder.string(), "a folder that no other run writes into",
                    "one that " + (holder.empty() ? "another process" : holder) + " writes into",
                    "wait until it ends, or choose another folder (--out)");
  }
  previous_holder_ = words_in(descriptor_);
  const std::string words = own_words() + "\n";
  // A fact that cannot be found here is missing from a message at worst; a failed write shows at once
  // elsewhere.
  if (::ftruncate(descriptor_, 0) == 0)
    static_cast<void>(::pwrite(descriptor_, words.data(), words.size(), 0) == 0);
}

FolderLock::~FolderLock() {
  if (descriptor_ < 0) return;
  ::unlink(path_.c_str());
  ::close(descriptor_);
}

}  // namespace resilin
