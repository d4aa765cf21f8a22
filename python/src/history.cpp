#include "history.hpp"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>

#include "bodies.hpp"
#include "resilin/core/archive.hpp"
#include "resilin/core/error.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/results/report.hpp"
#include "resilin/results/result_picture.hpp"
#include "resilin/results/results.hpp"
#include "resilin/results/shown_results.hpp"
#include "resilin/world/description_image.hpp"

namespace resilin {

RESILIN_MEMBERS(DiscretisationError, share, estimate)
RESILIN_MEMBERS(RunOutcome, status, reason, warnings, discretisation_errors, estimate_seconds, stiffness)
RESILIN_MEMBERS(Timing, assembly, solve, steps)
RESILIN_MEMBERS(RunSummary, outcome, solver, failed_steps, most_strained, timing, total_seconds,
                output_seconds)

}  // namespace resilin

namespace resilin::python {
namespace {

/// Vectors on vertices come with three components; in 2D the third is left out.
std::vector<double> without_third(const std::vector<double>& vectors, std::size_t dim) {
  std::vector<double> values;
  values.reserve(vectors.size() / 3 * dim);
  for (std::size_t i = 0; i < vectors.size(); ++i)
    if (i % 3 < dim) values.push_back(vectors[i]);
  return values;
}

/// Values of `function` for each state, (T, N, dim).
template <class Function>
NumpyArray<double> node_arrays(const World& world, std::span<const State> states, const Function& function) {
  std::vector<double> all;
  for (const State& state : states) {
    const VectorX values = function(state);
    all.insert(all.end(), values.begin(), values.end());
  }
  return numpy_array(std::move(all), {states.size(), static_cast<std::size_t>(world.num_nodes()),
                                      static_cast<std::size_t>(world.dimension)});
}

// ---- functions of the world

template <class Result>
auto of_world(Result (*function)(const World&)) {
  return [function](const History& history) { return function(history.world()); };
}

template <class Result>
auto of_body(Result (*function)(const World&, const std::string&)) {
  return
      [function](const History& history, const std::string& name) { return function(history.world(), name); };
}

}  // namespace

VectorX scene_places(const World& world, VectorX positions) {
  for (Eigen::Index i = 0; i < positions.size(); ++i)
    positions[i] += world.origin[static_cast<int>(i) % world.dimension];
  return positions;
}

NumpyArray<double> field_array(const World& world, std::span<const State> states, const std::string& name) {
  const FieldInfo& field = require_field(name, "fields");
  const auto dim = static_cast<std::size_t>(world.dimension);
  const bool is_in_space =
      field.kind == FieldInfo::Kind::vector && dim < 3 && field.source == FieldInfo::Source::vertices;
  FieldEvaluator evaluator(world);
  std::vector<double> all;
  for (const State& state : states) {
    std::vector<double> values = std::move(evaluator.evaluate(state, {&name, 1}).front().values);
    if (is_in_space) values = without_third(values, dim);
    all.insert(all.end(), values.begin(), values.end());
  }
  const std::size_t components = is_in_space ? dim : static_cast<std::size_t>(field.components());
  const std::size_t count = states.size(), places = count == 0 ? 0 : all.size() / count / components;
  if (components == 9) return numpy_array(std::move(all), {count, places, 3, 3});
  if (components == 1) return numpy_array(std::move(all), {count, places});
  return numpy_array(std::move(all), {count, places, components});
}

void History::record(const Simulation& simulation, bool is_last) {
  const State& state = simulation.state();
  if (!states_.empty() && states_.back().step == state.step) return;
  if (!is_last && !states_.empty() && state.step % world().output.every != 0) return;
  if (!states_.empty()) {  // drops data that only a continued run needs
    State& before = states_.back();
    for (VectorX* values : {&before.previous_positions, &before.previous_velocities, &before.accelerations})
      values->resize(0);
  }
  states_.push_back(state);
  frames_.push_back(simulation.frame());
}

void History::finish(const Simulation& simulation, const RunOutcome& outcome, double total_seconds,
                     double output_seconds) {
  summary_ = summary_of(simulation, outcome, total_seconds, output_seconds);
}

const std::string& History::report() const {
  if (!report_.empty()) return report_;
  Json frames = Json::array();
  FieldEvaluator evaluator(world());
  const std::vector<std::string> names = fields_of_report(world());
  for (std::size_t i = 0; i < frames_.size(); ++i)
    frames.push_back(frame_json(frames_[i], world(), states_[i], evaluator.evaluate(states_[i], names)));
  return report_ = report_json(world(), std::move(frames), summary_).dump();
}

void History::save(const std::filesystem::path& path) const {
  ResultFolder folder(path, summary_.total_seconds);
  const Json report = Json::parse(this->report());
  for (std::size_t i = 0; i < states_.size(); ++i)
    folder.add(world(), states_[i], report["frames"][i].dump());
  folder.finish(world(), states_.back(), summary_);
}

std::string History::image() const {
  if (!world().made_from) throw std::runtime_error("a result of a world without a description has no image");
  std::vector<std::string> states;
  for (const State& state : states_) states.push_back(serialize(state));
  ArchiveWriter writer;
  writer(serialize(*world().made_from), states, report(), summary_);
  return writer.take();
}

History History::from_image(std::string_view image) {
  const std::string place = "result";
  std::string description, report;
  std::vector<std::string> states;
  RunSummary summary;
  ArchiveReader reader(image, place);
  reader(description, states, report, summary);
  reader.end();
  History history(std::make_shared<const World>(deserialize_description(description, place)));
  for (const std::string& state : states) history.states_.push_back(deserialize_state(state, place));
  history.report_ = std::move(report);
  history.summary_ = std::move(summary);
  return history;
}

const State& History::state_of(int frame) const {
  const int count = static_cast<int>(states_.size()), number = frame < 0 ? count + frame : frame;
  if (number < 0 || number >= count)
    throw InputError("frame", "0 to " + std::to_string(count - 1) + ", or -1 for the last",
                     std::to_string(frame));
  return states_[static_cast<std::size_t>(number)];
}

Image History::draw(int frame, const PictureOptions& options) const {
  return draw_state(world(), state_of(frame), options);
}

NumpyArray<double> History::positions_of_frame(int frame) const {
  return place_array(world(), state_of(frame).positions);
}

NumpyArray<double> History::field_of_frame(const std::string& name, int frame) const {
  const FieldInfo& field = require_field(name, "fields");
  const auto rows = FieldEvaluator(world()).evaluate(state_of(frame), {&name, 1});
  const std::vector<double>& values = rows.front().values;
  const auto columns = static_cast<std::size_t>(field.components());
  if (columns == 9) return numpy_array(values, {values.size() / 9, 3, 3});
  if (columns == 1) return numpy_array(values, {values.size()});
  return numpy_array(values, {values.size() / columns, columns});
}

std::string History::page(const std::filesystem::path& folder, const std::vector<int>& frames) const {
  std::vector<NumberedState> shown;
  for (const int frame : frames)
    shown.push_back({static_cast<std::size_t>(frame), &states_.at(static_cast<std::size_t>(frame))});
  return recorded_page(folder, world(), shown, report());
}

NumpyArray<double> History::positions() const {
  return node_arrays(world(), states_, [&](const State& s) { return scene_places(world(), s.positions); });
}

NumpyArray<double> History::velocities() const {
  return node_arrays(world(), states_, [](const State& s) { return s.velocities; });
}

NumpyArray<double> History::scalar(double State::* member) const {
  std::vector<double> all;
  for (const State& state : states_) all.push_back(state.*member);
  return numpy_array(std::move(all), {states_.size()});
}

void bind_history(nb::module_& module) {
  module.def("field_names", &field_names);
  nb::class_<History>(module, "History")
      .def(
          "save",
          [](const History& history, const std::filesystem::path& folder) {
            history.report();  // made by one thread
            const nb::gil_scoped_release release;
            history.save(folder);
          },
          nb::arg("folder"))
      .def("report", &History::report)
      .def("warnings", &History::warnings)
      .def("__getstate__",
           [](const History& history) {
             const std::string image = history.image();
             return nb::bytes(image.data(), image.size());
           })
      .def("__setstate__",
           [](History& history, const nb::bytes& image) {
             new (&history) History(History::from_image({image.c_str(), image.size()}));
           })
      .def("draw", &History::draw, nb::arg("frame"), nb::arg("options"),
           nb::call_guard<nb::gil_scoped_release>())
      .def(
          "page",
          [](const History& history, const std::filesystem::path& folder, const std::vector<int>& frames) {
            history.report();  // made by one thread
            const nb::gil_scoped_release release;
            return history.page(folder, frames);
          },
          nb::arg("folder"), nb::arg("frames"))
      .def("body_names", of_world(&body_names))
      .def("cells", of_body(&cells_of), nb::arg("body"))
      .def("cell_kind", of_body(&cell_kind_of), nb::arg("body"))
      .def("vertex_range", of_body(&vertex_range_of), nb::arg("body"))
      .def("positions", &History::positions)
      .def("velocities", &History::velocities)
      .def("times", &History::times)
      .def("loads", &History::loads)
      .def("field", &History::field, nb::arg("name"))
      .def("positions_of_frame", &History::positions_of_frame, nb::arg("frame"))
      .def("field_of_frame", &History::field_of_frame, nb::arg("name"), nb::arg("frame"))
      .def_static("is_by_cell",
                  [](const std::string& name) { return !require_field(name, "fields").is_on_nodes(); });
}

}  // namespace resilin::python
