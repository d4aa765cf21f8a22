#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "resilin/core/types.hpp"

/// What a page can say: docs/view_protocol.md, "Messages of the page".
namespace resilin::viewer {

struct Grab {
  std::uint32_t vertex = 0;
  Vector3 point = Vector3::Zero();  ///< where the pointer hit the surface [m]
};
struct Drag {
  std::uint32_t number = 0;
  Vector3 target = Vector3::Zero();  ///< [m]
};
struct Release {};
struct Pin {
  std::uint32_t vertex = 0;
};
struct Unpin {
  std::uint32_t vertex = 0;
};
struct UnpinAll {};
struct Poke {
  Vector3 center = Vector3::Zero();  ///< [m]
  double radius = 0;                 ///< [m], positive
};
struct PokeEnd {};
/// A control takes a new value; which kind of value depends on the key.
struct SetControl {
  std::string key;
  std::variant<double, bool, std::string, Vector3> value;
};
struct ChooseField {
  std::string name;  ///< empty: none
};
struct Pause {};
struct Play {};
struct SingleStep {};
struct Reset {};
struct Reload {};
struct Acknowledge {
  std::uint32_t frame = 0;
};

using PageMessage = std::variant<Grab, Drag, Release, Pin, Unpin, UnpinAll, Poke, PokeEnd, SetControl,
                                 ChooseField, Pause, Play, SingleStep, Reset, Reload, Acknowledge>;

/// Reads a message, strictly: every key is known and there, every number is finite.
/// @throws InputError  one line that says what was expected
PageMessage read_text_message(std::string_view text);
PageMessage read_binary_message(std::string_view bytes);

}  // namespace resilin::viewer
