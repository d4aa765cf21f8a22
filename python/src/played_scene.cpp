#include "played_scene.hpp"

#include <algorithm>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/live/control_table.hpp"
#include "resilin/live/hand_patch.hpp"

namespace resilin::python {
namespace {

PlainValue plain_value(const ControlValue& value) {
  if (const auto* vector = std::get_if<Vector3>(&value))
    return std::vector<double>(vector->begin(), vector->end());
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* flag = std::get_if<bool>(&value)) return *flag;
  return std::get<double>(value);
}

/// A value of the kind that the control has. @throws InputError
ControlValue control_value(const LiveControl& control, const PlainValue& value,
                           const LiveControls& controls) {
  const std::string place = "controls: " + std::string(control.key);
  const ControlValue present = value_of(control, controls);
  if (std::holds_alternative<Vector3>(present)) {
    const auto* list = std::get_if<std::vector<double>>(&value);
    if (list == nullptr || list->size() != 3) throw InputError(place, "three numbers", "something else");
    return Vector3((*list)[0], (*list)[1], (*list)[2]);
  }
  if (std::holds_alternative<double>(present)) {
    if (const auto* number = std::get_if<double>(&value)) return *number;
    throw InputError(place, "a number", "something else");
  }
  if (std::holds_alternative<bool>(present)) {
    if (const auto* flag = std::get_if<bool>(&value)) return *flag;
    throw InputError(place, "True or False", "something else");
  }
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  throw InputError(place, "a text", "something else");
}

}  // namespace

PlayedScene::PlayedScene(const Description& description, std::vector<std::string> warnings)
    : warnings_(std::move(warnings)), live_(std::make_shared<LiveScene>(description)) {
  for (const std::string& warning : live_->world().warnings)
    if (std::ranges::find(warnings_, warning) == warnings_.end()) warnings_.push_back(warning);
}

void PlayedScene::touched(const viewer::SceneTouched& how) {
  ++changes_;
  if (pages_) pages_->touched(how);
}

void PlayedScene::step(const std::optional<double>& seconds) {
  change(
      [&](LiveScene& live) {
        const nb::gil_scoped_release release;
        live.step({.seconds = seconds.value_or(std::numeric_limits<double>::infinity())});
      },
      /*is_step=*/true);
}

Index PlayedScene::grab(const std::vector<double>& place) {
  return change([&](LiveScene& live) {
    const Vector3 point = inner(place, "grab");
    const Index node = nearest_node(point);
    const MaterialPoint patch = hand_patch(live.world(), {.nodes = {node}, .weights = {1}});
    const Vector3 position = patch.position(live.world().dimension, live.state().positions);
    grab_offset_ = position - node_position(live.world().dimension, node, live.state().positions);
    live.grab(patch, position);
    return node;
  });
}

void PlayedScene::drag(const std::vector<double>& place) {
  change([&](LiveScene& live) {
    if (!live.is_grabbed()) throw InputError("drag", "something that is held", "nothing", "call grab first");
    live.drag(inner(place, "drag") + grab_offset_);
  });
}

void PlayedScene::poke(const std::vector<double>& center, double radius) {
  change([&](LiveScene& live) { live.poke(inner(center, "poke"), radius); });
}

void PlayedScene::pin(const std::vector<Index>& nodes, bool holds) {
  change([&](LiveScene& live) {
    for (const Index node : nodes)
      if (node < 0 || node >= live.world().num_nodes())
        throw InputError(holds ? "pin" : "unpin",
                         "vertices from 0 to " + std::to_string(live.world().num_nodes() - 1),
                         std::to_string(node));
    for (const Index node : nodes) holds ? live.pin(node) : live.unpin(node);
  });
}

Image PlayedScene::draw(PictureOptions options) const {
  return look([&](const LiveScene& live) {
    const nb::gil_scoped_release release;
    Eigen::Index axis = 0;
    if (options.up == "auto" && live.up().maxCoeff(&axis) > 0.9) options.up = std::string(1, "xyz"[axis]);
    return draw_state(live.world(), live.state(), options);
  });
}

