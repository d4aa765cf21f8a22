#include "resilin/core/error.hpp"

#include "resilin/core/text.hpp"

namespace resilin {

InputError::InputError(const std::string& place, const std::string& expected, const std::string& got,
                       const std::string& cure)
    : std::runtime_error(
          one_line(place + ": expected " + expected + ", got " + got + (cure.empty() ? "" : "; " + cure))) {}

InputError::InputError(const std::string& place, const std::string& problem)
    : std::runtime_error(one_line(place + ": " + problem)) {}

void refuse_word(const std::string& place, std::string_view word, std::span<const std::string> known) {
  throw InputError(place, "one of " + join(known), '"' + std::string(word) + '"', did_you_mean(word, known));
}

}  // namespace resilin
