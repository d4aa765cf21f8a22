#include "log_file.hpp"

#include <ostream>
#include <string>

#include "resilin/core/text.hpp"

namespace resilin::cli {
namespace {

const char* word(LogLevel level) {
  switch (level) {
    case LogLevel::debug:
      return "debug";
    case LogLevel::info:
      return "info";
    case LogLevel::warning:
      return "warning";
  }
  return "";
}

}  // namespace

LogFile::LogFile(const std::filesystem::path& path, bool append)
    : file_(path, append ? OutputFile::Mode::append : OutputFile::Mode::truncate) {
  sink_before_ = set_log_sink([this](LogLevel level, std::string_view message) {
    file_.stream() << local_time() << ' ' << word(level) << ": " << message << '\n' << std::flush;
  });
}

LogFile::~LogFile() { set_log_sink(std::move(sink_before_)); }

}  // namespace resilin::cli
