#pragma once

#include <string>
#include <string_view>

namespace resilin {

/// A cell of a CSV file: in quotes where its commas, quotes, line ends or outer spaces ask for them (RFC
/// 4180).
inline std::string csv_cell(std::string_view text) {
  const bool has_outer_space = !text.empty() && (text.front() == ' ' || text.back() == ' ');
  if (!has_outer_space && text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string cell = "\"";
  for (const char c : text) cell.append(c == '"' ? 2 : 1, c);
  return cell + '"';
}

}  // namespace resilin
