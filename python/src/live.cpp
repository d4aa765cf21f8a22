#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "bodies.hpp"
#include "history.hpp"
#include "played_scene.hpp"
#include "resilin/view/page.hpp"

namespace resilin::python {
namespace {

/// Calls `function` with the live scene and returns its value.
template <class Function>
auto told(Function function) {
  return [function](const PlayedScene& scene) { return scene.look(function); };
}

/// Calls `function`, which changes the live scene.
template <class Function>
auto done(Function function) {
  return [function](PlayedScene& scene) { scene.change(function); };
}

template <class Result>
auto of_body(Result (*function)(const World&, const std::string&)) {
  return [function](const PlayedScene& scene, const std::string& name) {
    return scene.look([&](const LiveScene& live) { return function(live.world(), name); });
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
      .def("release", done([](LiveScene& live) { live.release(); }))
      .def("pin", &PlayedScene::pin, nb::arg("nodes"), nb::arg("holds"))
      .def("unpin_all", done([](LiveScene& live) { live.unpin_all(); }))
      .def("pinned", told([](const LiveScene& live) { return live.pinned(); }))
      .def("poke", &PlayedScene::poke, nb::arg("center"), nb::arg("radius"))
      .def("stop_poking", done([](LiveScene& live) { live.stop_poking(); }))
      .def("ball",
           [](const PlayedScene& scene) {
             return scene.look([&](const LiveScene& live) {
               const std::optional<Vector3> ball = live.ball();
               return ball ? std::optional(scene.outer(*ball)) : std::nullopt;
             });
           })
      .def("set", &PlayedScene::set, nb::arg("values"))
      .def("controls", &PlayedScene::controls)
      .def("reset", done([](LiveScene& live) { live.reset(); }))
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
            return scene.look(
                [&](const LiveScene& live) { return field_array(live.world(), {&live.state(), 1}, name); });
          },
          nb::arg("name"))
      .def("draw", &PlayedScene::draw, nb::arg("options"))
      .def("body_names",
           [](const PlayedScene& scene) {
             return scene.look([](const LiveScene& live) { return body_names(live.world()); });
           })
      .def("cells", of_body(&cells_of), nb::arg("body"))
      .def("vertex_range", of_body(&vertex_range_of), nb::arg("body"))
      .def_prop_ro("warnings", &PlayedScene::warnings)
      .def("open_page", &PlayedScene::open_page, nb::arg("page"))
      .def("close_page", &PlayedScene::close_page, nb::arg("page"))
      .def("receive", &PlayedScene::receive, nb::arg("page"), nb::arg("message"))
      .def("next_message", &PlayedScene::next_message, nb::arg("page"))
      .def("seconds_to_turn", &PlayedScene::seconds_to_turn)
      .def("take_turn", &PlayedScene::take_turn);
  module.def("hosted_page", [] { return page_with(source_script("hosted"), ""); });
}

}  // namespace resilin::python
