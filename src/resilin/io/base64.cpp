#include "resilin/io/base64.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace resilin {
namespace {

std::optional<unsigned> base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return static_cast<unsigned>(c - 'A');
  if (c >= 'a' && c <= 'z') return static_cast<unsigned>(c - 'a') + 26;
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0') + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return std::nullopt;
}

}  // namespace

std::string decode_base64(std::string_view text, std::size_t most) {
  std::string bytes;
  std::uint32_t group = 0;
  int num_digits = 0;
  int num_padding = 0;
  for (const char c : text) {
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    const auto digit = base64_digit(c);
    if (!digit && c != '=') break;
    if (c == '=') ++num_padding;
    group = group << 6 | digit.value_or(0);
    if (++num_digits < 4) continue;
    for (int i = 0; i < 3 - std::min(num_padding, 3); ++i)
      bytes += static_cast<char>(group >> (16 - 8 * i) & 0xff);
    if (bytes.size() >= most) break;
    group = 0;
    num_digits = num_padding = 0;
  }
  return bytes;
}

}  // namespace resilin
