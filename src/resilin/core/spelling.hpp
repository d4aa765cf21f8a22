#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

/// Choices of a user, as enums. Beside the enum stands how each value is written in a scene file, in order:
///
///   enum class MassKind { lumped, consistent };
///   constexpr std::array<std::string_view, 2> spellings(MassKind) { return {"lumped", "consistent"}; }
///
/// The scene reader, reports and messages derive from it.
namespace resilin {

/// Enums whose values have names, by a function `spellings`.
template <class T>
concept Spelled = std::is_enum_v<T> && requires(T value) { spellings(value).size(); };

/// The names of all values, in their order.
template <Spelled T>
std::vector<std::string> all_spellings() {
  const auto written = spellings(T{});
  return {written.begin(), written.end()};
}

/// The value that is written so, if there is one.
template <Spelled T>
std::optional<T> find_spelled(std::string_view word) {
  const auto words = spellings(T{});
  for (std::size_t i = 0; i < words.size(); ++i)
    if (words[i] == word) return static_cast<T>(i);
  return std::nullopt;
}

/// Throws InputError at `place` for a number that is no value of the enum.
template <Spelled T>
void require_known(T value, const std::string& place) {
  const auto number = static_cast<std::size_t>(value);
  if (number < spellings(T{}).size()) return;
  throw InputError(place, "one of " + join(all_spellings<T>()), "the number " + std::to_string(number));
}

/// How a value is written.
template <Spelled T>
std::string spelling(T value) {
  return std::string(spellings(value).at(static_cast<std::size_t>(value)));
}

}  // namespace resilin