void PlayedScene::set(const std::vector<std::pair<std::string, PlainValue>>& values) {
  change([&](LiveScene& live) {
    LiveControls controls = live.controls();
    std::vector<std::pair<std::size_t, double>> driven;
    for (const auto& [key, value] : values) {
      const std::vector<Drive>& drives = live.drives();
      if (const auto drive = std::ranges::find(drives, key, &Drive::key); drive != drives.end()) {
        const double* number = std::get_if<double>(&value);
        if (number == nullptr) throw InputError("controls: " + key, "a number", "something else");
        check_value(*drive, *number);
        driven.emplace_back(static_cast<std::size_t>(drive - drives.begin()), *number);
        continue;
      }
      const LiveControl* control = find_live_control(key);
      if (control == nullptr) {
        std::vector<std::string> keys;
        for (const LiveControl& known : live_control_table()) keys.emplace_back(known.key);
        for (const Drive& drive : drives) keys.push_back(drive.key);
        throw InputError("controls", "one of " + join(keys), '"' + key + '"', did_you_mean(key, keys));
      }
      set_value(*control, control_value(*control, value, controls), controls);
    }
    live.set_controls(controls);
    for (const auto& [number, value] : driven) live.drive(number, value);
  });
}

std::vector<std::pair<std::string, PlainValue>> PlayedScene::controls() const {
  return look([](const LiveScene& live) {
    std::vector<std::pair<std::string, PlainValue>> values;
    for (const LiveControl& control : live_control_table())
      values.emplace_back(control.key, plain_value(value_of(control, live.controls())));
    for (const Drive& drive : live.drives())
      values.emplace_back(drive.key, drive.is_driven ? drive.goal : drive.value);
    return values;
  });
}

std::vector<double> PlayedScene::outer(const Vector3& place) const {
  const Vector3 shifted = place + live_->world().origin;
  return {shifted.begin(), shifted.begin() + live_->world().dimension};
}

Vector3 PlayedScene::inner(const std::vector<double>& place, const char* what) const {
  const int dim = live_->world().dimension;
  Vector3 point = Vector3::Zero();
  if (place.size() != static_cast<std::size_t>(dim))
    throw InputError(what, std::to_string(dim) + " numbers", std::to_string(place.size()));
  for (int i = 0; i < dim; ++i) point[i] = place[static_cast<std::size_t>(i)] - live_->world().origin[i];
  if (!(point.norm() <= 1000 * live_->world().largest_extent()))
    throw InputError(what, "a place within a thousand sizes of the bodies", format_point(point, dim));
  return point;
}

Index PlayedScene::nearest_node(const Vector3& place) const {
  Index nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (Index node = 0; node < live_->world().num_nodes(); ++node) {
    const double distance =
        (node_position(live_->world().dimension, node, live_->state().positions) - place).squaredNorm();
    if (distance < least) {
      least = distance;
      nearest = node;
    }
  }
  return nearest;
}

ScenePages& PlayedScene::pages() {
  if (!pages_) {
    const Turns::Turn turn(turns_, Turns::Kind::change);
    pages_ = std::make_unique<ScenePages>(live_, warnings_);
  }
  return *pages_;
}

void PlayedScene::open_page(viewer::ClientId page) { pages().open(page); }
void PlayedScene::close_page(viewer::ClientId page) { pages().close(page); }

void PlayedScene::receive(viewer::ClientId page, const PageWords& message) { pages().receive(page, message); }

std::optional<PageWords> PlayedScene::next_message(viewer::ClientId page) { return pages().next(page); }

std::optional<double> PlayedScene::seconds_to_turn() const {
  if (!pages_) return std::nullopt;
  const Turns::Turn turn(turns_, Turns::Kind::change);
  return pages_->seconds_to_turn();
}

void PlayedScene::take_turn() {
  if (!pages_) return;
  const Turns::Turn turn(turns_, Turns::Kind::change);
  ++changes_;
  const nb::gil_scoped_release release;
  pages_->take_turn();
}

}  // namespace resilin::python
