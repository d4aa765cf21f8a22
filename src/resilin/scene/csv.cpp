#include "resilin/scene/csv.hpp"

#include <charconv>
#include <cmath>
#include <sstream>
#include <string>
#include <string_view>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/text_scanner.hpp"

namespace resilin {
namespace {

constexpr std::string_view blanks = " \t\r";

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// One separator serves a whole line: semicolons when there are any, else commas, else blanks.
std::string_view separators_of(std::string_view line) {
  if (line.find(';') != std::string_view::npos) return ";";
  return line.find(',') != std::string_view::npos ? "," : " \t";
}

std::vector<std::string_view> split(std::string_view line) {
  const std::string_view separators = separators_of(line);
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t end = line.find_first_of(separators);
    cells.push_back(trim(line.substr(0, end)));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
    if (separators != ";" && separators != ",") line = trim(line);
  }
}

/// Spreadsheets put names into quotation marks.
std::string_view unquoted(std::string_view cell) {
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') return cell.substr(1, cell.size() - 2);
  return cell;
}

/// Advice on a cell that holds no number: text that reads as one is nan, inf or has no end.
std::string cure_of(std::string_view cell) {
  double value = 0;
  const bool is_no_value = std::from_chars(cell.data(), cell.data() + cell.size(), value).ec == std::errc{} &&
                           !std::isfinite(value);
  return cell.empty() || is_no_value ? "leave rows without a value out"
                                     : "decimals need a point, not a comma";
}

bool parse_number(std::string_view cell, double& value) {
  if (cell.starts_with('+')) cell.remove_prefix(1);
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc{} && end == cell.data() + cell.size() && std::isfinite(value);
}

/// Column names: none of the cells begins like a number.
bool is_header(const std::vector<std::string_view>& cells) {
  for (const std::string_view cell : cells) {
    double value = 0;
    if (std::from_chars(cell.data(), cell.data() + cell.size(), value).ec == std::errc{}) return false;
  }
  return true;
}

}  // namespace

NumberTable read_csv(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  std::istringstream file{std::string(without_byte_order_mark(bytes, path.string()))};
  NumberTable table;
  std::string text;
  for (int line = 1; std::getline(file, text); ++line) {
    const std::string_view content = trim(text);
    if (content.empty() || content.starts_with('#')) continue;
    const std::vector<std::string_view> cells = split(content);
    if (table.values.empty() && table.num_columns == 0 && is_header(cells)) {
      table.num_columns = cells.size();
      for (const std::string_view cell : cells) table.column_names.emplace_back(unquoted(cell));
      continue;
    }
    const std::string place = path.string() + ":" + std::to_string(line);
    if (table.num_columns == 0) table.num_columns = cells.size();
    if (cells.size() != table.num_columns) {
      throw InputError(place, std::to_string(table.num_columns) + " numbers as in the first row",
                       std::to_string(cells.size()), "decimals need a point, not a comma");
    }
    for (const std::string_view cell : cells) {
      double value = 0;
      if (!parse_number(cell, value)) {
        throw InputError(place, "a number", '"' + printable(cell) + '"', cure_of(cell));
      }
      table.values.push_back(value);
    }
  }
  return table;
}

}  // namespace resilin
