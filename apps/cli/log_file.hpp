#pragma once

#include <filesystem>

#include "resilin/core/log.hpp"
#include "resilin/core/output_file.hpp"

namespace resilin::cli {

/// Every message of the library goes into a file, with the time, as long as this lives.
class LogFile {
 public:
  /// Throws FileError when the file cannot be opened.
  LogFile(const std::filesystem::path& path, bool append);
  ~LogFile();
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;

 private:
  OutputFile file_;
  LogSink sink_before_;
};

}  // namespace resilin::cli
