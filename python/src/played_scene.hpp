#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bindings.hpp"
#include "resilin/live/live_scene.hpp"
#include "resilin/picture/image.hpp"
#include "resilin/results/result_picture.hpp"
#include "resilin/scene/scene.hpp"
#include "scene_pages.hpp"
#include "turns.hpp"

namespace resilin::python {

/// As Python has it: a vector is a list of three numbers.
using PlainValue = std::variant<bool, double, std::string, std::vector<double>>;

/// A live scene that threads work with in turns, and pages, too. Places are in the scene's coordinates [m].
class PlayedScene {
 public:
  explicit PlayedScene(const Scene& scene) : PlayedScene(scene.description, scene.warnings) {}
  PlayedScene(const Description& description, std::vector<std::string> warnings);

  const std::vector<std::string>& warnings() const { return warnings_; }

  /// `function(live scene)` in this thread's turn.
  template <class Function>
  auto look(const Function& function) const {
    const Turns::Turn turn(turns_, Turns::Kind::change);
    return function(std::as_const(*live_));
  }

  /// The same for what changes the scene: pages hear of it, and pause where it is a step.
  template <class Function>
  auto change(const Function& function, bool is_step = false) {
    const Turns::Turn turn(turns_, Turns::Kind::change);
    const Touching touching{*this, {.by_a_step = is_step}};
    return function(*live_);
  }

  /// How often something has changed: steps, and what else was done.
  std::uint64_t changes() const { return changes_; }

  void step(const std::optional<double>& seconds);
  /// Takes hold of what is around the node nearest to a place; gives that node.
  Index grab(const std::vector<double>& place);
  /// The node that was taken hold of is pulled to a place.
  void drag(const std::vector<double>& place);
  void poke(const std::vector<double>& center, double radius);
  void pin(const std::vector<Index>& nodes, bool holds);
  /// Up is against the gravity that the scene began with: that of its world is among the controls.
  Image draw(PictureOptions options) const;
  void set(const std::vector<std::pair<std::string, PlainValue>>& values);
  std::vector<std::pair<std::string, PlainValue>> controls() const;
  /// In the scene's coordinates, as many numbers as it has dimensions.
  std::vector<double> outer(const Vector3& place) const;

  // Pages, which somebody else shows; docs/view_protocol.md has the messages.
  void open_page(viewer::ClientId page);
  void close_page(viewer::ClientId page);
  void receive(viewer::ClientId page, const PageWords& message);
  std::optional<PageWords> next_message(viewer::ClientId page);
  /// Until the next turn is due; none where no page has said anything and nothing moves.
  std::optional<double> seconds_to_turn() const;
  void take_turn();

 private:
  struct Touching {
    PlayedScene& scene;
    viewer::SceneTouched how;
    ~Touching() { scene.touched(how); }
  };

  void touched(const viewer::SceneTouched& how);
  ScenePages& pages();
  Vector3 inner(const std::vector<double>& place, const char* what) const;
  Index nearest_node(const Vector3& place) const;

  std::vector<std::string> warnings_;
  std::shared_ptr<LiveScene> live_;  // Turns see to it that one thread works with it
  Vector3 grab_offset_ = Vector3::Zero();
  std::uint64_t changes_ = 0;
  std::unique_ptr<ScenePages> pages_;  // from the first page on
  mutable Turns turns_;
};

}  // namespace resilin::python
