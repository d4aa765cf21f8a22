#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bindings.hpp"
#include "bodies.hpp"
#include "history.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/live/control_table.hpp"
#include "resilin/live/hand_patch.hpp"
#include "resilin/live/live_scene.hpp"
#include "resilin/results/result_picture.hpp"
#include "resilin/scene/scene.hpp"
#include "turns.hpp"

namespace resilin::python {
namespace {

/// As Python has it: a vector is a list of three numbers.
using PlainValue = std::variant<bool, double, std::string, std::vector<double>>;

PlainValue plain_value(const ControlValue& value) {
  if (const auto* vector = std::get_if<Vector3>(&value))
    return std::vector<double>(vector->begin(), vector->end());
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* flag = std::get_if<bool>(&value)) return *flag;
  return std::get<double>(value);
}

/// Of the kind that the control has. @throws InputError
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

/// A live scene that threads work with in turns. Places are in the scene's coordinates [m].
class PlayedScene {
 public:
  explicit PlayedScene(const Scene& scene) : warnings_(scene.warnings), live_(scene.description) {
    const std::vector<std::string>& more = live_.world().warnings;
    warnings_.insert(warnings_.end(), more.begin(), more.end());
  }

  const std::vector<std::string>& warnings() const { return warnings_; }

  /// `function(live scene)` in this thread's turn.
  template <class Function>
  auto with(const Function& function) const {
    const Turns::Turn turn(turns_, Turns::Kind::change);
    return function(live_);
  }

  void step(const std::optional<double>& seconds) {
    with([&](LiveScene& live) {
      const nb::gil_scoped_release release;
      live.step({.seconds = seconds.value_or(std::numeric_limits<double>::infinity())});
    });
  }

  /// Takes hold of what is around the node nearest to a place; gives that node.
  Index grab(const std::vector<double>& place) {
    return with([&](LiveScene& live) {
      const Vector3 point = inner(place, "grab");
      const Index node = nearest_node(point);
      const MaterialPoint patch = hand_patch(live.world(), {.nodes = {node}, .weights = {1}});
      const Vector3 position = patch.position(live.world().dimension, live.state().positions);
      grab_offset_ = position - node_position(live.world().dimension, node, live.state().positions);
      live.grab(patch, position);
      return node;
    });
  }

  /// The node that was taken hold of is pulled to a place.
  void drag(const std::vector<double>& place) {
    with([&](LiveScene& live) {
      if (!live.is_grabbed())
        throw InputError("drag", "something that is held", "nothing", "call grab first");
      live.drag(inner(place, "drag") + grab_offset_);
    });
  }

  void poke(const std::vector<double>& center, double radius) {
    with([&](LiveScene& live) { live.poke(inner(center, "poke"), radius); });
  }

  void pin(const std::vector<Index>& nodes, bool holds) {
    with([&](LiveScene& live) {
      for (const Index node : nodes)
        if (node < 0 || node >= live.world().num_nodes())
          throw InputError(holds ? "pin" : "unpin",
                           "vertices from 0 to " + std::to_string(live.world().num_nodes() - 1),
                           std::to_string(node));
      for (const Index node : nodes) holds ? live.pin(node) : live.unpin(node);
    });
  }

  /// Up is against the gravity that the scene began with: that of its world is among the controls.
  Image draw(PictureOptions options) const {
    return with([&](const LiveScene& live) {
      const nb::gil_scoped_release release;
      Eigen::Index axis = 0;
      if (options.up == "auto" && live.up().maxCoeff(&axis) > 0.9) options.up = std::string(1, "xyz"[axis]);
      return draw_state(live.world(), live.state(), options);
    });
  }

  void set(const std::vector<std::pair<std::string, PlainValue>>& values) {
    with([&](LiveScene& live) {
      LiveControls controls = live.controls();
      for (const auto& [key, value] : values) {
        const LiveControl* control = find_live_control(key);
        if (control == nullptr) {
          std::vector<std::string> keys;
          for (const LiveControl& known : live_control_table()) keys.emplace_back(known.key);
          throw InputError("controls", "one of " + join(keys), '"' + key + '"', did_you_mean(key, keys));
        }
        set_value(*control, control_value(*control, value, controls), controls);
      }
      live.set_controls(controls);
    });
  }

  std::vector<std::pair<std::string, PlainValue>> controls() const {
    return with([](const LiveScene& live) {
      std::vector<std::pair<std::string, PlainValue>> values;
      for (const LiveControl& control : live_control_table())
        values.emplace_back(control.key, plain_value(value_of(control, live.controls())));
      return values;
    });
  }

  /// In the scene's coordinates, as many numbers as it has dimensions.
  std::vector<double> outer(const Vector3& place) const {
    const Vector3 shifted = place + live_.world().origin;
    return {shifted.begin(), shifted.begin() + live_.world().dimension};
  }

