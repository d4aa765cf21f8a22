#pragma once

#include <stdexcept>
#include <string>

namespace resilin {

/// The input is wrong and the user can mend it: says where, what was expected, what came and what to do.
///
/// `what()` is one line: "PLACE: expected EXPECTED, got GOT; CURE".
class InputError : public std::runtime_error {
 public:
  /// A wrong value. `cure` may be empty.
  InputError(const std::string& place, const std::string& expected, const std::string& got,
             const std::string& cure = {});
  /// A wrong state that has no single value, such as "beam.msh: element 2 is inverted".
  InputError(const std::string& place, const std::string& problem);
};

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
