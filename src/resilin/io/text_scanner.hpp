#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Reads words and numbers, separated by white space, from text held in memory; knows the line it is in.
///
/// Numbers are read the same way in every locale. Every complaint is an InputError at "FILE: line N".
class TextScanner {
 public:
  /// `comment` opens a comment that ends with its line; '\0' for a format without comments.
  TextScanner(std::string file, std::string_view text, char comment = '\0');

  /// The part of the file that is being read, for messages about a file that ends too early.
  void set_section(std::string section) { section_ = std::move(section); }

  bool at_end();            ///< nothing but white space and comments is left
  std::string_view peek();  ///< the next word, empty at the end
  std::string_view word(std::string_view what);
  std::int64_t integer(std::string_view what);
  double real(std::string_view what);  ///< a finite number
  Vector3 point(std::string_view what, int num_coordinates = 3);

  /// A number of things of which each takes at least `least_bytes` of what is left of the file, so that a
  /// promise that the file cannot keep is refused before memory is reserved for it.
  std::size_t count(std::string_view what, std::size_t least_bytes);
  /// Refuses `number` things at the line just read, as `count` does.
  std::size_t checked_count(std::int64_t number, std::string_view what, std::size_t least_bytes) const;

  std::string_view rest_of_line();  ///< without its end and without comment; moves to the next line
  bool is_line_done();              ///< only blanks or a comment are left in the line
  std::string_view bytes(std::size_t size, std::string_view what);  ///< raw bytes
  void skip_line_end();                                             ///< "\n" or "\r\n", if it is next
  /// Moves behind the next occurrence of `text`; false (at the end) when there is none.
  bool skip_past(std::string_view text);

  const std::string& file() const { return file_; }
  std::size_t remaining() const { return text_.size() - position_; }
  std::int64_t line() const { return line_; }  ///< line of the word read last, from 1
  std::string place() const;                   ///< "FILE: line N"
  [[noreturn]] void fail(std::string_view expected, std::string_view got, const std::string& cure = {}) const;

 private:
  void skip_blanks();
  [[noreturn]] void fail_at_end(std::string_view what);

  std::string file_;
  std::string_view text_;
  char comment_;
  std::string section_;
  std::size_t position_ = 0;
  std::int64_t line_ = 1;
};

/// The text on one line, cut to 40 characters, with everything else than printable ASCII as \xNN.
std::string printable(std::string_view text);

/// True when the whole of `text` is an integer, or a number, in C notation; a leading '+' is allowed.
bool parse_integer(std::string_view text, std::int64_t& value);
bool parse_real(std::string_view text, double& value);

/// Fault of a word that should be a finite number; empty `expected` when there is none.
struct NumberFault {
  std::string expected;
  std::string cure = {};
};
/// Reads a finite number in C notation.
NumberFault read_real(std::string_view text, std::string_view what, double& value);

/// Helpers for lines of text.
std::string_view trimmed(std::string_view text);  ///< without blanks at its ends
std::string lower_case(std::string_view text);    ///< lower case of ASCII letters
/// The pieces between separators, without blanks at their ends.
std::vector<std::string_view> split(std::string_view text, char separator);
/// The words between blanks and commas.
std::vector<std::string_view> words_of(std::string_view text);

}  // namespace resilin
