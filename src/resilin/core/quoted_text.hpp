#pragma once

#include <string>
#include <string_view>

namespace resilin {

/// In double quotes, its own quotes and backslashes escaped, as TOML and JSON read it. Control characters
/// stay: `one_line` takes them away.
inline std::string quoted_text(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

}  // namespace resilin
