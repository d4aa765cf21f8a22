#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace resilin {

/// Numbers in rows of equal length.
struct NumberTable {
  std::size_t num_columns = 0;
  std::vector<double> values;                  ///< row by row
  std::vector<std::string> column_names = {};  ///< column names of a first line of names; empty without one

  std::size_t num_rows() const { return num_columns == 0 ? 0 : values.size() / num_columns; }
};

/// Reads a CSV file: numbers with a decimal point whatever the locale, separated by commas, semicolons or
/// blanks. Empty lines and lines that begin with # are left out, and so is a first line of column names.
/// Throws InputError "FILE:LINE: ...".
NumberTable read_csv(const std::filesystem::path& path);

}  // namespace resilin
