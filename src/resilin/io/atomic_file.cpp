#include "resilin/io/atomic_file.hpp"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <new>
#include <ostream>
#include <string_view>
#include <system_error>

#include "resilin/core/error.hpp"
#include "resilin/core/output_file.hpp"

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

/// The process that made a partial file beside `path`, from the file's name; 0 for any other name.
pid_t maker_of(std::string_view file, const std::filesystem::path& path) {
  const std::string start = path.filename().string() + std::string(partial_ending) + ".";
  if (!file.starts_with(start)) return 0;
  file.remove_prefix(start.size());
  pid_t process = 0;
  int attempt = 0;
  const char* end = file.data() + file.size();
  const auto first = std::from_chars(file.data(), end, process);
  if (first.ec != std::errc{} || first.ptr == end || *first.ptr != '.') return 0;
  const auto second = std::from_chars(first.ptr + 1, end, attempt);
  return second.ec == std::errc{} && second.ptr == end ? process : 0;
}

/// Removes the files of a folder whose names `is_left` says are left over.
template <class IsLeft>
void sweep(const std::filesystem::path& folder, const IsLeft& is_left) {
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (is_left(entry->path().filename().string()) && entry->is_regular_file(ignored))
      std::filesystem::remove(entry->path(), ignored);
  }
}

/// Removes what processes that are gone have left half-written beside `path`.
void remove_abandoned_files(const std::filesystem::path& path) {
  sweep(path.has_parent_path() ? path.parent_path() : ".", [&path](const std::string& name) {
    const pid_t process = maker_of(name, path);
    return process > 0 && process != ::getpid() && ::kill(process, 0) != 0 && errno == ESRCH;
  });
}

/// A new, empty file beside `path`; its name says what it is in case the machine stops now.
std::filesystem::path make_partial_file(const std::filesystem::path& path) {
  remove_abandoned_files(path);
  for (int attempt = 0;; ++attempt) {
    std::filesystem::path partial = path;
    partial += std::string(partial_ending) + "." + std::to_string(::getpid()) + "." + std::to_string(attempt);
    const Descriptor file(partial, O_WRONLY | O_CREAT | O_EXCL);
    if (file.is_open()) return partial;
    if (errno != EEXIST)
      throw FileError(path.string(), "cannot be written: " + reason_of_failed_write(errno));
  }
}

void fill(const std::filesystem::path& partial, const std::filesystem::path& path,
          const std::function<void(std::ostream&)>& write) {
  OutputFile file(partial, OutputFile::Mode::truncate, path);
  write(file.stream());
  file.close();
}

/// Asks the disk to hold the content before the name points to it.
void flush_to_disk(const std::filesystem::path& partial, const std::filesystem::path& path) {
  const Descriptor file(partial, O_RDONLY);
  // Some file systems do not know fsync (EINVAL); there the rename alone has to do.
  if (!file.is_open() || (::fsync(file.value()) != 0 && errno != EINVAL)) {
    throw FileError(path.string(), "cannot be written: " + reason_of_failed_write(errno));
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
    if (failure)
      throw FileError(path.string(), "cannot be written: " + reason_of_failed_write(failure.value()));
  } catch (...) {
    std::filesystem::remove(partial, ignored);
    throw;
  }
  const Descriptor folder(target.has_parent_path() ? target.parent_path() : ".", O_RDONLY | O_DIRECTORY);
  if (folder.is_open()) ::fsync(folder.value());  // best effort: the file is whole with or without it
}

void remove_partial_files(const std::filesystem::path& folder) {
  sweep(folder, [](const std::string& name) {
    const std::size_t at = name.rfind(partial_ending);
    return at != name.npos && name.find_first_not_of("0123456789.", at + partial_ending.size()) == name.npos;
  });
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

bool write_new_file(const std::filesystem::path& path, std::string_view bytes) {
  if (const Descriptor file(path, O_WRONLY | O_CREAT | O_EXCL); !file.is_open()) {
    if (errno == EEXIST) return false;
    throw FileError(path.string(), "cannot be written: " + reason_of_failed_write(errno));
  }
  try {
    fill(path, path, [bytes](std::ostream& stream) { stream << bytes; });
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    throw;
  }
  return true;
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  write_atomically(path, [&text](std::ostream& stream) { stream << text; });
}

}  // namespace resilin
