#include "resilin/io/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <fstream>
#include <locale>
#include <new>
#include <system_error>

#include "resilin/core/error.hpp"

namespace resilin {
namespace {

constexpr std::uintmax_t largest_file = std::uintmax_t{4} << 30;

std::string reason(int error_number) { return std::generic_category().message(error_number); }

/// A descriptor that closes itself.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags)
      : value_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int value() const { return value_; }
  bool is_open() const { return value_ >= 0; }

 private:
  int value_;
};

/// A new, empty file beside `path`; its name says what it is in case the machine stops now.
std::filesystem::path make_partial_file(const std::filesystem::path& path) {
  for (int attempt = 0;; ++attempt) {
    std::filesystem::path partial = path;
    partial += ".partial." + std::to_string(::getpid()) + "." + std::to_string(attempt);
    const Descriptor file(partial, O_WRONLY | O_CREAT | O_EXCL);
    if (file.is_open()) return partial;
    if (errno != EEXIST) throw FileError(path.string(), "cannot be written: " + reason(errno));
  }
}

void fill(const std::filesystem::path& partial, const std::filesystem::path& path,
          const std::function<void(std::ostream&)>& write) {
  std::ofstream stream;
  stream.imbue(std::locale::classic());
  stream.open(partial, std::ios::binary | std::ios::trunc);
  if (!stream) throw FileError(path.string(), "cannot be written: " + reason(errno));
  errno = 0;
  write(stream);
  stream.close();
  if (!stream)
    throw FileError(path.string(), "cannot be written: " + (errno != 0 ? reason(errno) : "disk full?"));
}

/// Asks the disk to hold the content before the name points to it.
void flush_to_disk(const std::filesystem::path& partial, const std::filesystem::path& path) {
  const Descriptor file(partial, O_RDONLY);
  // Some file systems do not know fsync (EINVAL); there the rename alone has to do.
  if (!file.is_open() || (::fsync(file.value()) != 0 && errno != EINVAL)) {
    throw FileError(path.string(), "cannot be written: " + reason(errno));
  }
}

}  // namespace

void write_atomically(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_directory(status))
    throw FileError(path.string(), "cannot be written: it is a folder");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    return fill(path, path, write);

  const std::filesystem::path target =
      std::filesystem::is_symlink(path, ignored) ? std::filesystem::weakly_canonical(path, ignored) : path;
  const std::filesystem::path partial = make_partial_file(target);
  try {
    fill(partial, path, write);
    flush_to_disk(partial, path);
    std::error_code failure;
    if (std::filesystem::exists(status)) std::filesystem::permissions(partial, status.permissions(), ignored);
    std::filesystem::rename(partial, target, failure);
    if (failure) throw FileError(path.string(), "cannot be written: " + failure.message());
  } catch (...) {
    std::filesystem::remove(partial, ignored);
    throw;
  }
  const Descriptor folder(target.has_parent_path() ? target.parent_path() : ".", O_RDONLY | O_DIRECTORY);
  if (folder.is_open()) ::fsync(folder.value());  // best effort: the file is whole with or without it
}

std::string read_file(const std::filesystem::path& path) {
  std::error_code failure;
  const auto status = std::filesystem::status(path, failure);
  if (!std::filesystem::exists(status)) {
    throw FileError(path.string(), failure && failure.value() != ENOENT
                                       ? "cannot be read: " + failure.message()
                                       : "no such file");
  }
  if (!std::filesystem::is_regular_file(status))
    throw FileError(path.string(), "cannot be read: not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (failure) throw FileError(path.string(), "cannot be read: " + failure.message());
  if (size > largest_file) throw FileError(path.string(), "cannot be read: larger than 4 GiB");
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw FileError(path.string(), "cannot be read: " + reason(errno));
  std::string bytes;
  try {
    bytes.resize(static_cast<std::size_t>(size));
  } catch (const std::bad_alloc&) {
    throw FileError(path.string(), "cannot be read: it does not fit into memory");
  }
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (stream.bad()) throw FileError(path.string(), "cannot be read: " + reason(errno));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

}  // namespace resilin
