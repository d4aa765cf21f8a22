#include "history.hpp"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "resilin/core/error.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/results/report.hpp"
#include "resilin/results/result_picture.hpp"
#include "resilin/results/results.hpp"

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

}  // namespace

NumpyArray<double> field_array(const World& world, std::span<const State> states, const std::string& name) {
  const FieldInfo& field = require_field(name, "fields");
  const auto dim = static_cast<std::size_t>(world.dimension);
  const bool is_in_space = field.kind == FieldInfo::Kind::vector && field.is_on_nodes && dim < 3 &&
                           !field.name.starts_with("nodal_");
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
  if (!states_.empty()) {  // what is only needed to go on from the last
    State& before = states_.back();
    for (VectorX* values : {&before.previous_positions, &before.previous_velocities, &before.accelerations})
      values->resize(0);
  }
  states_.push_back(state);
  frames_.push_back(simulation.frame());
}

void History::finish(const Simulation& simulation, const RunOutcome& outcome, double total_seconds,
                     double output_seconds) {
  summary_ = {.outcome = outcome,
              .solver = std::string(simulation.solver_name()),
              .failed_steps = simulation.failed_steps(),
              .timing = simulation.timing(),
              .total_seconds = total_seconds,
              .output_seconds = output_seconds};
}

void History::save(const std::filesystem::path& path) const {
  ResultFolder folder(path, summary_.total_seconds);
  for (std::size_t i = 0; i < states_.size(); ++i) folder.record(world(), states_[i], frames_[i], true);
  folder.finish(world(), states_.back(), summary_);
}

std::string History::report() const {
  Json frames = Json::array();
  FieldEvaluator evaluator(world());
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const std::vector<FieldValues> fields = evaluator.evaluate(states_[i], world().output.fields);
    frames.push_back(frame_json(frames_[i], world(), states_[i], fields));
  }
  return report_json(world(), std::move(frames), summary_).dump();
}

Image History::draw(int frame, const PictureOptions& options) const {
  const int count = static_cast<int>(states_.size()), number = frame < 0 ? count + frame : frame;
  if (number < 0 || number >= count)
    throw InputError("frame", "0 to " + std::to_string(count - 1) + ", or -1 for the last",
                     std::to_string(frame));
  return draw_state(world(), states_[static_cast<std::size_t>(number)], options);
}

NumpyArray<double> History::nodal(VectorX State::* member) const {
  std::vector<double> all;
  for (const State& state : states_) all.insert(all.end(), (state.*member).begin(), (state.*member).end());
  return numpy_array(std::move(all), {states_.size(), static_cast<std::size_t>(world().num_nodes()),
                                      static_cast<std::size_t>(world().dimension)});
}

NumpyArray<double> History::scalar(double State::* member) const {
  std::vector<double> all;
  for (const State& state : states_) all.push_back(state.*member);
  return numpy_array(std::move(all), {states_.size()});
}

void bind_history(nb::module_& module) {
  module.def("field_names", &field_names);
  nb::class_<History>(module, "History")
      .def("save", &History::save, nb::arg("folder"), nb::call_guard<nb::gil_scoped_release>())
      .def("report", &History::report)
      .def("draw", &History::draw, nb::arg("frame"), nb::arg("options"),
           nb::call_guard<nb::gil_scoped_release>())
      .def("positions", &History::positions)
      .def("velocities", &History::velocities)
      .def("times", &History::times)
      .def("loads", &History::loads)
      .def("field", &History::field, nb::arg("name"));
}

}  // namespace resilin::python
