#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "history.hpp"
#include "interruptible.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/stopwatch.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/results/report.hpp"
#include "resilin/results/result_picture.hpp"
#include "resilin/results/results.hpp"
#include "resilin/results/run.hpp"
#include "resilin/scene/scene.hpp"
#include "scene_value.hpp"

namespace resilin::python {
namespace {

/// A simulation with the description that it was made from.
class RunningSimulation {
 public:
  explicit RunningSimulation(const Scene& scene)
      : description_(scene.description), warnings_(scene.warnings) {
    const Stopwatch stopwatch(setup_seconds_);
    simulation_ = std::make_shared<Simulation>(description_);
    for (std::string& warning : all_warnings(world())) warnings_.push_back(std::move(warning));
  }

  const Simulation& simulation() const { return *simulation_; }
  const World& world() const { return simulation_->world(); }
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// (status, reason, iterations, relative residual). The state stays where it was when Ctrl-C comes.
  std::tuple<std::string, std::string, int, double> step() {
    Interruptible interruptible;
    StepReport report;
    {
      const nb::gil_scoped_release release;
      report = simulation_->step([&](const NewtonReport&) { return !interruptible.is_stopped(); });
    }
    interruptible.rethrow();
    return {report.status == StepReport::Status::converged ? "converged" : "not_converged", report.reason,
            report.newton.iterations, report.newton.relative_residual()};
  }

  /// Runs to the end and records. `resume`: null, "same" or "anyway", as after --resume. `after_step` is
  /// called without arguments.
  History run(const std::optional<std::filesystem::path>& out, const std::optional<std::string>& resume,
              int max_steps, const nb::object& after_step) {
    Interruptible interruptible;
    std::optional<History> history;
    {
      const nb::gil_scoped_release release;
      history.emplace(recorded(out, resume, max_steps, interruptible, after_step));
    }
    interruptible.rethrow();
    return std::move(*history);
  }

  /// Goes on from the present state with another material. `fibres`: (1, 3) or (M, 3) for each family.
  void set_material(const std::string& body, const std::string& law,
                    const std::map<std::string, double>& constants,
                    const std::map<std::string, std::vector<double>>& cell_constants,
                    const std::vector<Array2d<double>>& fibres, const std::optional<double>& density) {
    Description changed = description_;
    MaterialDescription& material = changed.bodies[find_body(body)].material;
    material.place = "material";
    material.law = law;
    material.constants = constants;
    material.cell_constants = cell_constants;
    material.fibres.clear();
    for (const Array2d<double>& family : fibres) material.fibres.push_back(vectors(family));
    if (density) material.density = *density;
    const nb::gil_scoped_release release;
    auto simulation = std::make_shared<Simulation>(changed);
    State state = simulation_->state();
    state.accelerations.resize(0);  // those of the new material
    simulation->resume_from(state, "material", simulation_->failed_steps());
    description_ = std::move(changed);
    simulation_ = std::move(simulation);
  }

  std::size_t find_body(const std::string& name) const {
    std::vector<std::string> names;
    for (std::size_t b = 0; b < world().bodies.size(); ++b) {
      if (world().bodies[b].name == name) return b;
      names.push_back(world().bodies[b].name);
    }
    throw InputError("body", "one of " + join(names), "\"" + name + "\"");
  }

  NumpyArray<Index> cells(const std::string& name) const {
    const Body& body = world().bodies[find_body(name)];
    return numpy_array(body.cells, {static_cast<std::size_t>(body.num_cells()),
                                    static_cast<std::size_t>(num_nodes(body.cell_kind))});
  }

  const Skin& skin(const std::string& name) const {
    const Body& body = world().bodies[find_body(name)];
    if (!body.skin)
      throw InputError("body \"" + name + "\"", "a skin", "none", "its key in the scene is `skin`");
    return *body.skin;
  }

  /// (V, 3) [m]
  NumpyArray<double> skin_positions(const std::string& name) const {
    const Embedding& embedding = skin(name).embedding;
    std::vector<double> places(3 * static_cast<std::size_t>(embedding.num_points()));
    embedding.apply(simulation_->state().positions, places);
    return numpy_array(std::move(places), {static_cast<std::size_t>(embedding.num_points()), 3});
  }

  /// (T, 3), in 2D perhaps (T, 2)
  NumpyArray<Index> skin_facets(const std::string& name) const {
    const CellBlock& facets = skin(name).facets;
    return numpy_array(facets.nodes, {static_cast<std::size_t>(facets.num_cells()),
                                      static_cast<std::size_t>(num_nodes(facets.kind))});
  }

  std::pair<Index, Index> vertex_range(const std::string& name) const {
    const Body& body = world().bodies[find_body(name)];
    return {body.first_node, body.first_node + body.num_nodes};
  }

