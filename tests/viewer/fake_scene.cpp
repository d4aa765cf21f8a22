#include "fake_scene.hpp"

#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "resilin/core/error.hpp"
#include "resilin/core/overloaded.hpp"
#include "viewer/control_json.hpp"

namespace resilin::viewer {

nlohmann::json FakeServedScene::header() const {
  return {{"title", "A fake"}, {"parts", nlohmann::json::array()}, {"num_vertices", num_vertices_}};
}

nlohmann::json FakeServedScene::state() const {
  return {{"values", control_values(controls_, true)}, {"poking", is_poking_}};
}

void FakeServedScene::apply(const SceneMessage& message) {
  const auto start_anew = [this] {
    is_grabbed_ = is_poking_ = false;
    time_ = 0;
  };
  std::visit(Overloaded{
                 [this](const Grab& grab) {
                   if (grab.vertex >= num_vertices_) {
                     throw InputError("grab: vertex", "a number below " + std::to_string(num_vertices_),
                                      std::to_string(grab.vertex));
                   }
                   is_grabbed_ = true;
                 },
                 [this](const Release&) { is_grabbed_ = false; },
                 [this](const Poke&) { is_poking_ = true; },
                 [this](const PokeEnd&) { is_poking_ = false; },
                 [this](const SetControl& set) {
                   if (set.control != nullptr) set_value(*set.control, set.value, controls_);
                 },
                 [&](const Reset&) { start_anew(); },
                 [&](const Reload&) {
                   if (switches_->breaks_on_reload) throw InputError("fake.toml", "the scene is broken");
                   start_anew();
                 },
                 [](const auto&) {},
             },
             message);
}

void FakeServedScene::step(double) {
  if (switches_->breaks_in_step) throw std::runtime_error("a step broke");
  std::this_thread::sleep_for(std::chrono::milliseconds(switches_->step_milliseconds));
  ++switches_->num_steps;
  time_ += time_step();
}

std::string FakeServedScene::frame(std::uint32_t number, std::uint32_t answered_drag,
                                   const FieldChoice& shown, double) {
  const std::optional<std::size_t> field = shown.field;
  const std::size_t field_bytes = field ? 2U * num_vertices_ : 0U;
  std::string bytes(64 + 6U * num_vertices_ + field_bytes, '\0');
  const auto write = [&bytes](std::size_t offset, auto value) {
    std::memcpy(bytes.data() + offset, &value, sizeof value);
  };
  std::memcpy(bytes.data(), "RSF1", 4);
  write(4, number);
  write(8, time_);
  write(16, answered_drag);
  write(20, num_vertices_);
  write(24, field ? 2U : 0U);
  write(28, static_cast<std::uint32_t>(field.value_or(0)));
  return bytes;
}

FakeScene::FakeScene(std::uint32_t num_vertices, ServerOptions options)
    : server(options,
             {{"/", {"text/html; charset=utf-8", std::make_shared<const std::string>("<p>page</p>"), "abc"}}},
             &room),
      loop(std::make_unique<FakeServedScene>(switches, num_vertices), mailbox, [this] { server.wake(); }) {}

bool FakeScene::answers() const {
  viewer::PageClient newcomer = page();
  newcomer.receive_text("hello");
  return viewer::frame_number(newcomer.receive_frame()) > 0;
}

}  // namespace resilin::viewer
