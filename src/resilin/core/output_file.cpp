#include "resilin/core/output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <locale>
#include <ostream>
#include <streambuf>
#include <system_error>
#include <vector>

#include "resilin/core/error.hpp"

namespace resilin {

std::string reason_of_failed_write(int error_number) {
  switch (error_number) {
    case ENOSPC:
      return "the disk is full";
    case EDQUOT:
      return "the quota of the disk is used up";
    case EFBIG:
      return "it would be larger than this process may write (ulimit -f)";
    default:
      return std::generic_category().message(error_number);
  }
}

/// Bytes on their way into a file; remembers the first error of the system.
class OutputFile::Buffer : public std::streambuf {
 public:
  Buffer(const std::filesystem::path& path, Mode mode) : bytes_(std::size_t{1} << 16) {
    const int start = mode == Mode::truncate ? O_TRUNC : O_APPEND;
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | start, 0666);
    if (descriptor_ < 0) error_ = errno;
    setp(bytes_.data(), bytes_.data() + bytes_.size());
  }
  ~Buffer() override { close(); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  int error() const { return error_; }

  void close() {
    if (descriptor_ < 0) return;
    sync();
    if (::close(descriptor_) != 0 && error_ == 0 && errno != EINTR) error_ = errno;
    descriptor_ = -1;
  }

 protected:
  int_type overflow(int_type c) override {
    if (sync() != 0) return traits_type::eof();
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    return sputc(traits_type::to_char_type(c));
  }

  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    if (count < epptr() - pptr()) return std::streambuf::xsputn(bytes, count);
    return sync() == 0 && write(bytes, count) ? count : 0;
  }

  int sync() override {
    const bool is_written = write(pbase(), pptr() - pbase());
    setp(bytes_.data(), bytes_.data() + bytes_.size());
    return is_written ? 0 : -1;
  }

 private:
  /// All of them; nothing more once that has failed, so that no hole is left in the middle.
  bool write(const char* bytes, std::streamsize count) {
    while (count > 0 && error_ == 0) {
      const ssize_t written = ::write(descriptor_, bytes, static_cast<std::size_t>(count));
      if (written > 0) {
        bytes += written;
        count -= written;
      } else if (written == 0) {
        error_ = ENOSPC;  // a device that takes nothing and says no reason
      } else if (errno != EINTR) {
        error_ = errno;
      }
    }
    return error_ == 0;
  }

  std::vector<char> bytes_;
  int descriptor_ = -1;
  int error_ = 0;
};

OutputFile::OutputFile(const std::filesystem::path& path, Mode mode, const std::filesystem::path& named)
    : named_(named.empty() ? path : named), buffer_(std::make_unique<Buffer>(path, mode)) {
  if (buffer_->error() != 0)
    throw FileError(named_.string(), "cannot be written: " + reason_of_failed_write(buffer_->error()));
  stream_ = std::make_unique<std::ostream>(buffer_.get());
  stream_->imbue(std::locale::classic());
}

OutputFile::~OutputFile() = default;

std::ostream& OutputFile::stream() { return *stream_; }

void OutputFile::close() {
  buffer_->close();
  if (buffer_->error() != 0)
    throw FileError(named_.string(), "cannot be written: " + reason_of_failed_write(buffer_->error()));
  if (!*stream_) throw FileError(named_.string(), "cannot be written: its contents are incomplete");
}

}  // namespace resilin
