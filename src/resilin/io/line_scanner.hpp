#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace resilin {

/// Lines of text held in memory, for formats in which a line is a record.
///
/// Numbers are read the same way in every locale. Every complaint is an InputError at "FILE: line N".
class LineScanner {
 public:
  LineScanner(std::string file, std::string_view text);

  bool next();    ///< moves to the next line; false at the end
  void repeat();  ///< `next` gives the same line once more

  std::string_view line() const { return line_; }  ///< without its end
  std::int64_t number() const { return number_; }  ///< number of the line, from 1
  std::size_t remaining() const { return text_.size() - position_; }
  const std::string& file() const { return file_; }
  std::string place() const;  ///< "FILE: line N"

  std::int64_t integer(std::string_view field, std::string_view what) const;
  /// A finite number; also in the notations of Fortran: "1.5D3" and "1.5+3".
  double real(std::string_view field, std::string_view what) const;

  [[noreturn]] void fail(std::string_view expected, std::string_view got, const std::string& cure = {}) const;

 private:
  std::string file_;
  std::string_view text_;
  std::string_view line_;
  std::size_t position_ = 0;
  std::int64_t number_ = 0;
  bool is_repeated_ = false;
};

}  // namespace resilin
