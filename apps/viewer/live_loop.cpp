#include "live_loop.hpp"

#include <optional>
#include <utility>

namespace resilin::viewer {

LiveLoop::LiveLoop(std::unique_ptr<ServedScene> scene, Mailbox& mailbox, std::function<void()> wake,
                   const LiveTurnsOptions& options)
    : turns_(std::move(scene), mailbox, options), mailbox_(&mailbox), wake_(std::move(wake)) {
  thread_ = std::thread([this] { run(); });
}

LiveLoop::~LiveLoop() {
  mailbox_->stop();
  thread_.join();
}

void LiveLoop::run() {
  using Time = LiveTurns::Clock::time_point;
  for (;;) {
    const Time due = turns_.due();
    const Requests requests =
        mailbox_->wait(due, turns_.is_active() ? std::optional<Time>(due) : std::nullopt);
    if (requests.is_stopping) return;
    turns_.turn(requests);
    wake_();
  }
}

}  // namespace resilin::viewer
