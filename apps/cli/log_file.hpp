#pragma once

#include <filesystem>
#include <fstream>

#include "resilin/core/log.hpp"

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
  std::ofstream file_;
  LogSink sink_before_;
};

}  // namespace resilin::cli
