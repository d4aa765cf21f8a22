#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "mailbox.hpp"
#include "served_scene.hpp"

namespace resilin::viewer {

struct LiveTurnsOptions {
  std::chrono::microseconds frame{16667};   ///< between two frames, at least
  std::chrono::microseconds budget{12000};  ///< part of it for time steps
};

/// The simulation's side of a live scene, turn by turn: does what the pages say, steps so that simulated time
/// follows the wall clock, and publishes what came of it. Time that is lost because steps take too long is
/// not made up for.
class LiveTurns {
 public:
  using Clock = Mailbox::Clock;

  /// Publishes the scene. The mailbox outlives it.
  LiveTurns(std::unique_ptr<ServedScene> scene, Mailbox& mailbox, const LiveTurnsOptions& options = {});

  /// No turn before this time.
  Clock::time_point due() const { return due_; }
  /// While nothing is paused and something moves, the next turn is due even if no page says anything.
  bool is_active() const { return !is_paused_ && is_moving_; }
  /// One turn, with what the pages have asked for since the last one.
  void turn(const Requests& requests);

 private:
  void obey(const Command& command);
  void obey(ClientId client, const LoopMessage& message);
  void open(std::shared_ptr<ServedScene> scene);
  void leave(ClientId client);
  void advance(Clock::time_point now);
  void step(double seconds);
  void stop_after_fault(const std::string& why);
  double real_time_ratio(Clock::time_point now);
  /// Between steps that are rare to the eye, frames go evenly from state to state, one step late.
  bool is_blending() const;

  void publish_scene();
  void publish_snapshot(const std::set<FieldChoice>& wanted);
  void publish_state();
  void publish_status(Clock::time_point now);

  std::shared_ptr<ServedScene> scene_;
  Mailbox* mailbox_;
  LiveTurnsOptions options_;

  bool is_paused_ = false;
  bool is_moving_ = true;   // the last step changed something
  double lag_ = 0;          // simulated time that the wall clock is ahead [s]
  Clock::time_point due_;   // the next turn
  Clock::time_point tick_;  // when the wall clock was last looked at
  std::optional<ClientId> grabbed_by_, poked_by_;
  std::uint32_t answered_drag_ = 0;

  bool has_changed_ = true;  // since the last snapshot
  std::uint64_t generation_ = 0;
  std::uint32_t snapshot_number_ = 0;
  std::set<FieldChoice> published_fields_;
  double surface_ms_ = 0;
  Clock::time_point status_time_;
  bool status_is_final_ = false;  // it was published after the last step
  struct Progress {
    Clock::time_point wall;
    double simulated;
  };
  std::deque<Progress> progress_;  // over the last second
};

}  // namespace resilin::viewer
