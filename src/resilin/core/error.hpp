#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace resilin {

/// The input is wrong and the user can mend it: says where, what was expected, what came and what to do.
///
/// `what()` is one line (core/text.hpp): "PLACE: expected EXPECTED, got GOT; CURE".
class InputError : public std::runtime_error {
 public:
  /// A wrong value. `cure` may be empty.
  InputError(const std::string& place, const std::string& expected, const std::string& got,
             const std::string& cure = {});
  /// A wrong state that has no single value, such as "beam.msh: element 2 is inverted".
  InputError(const std::string& place, const std::string& problem);
};

/// Throws the InputError of a word that is none of `known`: "PLACE: expected one of ..., got "WORD"; did you
/// mean ...".
[[noreturn]] void refuse_word(const std::string& place, std::string_view word,
                              std::span<const std::string> known);

/// A file cannot be written or read for a reason outside its content (permissions, disk full).
class FileError : public InputError {
 public:
  using InputError::InputError;
};

/// The user asked to stop (Ctrl-C) at a place where nothing is lost.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

}  // namespace resilin
