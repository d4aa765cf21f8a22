#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "resilin/core/types.hpp"
#include "resilin/live/control_table.hpp"
#include "resilin/live/face_load.hpp"
#include "resilin/view/face_patch.hpp"

/// Messages of the page: docs/view_protocol.md, "Messages of the page".
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
/// The face around a place is held, or let go when the place lies on one that is.
struct HoldFace {
  std::uint32_t vertex = 0;
  Vector3 point = Vector3::Zero();  ///< where the pointer hit the surface [m]
  FaceReach reach;
};
struct FreeFaces {};
/// A load is put on the face around a place, or removed when the place lies on one that has one.
struct LoadFace {
  HoldFace face;
  FaceLoadChoice choice;
};
struct RemoveLoads {};
/// Steps lead to the equilibrium.
struct Settle {};
struct Poke {
  Vector3 center = Vector3::Zero();  ///< [m]
  double radius = 0;                 ///< [m], positive
};
struct PokeEnd {};
struct SetControl {
  const LiveControl* control = nullptr;  ///< an entry of the table; null: a drive
  ControlValue value;                    ///< value, of the kind that its form has; of a drive a number
  std::optional<std::size_t> body = {};  ///< its body; none: all bodies
  std::string drive = {};                ///< key of a motor or a cable
};
struct ChooseField {
  std::string name;    ///< empty: none
  std::string arrows;  ///< a field of vectors that arrows show; empty: none
};
struct Pause {};
struct Play {};
struct SingleStep {};
struct Reset {};
struct Reload {};
struct SaveScene {};
struct Acknowledge {
  std::uint32_t frame = 0;
};

/// Fields that the frames of a page show besides the shape, as indices of the header.
struct FieldChoice {
  std::optional<std::size_t> field{};   ///< none: the frames have no field
  std::optional<std::size_t> arrows{};  ///< the length of a vector, whose components come as arrows
  auto operator<=>(const FieldChoice&) const = default;
};

class ServedScene;
/// Another scene takes the place of the one that is played with: not a word of a page's, but of the server's
/// when a page has sent it a file.
struct OpenScene {
  std::shared_ptr<ServedScene> scene;
};

/// The program that hosts the pages has changed the scene by itself; where it steps, the page does not.
struct SceneTouched {
  bool by_a_step = false;
};

template <class Variant, class... More>
struct Extended;
template <class... Kind, class... More>
struct Extended<std::variant<Kind...>, More...> {
  using type = std::variant<Kind..., More...>;
};

/// Messages that change the scene.
using SceneMessage = std::variant<Grab, Drag, Release, Pin, Unpin, UnpinAll, HoldFace, FreeFaces, LoadFace,
                                  RemoveLoads, Settle, Poke, PokeEnd, SetControl, Reset, Reload>;
/// Messages to the simulation.
using LoopMessage = Extended<SceneMessage, Pause, Play, SingleStep, SaveScene, OpenScene, SceneTouched>::type;
/// All that a page can say; the rest is for the server.
using PageMessage = Extended<LoopMessage, ChooseField, Acknowledge>::type;

/// Reads a message, strictly: every key is known and there, every number is finite.
/// @throws InputError  one line that says what was expected
PageMessage read_text_message(std::string_view text);
PageMessage read_binary_message(std::string_view bytes);

}  // namespace resilin::viewer