 private:
  Vector3 inner(const std::vector<double>& place, const char* what) const {
    const int dim = live_.world().dimension;
    Vector3 point = Vector3::Zero();
    if (place.size() != static_cast<std::size_t>(dim))
      throw InputError(what, std::to_string(dim) + " numbers", std::to_string(place.size()));
    for (int i = 0; i < dim; ++i) point[i] = place[static_cast<std::size_t>(i)] - live_.world().origin[i];
    if (!(point.norm() <= 1000 * live_.world().largest_extent()))
      throw InputError(what, "a place within a thousand sizes of the bodies", format_point(point, dim));
    return point;
  }

  Index nearest_node(const Vector3& place) const {
    Index nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (Index node = 0; node < live_.world().num_nodes(); ++node) {
      const double distance =
          (node_position(live_.world().dimension, node, live_.state().positions) - place).squaredNorm();
      if (distance < least) {
        least = distance;
        nearest = node;
      }
    }
    return nearest;
  }

  std::vector<std::string> warnings_;
  mutable LiveScene live_;  // Turns see to it that one thread works with it
  Vector3 grab_offset_ = Vector3::Zero();
  mutable Turns turns_;
};

/// What `function` says of the live scene.
template <class Function>
auto told(Function function) {
  return [function](const PlayedScene& scene) { return scene.with(function); };
}

template <class Result>
auto of_body(Result (*function)(const World&, const std::string&)) {
  return [function](const PlayedScene& scene, const std::string& name) {
    return scene.with([&](const LiveScene& live) { return function(live.world(), name); });
  };
}

}  // namespace

void bind_live(nb::module_& module) {
  nb::class_<LiveReport>(module, "LiveReport")
      .def_ro("converged", &LiveReport::converged)
      .def_ro("at_rest", &LiveReport::at_rest)
      .def_ro("newton_iterations", &LiveReport::newton_iterations)
      .def_ro("residual", &LiveReport::residual)
      .def_ro("relative_residual", &LiveReport::relative_residual)
      .def_ro("min_volume_ratio", &LiveReport::min_volume_ratio)
      .def_ro("inverted_cells", &LiveReport::inverted_cells)
      .def_ro("elastic_energy", &LiveReport::elastic_energy)
      .def_ro("kinetic_energy", &LiveReport::kinetic_energy)
      .def_ro("words", &LiveReport::words);
  nb::class_<PlayedScene>(module, "LiveScene")
      .def(nb::init<const Scene&>(), nb::arg("scene"), nb::call_guard<nb::gil_scoped_release>())
      .def("step", &PlayedScene::step, nb::arg("seconds").none())
      .def("grab", &PlayedScene::grab, nb::arg("place"))
      .def("drag", &PlayedScene::drag, nb::arg("place"))
      .def("release", told([](LiveScene& live) { live.release(); }))
      .def("pin", &PlayedScene::pin, nb::arg("nodes"), nb::arg("holds"))
      .def("unpin_all", told([](LiveScene& live) { live.unpin_all(); }))
      .def("pinned", told([](const LiveScene& live) { return live.pinned(); }))
      .def("poke", &PlayedScene::poke, nb::arg("center"), nb::arg("radius"))
      .def("stop_poking", told([](LiveScene& live) { live.stop_poking(); }))
      .def("ball",
           [](const PlayedScene& scene) {
             return scene.with([&](const LiveScene& live) {
               const std::optional<Vector3> ball = live.ball();
               return ball ? std::optional(scene.outer(*ball)) : std::nullopt;
             });
           })
      .def("set", &PlayedScene::set, nb::arg("values"))
      .def("controls", &PlayedScene::controls)
      .def("reset", told([](LiveScene& live) { live.reset(); }))
      .def("report", told([](const LiveScene& live) { return live.report(); }))
      .def("is_grabbed", told([](const LiveScene& live) { return live.is_grabbed(); }))
      .def("hand_force", told([](const LiveScene& live) {
             const Vector3 force = live.hand_force();
             return std::vector<double>(force.begin(), force.begin() + live.world().dimension);
           }))
      .def("time", told([](const LiveScene& live) { return live.state().time; }))
      .def("title", told([](const LiveScene& live) { return live.world().title; }))
      .def("positions",
           told([](const LiveScene& live) { return place_array(live.world(), live.state().positions); }))
      .def("velocities", told([](const LiveScene& live) {
             return node_array(live.state().velocities, live.world().dimension);
           }))
      .def("rest_positions",
           told([](const LiveScene& live) { return place_array(live.world(), live.world().rest_positions); }))
      .def(
          "field",
          [](const PlayedScene& scene, const std::string& name) {
            return scene.with(
                [&](const LiveScene& live) { return field_array(live.world(), {&live.state(), 1}, name); });
          },
          nb::arg("name"))
      .def("draw", &PlayedScene::draw, nb::arg("options"))
      .def("body_names",
           [](const PlayedScene& scene) {
             return scene.with([](const LiveScene& live) { return body_names(live.world()); });
           })
      .def("cells", of_body(&cells_of), nb::arg("body"))
      .def("vertex_range", of_body(&vertex_range_of), nb::arg("body"))
      .def_prop_ro("warnings", &PlayedScene::warnings);
}

}  // namespace resilin::python
