#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "bindings.hpp"
#include "resilin/live/live_scene.hpp"
#include "viewer/live_room.hpp"
#include "viewer/live_turns.hpp"
#include "viewer/mailbox.hpp"

namespace resilin::python {

/// Messages between a page and its scene: text or bytes.
using PageWords = std::variant<std::string, nb::bytes>;

/// The pages of a live scene that somebody else shows, and carries the words of: no server, no thread.
///
/// For one thread at a time, but that `take_turn` may run beside what pages say and are told.
class ScenePages {
 public:
  ScenePages(std::shared_ptr<LiveScene> live, std::vector<std::string> warnings);

  void open(viewer::ClientId page);
  void close(viewer::ClientId page);  ///< has no effect when it is not open
  void receive(viewer::ClientId page, const PageWords& message);
  std::optional<PageWords> next(viewer::ClientId page);
  std::optional<double> seconds_to_turn() const;
  void take_turn() { turns_.turn(mailbox_.take()); }
  /// The scene was changed by somebody else than a page.
  void touched(const viewer::SceneTouched& how) { mailbox_.post(0, how); }

 private:
  viewer::Mailbox mailbox_;
  viewer::LiveRoom room_{mailbox_};
  viewer::LiveTurns turns_;
  std::set<viewer::ClientId> open_;
};

}  // namespace resilin::python
