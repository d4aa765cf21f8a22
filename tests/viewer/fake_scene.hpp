#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/live_loop.hpp"
#include "viewer/live_room.hpp"
#include "viewer/mailbox.hpp"
#include "viewer/page_client.hpp"
#include "viewer/page_server.hpp"
#include "viewer/served_scene.hpp"

namespace resilin::viewer {

/// State of a fake scene in a test; read and written from both threads.
struct FakeSwitches {
  std::atomic<int> num_steps = 0;
  std::atomic<bool> rests = false;  ///< after the next step
  std::atomic<bool> breaks_on_reload = false;
  std::atomic<bool> breaks_in_step = false;
  std::atomic<int> step_milliseconds = 0;  ///< duration of a step
};

/// A scene without mechanics: its frames have as many bytes as those of `num_vertices` vertices, and the
/// right header.
class FakeServedScene : public ServedScene {
 public:
  FakeServedScene(std::shared_ptr<FakeSwitches> switches, std::uint32_t num_vertices)
      : switches_(std::move(switches)), num_vertices_(num_vertices) {}

  nlohmann::json header() const override;
  std::string topology() const override { return "RST1" + std::string(4, '\0'); }
  std::vector<std::string> field_names() const override { return {"displacement", "von_mises"}; }
  nlohmann::json state() const override;
  nlohmann::json status() const override { return {{"time", time_}, {"at_rest", is_at_rest()}}; }
  void apply(const SceneMessage& message) override;
  std::string save() override { return "Saved."; }
  bool is_grabbed() const override { return is_grabbed_; }
  bool is_poking() const override { return is_poking_; }
  double time() const override { return time_; }
  double time_step() const override { return 1.0 / 60; }
  double speed() const override { return controls_.speed; }
  bool is_at_rest() const override { return switches_->rests; }
  void step(double seconds) override;
  std::string frame(std::uint32_t number, std::uint32_t answered_drag, const FieldChoice& shown,
                    double blend) override;

 private:
  std::shared_ptr<FakeSwitches> switches_;
  std::uint32_t num_vertices_;
  double time_ = 0;
  LiveControls controls_;
  bool is_grabbed_ = false, is_poking_ = false;
};

/// A server with a scene behind it and pages that connect to it.
struct FakeScene {
  explicit FakeScene(std::uint32_t num_vertices = 100, ServerOptions options = {});

  viewer::PageClient page() const { return {server.port(), server.token()}; }
  /// True as soon as a new page is served from beginning to end.
  bool answers() const;

  std::shared_ptr<FakeSwitches> switches = std::make_shared<FakeSwitches>();
  Mailbox mailbox;
  LiveRoom room{mailbox};
  PageServer server;
  LiveLoop loop;
};

/// Tries until it is so; a busy machine has a minute for it.
template <class Condition>
bool comes_true(Condition condition) {
  for (const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);;) {
    if (condition()) return true;
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

}  // namespace resilin::viewer
