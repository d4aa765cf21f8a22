#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace resilin {

/// Severity of a message.
enum class LogLevel { debug, info, warning };

/// Receives every message of the library. The default sink drops them: the library itself never prints.
using LogSink = std::function<void(LogLevel, std::string_view)>;

/// Replaces the sink and returns the one before it. Sinks may be called from any thread, one at a time.
LogSink set_log_sink(LogSink sink);

/// Hand one line to the sink.
void log_debug(std::string_view message);
void log_info(std::string_view message);
void log_warning(std::string_view message);

}  // namespace resilin
