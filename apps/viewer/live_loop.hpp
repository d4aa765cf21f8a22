#pragma once

#include <functional>
#include <memory>
#include <thread>

#include "live_turns.hpp"
#include "mailbox.hpp"
#include "served_scene.hpp"

namespace resilin::viewer {

/// The turns of a live scene on a thread of their own. While the scene pauses or rests the thread sleeps.
class LiveLoop {
 public:
  /// Begins to simulate. `wake` is called whenever there is news; the mailbox outlives the loop.
  LiveLoop(std::unique_ptr<ServedScene> scene, Mailbox& mailbox, std::function<void()> wake,
           const LiveTurnsOptions& options = {});
  ~LiveLoop();
  LiveLoop(const LiveLoop&) = delete;
  LiveLoop& operator=(const LiveLoop&) = delete;

 private:
  void run();

  LiveTurns turns_;
  Mailbox* mailbox_;
  std::function<void()> wake_;
  std::thread thread_;
};

}  // namespace resilin::viewer
