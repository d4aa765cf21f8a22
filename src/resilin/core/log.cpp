#include "resilin/core/log.hpp"

#include <mutex>
#include <utility>

#include "resilin/core/text.hpp"

namespace resilin {
namespace {

std::mutex& sink_mutex() {
  static std::mutex mutex;
  return mutex;
}

LogSink& current_sink() {
  static LogSink sink;
  return sink;
}

void log(LogLevel level, std::string_view message) {
  const std::lock_guard lock(sink_mutex());
  if (current_sink()) current_sink()(level, one_line(message));
}

}  // namespace

LogSink set_log_sink(LogSink sink) {
  const std::lock_guard lock(sink_mutex());
  return std::exchange(current_sink(), std::move(sink));
}

void log_debug(std::string_view message) { log(LogLevel::debug, message); }
void log_info(std::string_view message) { log(LogLevel::info, message); }
void log_warning(std::string_view message) { log(LogLevel::warning, message); }

}  // namespace resilin
