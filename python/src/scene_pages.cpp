#include "scene_pages.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "viewer/served_live_scene.hpp"

namespace resilin::python {

ScenePages::ScenePages(std::shared_ptr<LiveScene> live, std::vector<std::string> warnings)
    : turns_(std::make_unique<viewer::ServedLiveScene>(std::move(live), std::move(warnings)), mailbox_) {}

void ScenePages::open(viewer::ClientId page) {
  close(page);
  room_.opened(page);
  open_.insert(page);
}

void ScenePages::close(viewer::ClientId page) {
  if (open_.erase(page) > 0) room_.closed(page);
}

void ScenePages::receive(viewer::ClientId page, const PageWords& message) {
  if (!open_.contains(page)) return;  // its last words, after it was closed
  if (const auto* text = std::get_if<std::string>(&message)) {
    room_.received(page, /*is_text=*/true, *text);
  } else {
    const nb::bytes& bytes = std::get<nb::bytes>(message);
    room_.received(page, /*is_text=*/false, {bytes.c_str(), bytes.size()});
  }
}

std::optional<PageWords> ScenePages::next(viewer::ClientId page) {
  if (!open_.contains(page)) return std::nullopt;
  const std::optional<viewer::Outgoing> message = room_.next(page);
  if (!message) return std::nullopt;
  if (message->is_text) return *message->bytes;
  return nb::bytes(message->bytes->data(), message->bytes->size());
}

std::optional<double> ScenePages::seconds_to_turn() const {
  if (!turns_.is_active() && !mailbox_.has_requests()) return std::nullopt;
  const std::chrono::duration<double> left = turns_.due() - viewer::LiveTurns::Clock::now();
  return std::max(0.0, left.count());
}

}  // namespace resilin::python
