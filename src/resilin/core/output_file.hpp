#pragma once

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <string>

namespace resilin {

/// Why the system refuses to write, in words, from its error number: "the disk is full", "Permission denied".
std::string reason_of_failed_write(int error_number);

/// A file that is written through a stream and says why it cannot be: streams of the library forget the
/// reason.
///
/// The stream is binary and independent of the locale. Without `close` the file is closed all the same, and
/// what was wrong goes unsaid.
class OutputFile {
 public:
  enum class Mode { truncate, append };

  /// @param named  the path in messages, where it is another one than the file's
  /// @throws FileError  "PATH: cannot be written: REASON"
  OutputFile(const std::filesystem::path& path, Mode mode, const std::filesystem::path& named = {});
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& stream();

  /// @throws FileError when anything that went into the stream has not been written
  void close();

 private:
  class Buffer;
  std::filesystem::path named_;
  std::unique_ptr<Buffer> buffer_;
  std::unique_ptr<std::ostream> stream_;
};

}  // namespace resilin