 private:
  History recorded(const std::optional<std::filesystem::path>& out, const std::optional<std::string>& resume,
                   int max_steps, Interruptible& interruptible, const nb::object& after_step) {
    std::optional<ResultFolder> folder;
    if (out) folder.emplace(*out, setup_seconds_);
    if (resume && folder)
      folder->resume(*simulation_, *resume == "anyway" ? Resume::anyway : Resume::same_scene);
    History history(simulation_);
    const auto record = [&](bool is_last) {
      history.record(*simulation_, is_last);
      if (folder) folder->record(*simulation_, is_last);
    };
    record(false);
    double seconds = setup_seconds_;
    RunOutcome outcome = timed_run(seconds, {.is_stopped = [&] { return interruptible.is_stopped(); },
                                             .after_iteration = {},
                                             .after_step =
                                                 [&](const StepReport&) {
                                                   record(simulation_->is_finished());
                                                   if (!after_step.is_none()) interruptible.call(after_step);
                                                 },
                                             .max_steps = max_steps});
    outcome.warnings.insert(outcome.warnings.begin(), warnings_.begin(), warnings_.end());
    record(true);
    if (folder) folder->finish(*simulation_, outcome);
    history.finish(*simulation_, outcome, seconds, folder ? folder->output_seconds() : 0);
    return history;
  }

  RunOutcome timed_run(double& seconds, const RunHooks& hooks) {
    const Stopwatch stopwatch(seconds);
    return run_to_end(*simulation_, hooks);
  }

  Description description_;
  std::shared_ptr<Simulation> simulation_;
  std::vector<std::string> warnings_;
  double setup_seconds_ = 0;
};

template <class Member>
auto of_state(Member State::* member) {
  return [member](const RunningSimulation& s) { return s.simulation().state().*member; };
}

auto nodal(VectorX State::* member) {
  return [member](const RunningSimulation& s) {
    return node_array(s.simulation().state().*member, s.world().dimension);
  };
}

}  // namespace

void bind_simulation(nb::module_& module) {
  nb::class_<Scene>(module, "Scene");
  module.def(
      "read_scene",
      [](const std::filesystem::path& path, const std::vector<std::string>& overrides) {
        return read_scene(path, {.overrides = overrides});
      },
      nb::arg("path"), nb::arg("overrides"), nb::call_guard<nb::gil_scoped_release>());
  module.def(
      "read_scene_from_values",
      [](const nb::typed<nb::dict, nb::str, nb::object>& values, const std::string& name,
         const std::filesystem::path& folder, const std::vector<std::string>& overrides) {
        return read_scene_from_values(scene_value(values), name, folder, {.overrides = overrides});
      },
      nb::arg("values"), nb::arg("name"), nb::arg("folder"), nb::arg("overrides"));

  bind_history(module);
  nb::class_<RunningSimulation>(module, "Simulation")
      .def(nb::init<const Scene&>(), nb::arg("scene"), nb::call_guard<nb::gil_scoped_release>())
      .def("step", &RunningSimulation::step,
           nb::sig("def step(self) -> tuple[typing.Literal['converged', 'not_converged'], str, int, float]"))
      .def("run", &RunningSimulation::run, nb::arg("out").none(), nb::arg("resume").none(),
           nb::arg("max_steps"), nb::arg("after_step").none())
      .def("set_material", &RunningSimulation::set_material, nb::arg("body"), nb::arg("law"),
           nb::arg("constants"), nb::arg("cell_constants"), nb::arg("fibres"), nb::arg("density").none())
      .def("cells", &RunningSimulation::cells, nb::arg("body"))
      .def("skin_positions", &RunningSimulation::skin_positions, nb::arg("body"))
      .def("skin_facets", &RunningSimulation::skin_facets, nb::arg("body"))
      .def("vertex_range", &RunningSimulation::vertex_range, nb::arg("body"))
      .def("frame",
           [](const RunningSimulation& s) {
             const State& state = s.simulation().state();
             const auto fields = FieldEvaluator(s.world()).evaluate(state, s.world().output.fields);
             return frame_json(s.simulation().frame(), s.world(), state, fields).dump();
           })
      .def(
          "draw",
          [](const RunningSimulation& s, const PictureOptions& options) {
            return draw_state(s.world(), s.simulation().state(), options);
          },
          nb::arg("options"), nb::call_guard<nb::gil_scoped_release>())
      .def("bodies", [](const RunningSimulation& s) { return bodies_json(s.world()).dump(); })
      .def("reached", [](const RunningSimulation& s) { return reached(s.simulation()); })
      .def("positions", nodal(&State::positions))
      .def("velocities", nodal(&State::velocities))
      .def("rest_positions",
           [](const RunningSimulation& s) {
             return node_array(s.world().rest_positions, s.world().dimension);
           })
      .def(
          "field",
          [](const RunningSimulation& s, const std::string& name) {
            return field_array(s.world(), {&s.simulation().state(), 1}, name);
          },
          nb::arg("name"))
      .def_prop_ro("warnings", &RunningSimulation::warnings)
      .def_prop_ro("time", of_state(&State::time))
      .def_prop_ro("load", of_state(&State::load))
      .def_prop_ro("step_number", of_state(&State::step))
      .def_prop_ro("end_time", [](const RunningSimulation& s) { return s.world().end_time; })
      .def_prop_ro("title", [](const RunningSimulation& s) { return s.world().title; })
      .def_prop_ro("is_dynamic", [](const RunningSimulation& s) { return s.world().is_dynamic; })
      .def_prop_ro("is_finished", [](const RunningSimulation& s) { return s.simulation().is_finished(); })
      .def_prop_ro("share_done", [](const RunningSimulation& s) { return s.simulation().share_done(); })
      .def_prop_ro("expected_steps",
                   [](const RunningSimulation& s) { return s.simulation().expected_steps(); });
}

}  // namespace resilin::python
