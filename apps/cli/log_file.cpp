#include "log_file.hpp"

#include <ctime>
#include <ostream>
#include <string>

namespace resilin::cli {
namespace {

std::string time_of_day() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[32];
  const std::size_t length = std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &local);
  return {text, length};
}

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
    file_.stream() << time_of_day() << ' ' << word(level) << ": " << message << std::endl;
  });
}

LogFile::~LogFile() { set_log_sink(std::move(sink_before_)); }

}  // namespace resilin::cli
