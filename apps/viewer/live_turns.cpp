#include "live_turns.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "fault_words.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/overloaded.hpp"

namespace resilin::viewer {
namespace {

using Json = nlohmann::json;

double seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

LiveTurns::LiveTurns(std::unique_ptr<ServedScene> scene, Mailbox& mailbox, const LiveTurnsOptions& options)
    : scene_(std::move(scene)), mailbox_(&mailbox), options_(options), due_(Clock::now()), tick_(due_) {
  publish_scene();
}

void LiveTurns::turn(const Requests& requests) {
  const bool was_active = is_active();
  for (const Command& command : requests.commands) obey(command);
  // Ticks follow a timetable, not the ends of steps; late by a frame, the timetable begins anew.
  const Clock::time_point now = Clock::now();
  const Clock::time_point tick = was_active && now - due_ < options_.frame ? due_ : now;
  if (is_active()) {
    if (!was_active) lag_ = scene_->time_step(), tick_ = tick, progress_.clear();
    advance(tick);
  }
  if (!requests.commands.empty()) publish_state();
  if (has_changed_ || is_blending() || requests.wanted_fields != published_fields_)
    publish_snapshot(requests.wanted_fields);
  publish_status(Clock::now());
  const double until_step = is_blending() ? 0 : (scene_->time_step() - lag_) / scene_->speed();
  const double wait = std::max(until_step, seconds(options_.frame));
  due_ = tick + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(wait));
}

void LiveTurns::advance(Clock::time_point now) {
  lag_ += seconds(now - tick_) * scene_->speed();
  tick_ = now;
  const double time_step = scene_->time_step();
  const Clock::time_point begin = Clock::now();
  const double budget = seconds(options_.budget);
  constexpr double nearly = 1 - 1e-6;  // timetables are in nanoseconds
  while (is_active() && lag_ >= nearly * time_step) {
    const double left = budget - seconds(Clock::now() - begin);
    if (left <= 0) break;
    step(left);
    lag_ -= time_step;
  }
  lag_ = std::clamp(lag_, 0.0, time_step);
}

bool LiveTurns::is_blending() const {
  constexpr double rare = 1.5;  // in frames
  return is_active() && scene_->time_step() > rare * seconds(options_.frame) * scene_->speed();
}

void LiveTurns::step(double budget) {
  has_changed_ = true;
  status_is_final_ = false;
  try {
    scene_->step(budget);
    is_moving_ = !scene_->is_at_rest();
  } catch (const std::exception& error) {
    stop_after_fault(words_of(error));
  }
}

/// A fault that no page has caused: everyone hears of it, and the scene waits for someone to change it.
void LiveTurns::stop_after_fault(const std::string& why) {
  is_paused_ = true;
  mailbox_->refuse_all(why + "; the scene pauses, reset or reload it");
  publish_state();
}

void LiveTurns::obey(const Command& command) {
  if (!command.message) return leave(command.client);
  is_moving_ = true;
  has_changed_ = true;
  try {
    obey(command.client, *command.message);
  } catch (const std::exception& error) {
    mailbox_->refuse(command.client, words_of(error));
  }
  if (!scene_->is_grabbed()) grabbed_by_.reset();
  if (!scene_->is_poking()) poked_by_.reset();
}

void LiveTurns::obey(ClientId client, const LoopMessage& message) {
  const auto take = [client](std::optional<ClientId>& owner, const char* what) {
    if (owner && *owner != client) throw InputError(what, "another page is dragging; wait until it releases");
    owner = client;
  };
  std::visit(Overloaded{
                 [&](const Grab& grab) {
                   take(grabbed_by_, "grab");
                   scene_->apply(grab);
                   answered_drag_ = 0;
                 },
                 [&](const Drag& drag) {
                   if (grabbed_by_ != client) return;  // it was let go a moment ago
                   scene_->apply(drag);
                   answered_drag_ = drag.number;
                 },
                 [&](const Release& release) {
                   if (grabbed_by_ == client) scene_->apply(release);
                 },
                 [&](const Poke& poke) {
                   take(poked_by_, "poke");
                   scene_->apply(poke);
                 },
                 [&](const PokeEnd& end) {
                   if (poked_by_ == client) scene_->apply(end);
                 },
                 [this](const Pause&) { is_paused_ = true; },
                 [this](const Play&) { is_paused_ = false; },
                 [this](const SingleStep&) {
                   is_paused_ = true;
                   step(std::numeric_limits<double>::infinity());
                 },
                 [this](const Reload& reload) {
                   scene_->apply(reload);
                   publish_scene();
                 },
                 [&](const SaveScene&) { mailbox_->tell(client, scene_->save()); },
                 [this](const OpenScene& opened) { open(opened.scene); },
                 [this](const SceneTouched& touched) { is_paused_ = is_paused_ || touched.by_a_step; },
                 [this](const auto& for_the_scene) { scene_->apply(for_the_scene); },
             },
             message);
}

/// Another scene begins, and moves.
void LiveTurns::open(std::shared_ptr<ServedScene> scene) {
  scene_ = std::move(scene);
  grabbed_by_.reset();
  poked_by_.reset();
  is_paused_ = false;
  lag_ = 0;
  tick_ = Clock::now();
  progress_.clear();
  publish_scene();
}

void LiveTurns::leave(ClientId client) {
  if (grabbed_by_ == client) obey({client, Release{}});
  if (poked_by_ == client) obey({client, PokeEnd{}});
}

void LiveTurns::publish_scene() {
  auto scene = std::make_shared<SceneNews>();
  scene->generation = ++generation_;
  scene->header = scene_->header();
  scene->topology = shared(scene_->topology());
  scene->field_names = scene_->field_names();
  mailbox_->publish([&scene](News& news) {
    news.scene = std::move(scene);
    news.snapshot.reset();
  });
  publish_state();
}

void LiveTurns::publish_snapshot(const std::set<FieldChoice>& wanted) {
  const Clock::time_point begin = Clock::now();
  auto snapshot = std::make_shared<Snapshot>();
  snapshot->generation = generation_;
  snapshot->number = ++snapshot_number_;
  const double blend = is_blending() ? std::clamp(lag_ / scene_->time_step(), 0.0, 1.0) : 1;
  try {
    for (const FieldChoice& shown : wanted) {
      snapshot->frames[shown] = shared(scene_->frame(snapshot->number, answered_drag_, shown, blend));
    }
  } catch (const std::exception& error) {
    stop_after_fault(words_of(error));
  }
  published_fields_ = wanted;
  has_changed_ = false;
  surface_ms_ = 1e3 * seconds(Clock::now() - begin);
  mailbox_->publish([&snapshot](News& news) { news.snapshot = std::move(snapshot); });
}

void LiveTurns::publish_state() {
  Json state = scene_->state();
  state["type"] = "state";
  state["paused"] = is_paused_;
  state["grabbed_by"] = grabbed_by_ ? Json(*grabbed_by_) : Json();
  std::string text = state.dump(-1, ' ', false, Json::error_handler_t::replace);
  mailbox_->publish([&text](News& news) {
    if (news.state.text && *news.state.text == text) return;
    news.state.text = shared(std::move(text));
    ++news.state.version;
  });
}

double LiveTurns::real_time_ratio(Clock::time_point now) {
  progress_.push_back({now, scene_->time()});
  while (now - progress_.front().wall > std::chrono::seconds(1) && progress_.size() > 2)
    progress_.pop_front();
  const double wall = seconds(now - progress_.front().wall);
  return wall > 0 ? (scene_->time() - progress_.front().simulated) / wall : 0;
}

/// Ten times a second while the scene moves, and once more when it has stopped.
void LiveTurns::publish_status(Clock::time_point now) {
  const bool is_last = !is_active();
  if (is_last ? status_is_final_ : now - status_time_ < std::chrono::milliseconds(100)) return;
  status_time_ = now;
  status_is_final_ = is_last;
  Json status = scene_->status();
  status["type"] = "status";
  status["real_time_ratio"] = is_last ? 0 : real_time_ratio(now);
  status["surface_ms"] = surface_ms_;
  std::string text = status.dump(-1, ' ', false, Json::error_handler_t::replace);
  mailbox_->publish([&text](News& news) {
    news.status.text = shared(std::move(text));
    ++news.status.version;
  });
}

}  // namespace resilin::viewer
