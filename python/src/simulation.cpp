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
#include "bodies.hpp"
#include "history.hpp"
#include "interruptible.hpp"
#include "played_scene.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/stopwatch.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/results/report.hpp"
#include "resilin/results/result_picture.hpp"
#include "resilin/results/results.hpp"
#include "resilin/results/run.hpp"
#include "resilin/results/step_progress.hpp"
#include "resilin/scene/scene.hpp"
#include "scene_value.hpp"
#include "turns.hpp"

namespace resilin::python {
namespace {

/// A simulation that threads work with in turns: each step, and each look at the state, is whole.
class RunningSimulation {
 public:
  explicit RunningSimulation(const Scene& scene) : warnings_(scene.warnings) {
    const Stopwatch stopwatch(setup_seconds_);
    simulation_ = std::make_shared<Simulation>(scene.description);
    for (std::string& warning : all_warnings(simulation_->world())) warnings_.push_back(std::move(warning));
  }

  const std::vector<std::string>& warnings() const { return warnings_; }

  /// `function(simulation)` in this thread's turn.
  template <class Function>
  auto look(const Function& function) const {
    const Turns::Turn turn(turns_, Turns::Kind::look);
    take_over_what_was_played();
    return function(std::as_const(*simulation_));
  }

  /// The same bodies as a scene to play with. What is done to them there is done to them here, and the other
  /// way round; time and load stay where steps of this simulation have led them.
  std::shared_ptr<PlayedScene> play() {
    const Turns::Turn turn(turns_, Turns::Kind::change);
    if (simulation_->world().modes)
      throw InputError("view", "a static or dynamic scene", "modal analysis",
                       "resilin.LiveScene(scene).view() plays with their scene");
    if (!played_.scene) {
      played_.scene = std::make_shared<PlayedScene>(*simulation_->world().made_from, warnings_);
      hand_over_to_players();
    }
    return played_.scene;
  }

  /// (status, reason, iterations, relative residual). The state stays where it was when Ctrl-C comes.
  std::tuple<std::string, std::string, int, double> step() {
    const Turns::Turn turn(turns_, Turns::Kind::change);
    take_over_what_was_played();
    Interruptible interruptible;
    StepReport report;
    {
      const nb::gil_scoped_release release;
      report = simulation_->step([&](const NewtonReport&) { return !interruptible.is_stopped(); });
    }
    hand_over_to_players();
    interruptible.rethrow();
    return {report.status == StepReport::Status::converged ? "converged" : "not_converged", report.reason,
            report.newton.iterations, report.newton.relative_residual()};
  }

  /// Runs to the end and records. `resume`: null, "same" or "anyway", as after --resume. `after_step` is
  /// called without arguments, and within a step with the share of the run that is done and what the step is
  /// at. Others may look between steps.
  History run(const std::optional<std::filesystem::path>& out, const std::optional<std::string>& resume,
              int max_steps, const nb::object& after_step) {
    const Turns::Turn turn(turns_, Turns::Kind::change);
    take_over_what_was_played();
    const Away away(played_);
    Interruptible interruptible;
    std::optional<History> history;
    {
      const nb::gil_scoped_release release;
      history.emplace(recorded(out, resume, max_steps, interruptible, after_step));
    }
    hand_over_to_players();
    interruptible.rethrow();
    return std::move(*history);
  }

  /// Goes on from the present state with another material. `fibres`: (1, 3) or (M, 3) for each family.
  void set_material(const std::string& body, const std::string& law,
                    const std::map<std::string, double>& constants,
                    const std::map<std::string, std::vector<double>>& cell_constants,
                    const std::vector<Array2d<double>>& fibres, const std::optional<double>& density) {
    const Turns::Turn turn(turns_, Turns::Kind::change);
    take_over_what_was_played();
    Description changed = *simulation_->world().made_from;
    MaterialDescription& material = changed.bodies[find_body(simulation_->world(), body)].material;
    material.place = "material";
    material.law = law;
    material.constants = constants;
    material.cell_constants = cell_constants;
    material.fibres.clear();
    for (const Array2d<double>& family : fibres) material.fibres.push_back(vectors(family));
    if (density) material.density = *density;
    const nb::gil_scoped_release release;
    auto simulation = std::make_shared<Simulation>(std::move(changed));
    State state = simulation_->state();
    state.accelerations.resize(0);  // those of the new material
    simulation->resume_from(state, "material", simulation_->failed_steps());
    simulation_ = std::move(simulation);
    played_ = {};  // it has the old material
  }

 private:
  struct Played {
    std::shared_ptr<PlayedScene> scene;
    std::uint64_t seen = 0;  ///< changes that the simulation has followed
    bool is_away = false;    ///< a run goes its own way until it has come to its end
  };

  struct Away {
    explicit Away(Played& its) : played(its) { played.is_away = true; }
    ~Away() { played.is_away = false; }
    Played& played;
  };

  /// Where players have led the bodies since the last look. Throws InputError where the simulation cannot go
  /// on from there; it is then as before.
  void take_over_what_was_played() const {
    if (!played_.scene || played_.is_away || played_.scene->changes() == played_.seen) return;
    const State before = simulation_->state();
    State state = before;
    const std::uint64_t changes = played_.scene->look([&](const LiveScene& live) {
      state.positions = live.state().positions;
      if (simulation_->world().is_dynamic) state.velocities = live.state().velocities;
      state.history = live.state().history;
      return played_.scene->changes();
    });
    if (state.positions != before.positions || state.velocities != before.velocities)
      go_on_from(before, std::move(state));
    played_.seen = changes;
  }

  void go_on_from(const State& before, State state) const {
    // Nothing was a step that an integrator, or the guess of a load step, could look back to.
    state.previous_positions = state.positions;
    state.previous_velocities.resize(0);
    state.accelerations.resize(0);
    state.previous_time_step = 0;
    state.previous_load = state.load;
    state.arc_length = state.load_weight = 0;
    try {
      simulation_->resume_from(state, "view", simulation_->failed_steps(), simulation_->most_strained());
    } catch (const InputError& error) {
      simulation_->resume_from(before, "view", simulation_->failed_steps(), simulation_->most_strained());
      throw InputError("view", "a state that the simulation can go on from", one_line(error.what()),
                       "reset the scene on its page");
    }
  }

  void hand_over_to_players() {
    if (!played_.scene) return;
    const State& state = simulation_->state();
    const VectorX velocities =
        simulation_->world().is_dynamic ? state.velocities : VectorX(VectorX::Zero(state.positions.size()));
    played_.scene->change([&](LiveScene& live) { live.place(state.positions, velocities, state.time); },
                          /*is_step=*/true);
    played_.seen = played_.scene->changes();
  }

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
    int iterations = 0;  // iterations of the step
    const auto within_step = [&](const NewtonReport& so_far) {
      ++iterations;
      if (after_step.is_none()) return;
      interruptible.call(after_step, simulation_->share_done(),
                         describe_progress(*simulation_, so_far, iterations));
    };
    RunOutcome outcome = timed_run(seconds, {.is_stopped = [&] { return interruptible.is_stopped(); },
                                             .after_iteration = within_step,
                                             .after_step =
                                                 [&](const StepReport&) {
                                                   iterations = 0;
                                                   record(simulation_->is_finished());
                                                   turns_.let_others_look();
                                                   if (!after_step.is_none()) {
                                                     const Turns::Opening opening(turns_);
                                                     interruptible.call(after_step);
                                                   }
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

  std::shared_ptr<Simulation> simulation_;
  mutable Played played_;
  std::vector<std::string> warnings_;
  double setup_seconds_ = 0;
  mutable Turns turns_;
};

const Skin& skin_of(const Simulation& simulation, const std::string& name) {
  const Body& body = body_of(simulation.world(), name);
  if (!body.skin)
    throw InputError("body \"" + name + "\"", "a skin", "none", "its key in the scene is `skin`");
  return *body.skin;
}

/// (V, 3) [m], in the scene's coordinates
NumpyArray<double> skin_positions(const Simulation& simulation, const std::string& name) {
  const Embedding& embedding = skin_of(simulation, name).embedding;
  std::vector<double> places(3 * static_cast<std::size_t>(embedding.num_points()));
  embedding.apply(simulation.state().positions, places);
  for (std::size_t i = 0; i < places.size(); ++i) places[i] += simulation.world().origin[i % 3];
  return numpy_array(std::move(places), {static_cast<std::size_t>(embedding.num_points()), 3});
}

/// (T, 3), in 2D perhaps (T, 2)
NumpyArray<Index> skin_facets(const Simulation& simulation, const std::string& name) {
  const CellBlock& facets = skin_of(simulation, name).facets;
  return numpy_array(facets.nodes, {static_cast<std::size_t>(facets.num_cells()),
                                    static_cast<std::size_t>(num_nodes(facets.kind))});
}

std::string frame(const Simulation& simulation) {
  const World& world = simulation.world();
  const auto fields = FieldEvaluator(world).evaluate(simulation.state(), fields_of_report(world));
  return frame_json(simulation.frame(), world, simulation.state(), fields).dump();
}

// ---- functions of a simulation, in a turn

template <class Result>
auto look(Result (*function)(const Simulation&)) {
  return [function](const RunningSimulation& s) { return s.look(function); };
}

template <class Result>
auto look_at(Result (*function)(const Simulation&, const std::string&)) {
  return [function](const RunningSimulation& s, const std::string& name) {
    return s.look([&](const Simulation& simulation) { return function(simulation, name); });
  };
}

/// A function of the world and a name.
template <class Result>
auto look_at_world(Result (*function)(const World&, const std::string&)) {
  return [function](const RunningSimulation& s, const std::string& name) {
    return s.look([&](const Simulation& simulation) { return function(simulation.world(), name); });
  };
}

template <class Member>
auto of_state(Member State::* member) {
  return [member](const RunningSimulation& s) {
    return s.look([member](const Simulation& simulation) { return simulation.state().*member; });
  };
}

template <class Member>
auto of_world(Member World::* member) {
  return [member](const RunningSimulation& s) {
    return s.look([member](const Simulation& simulation) { return simulation.world().*member; });
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
  bind_live(module);
  nb::class_<RunningSimulation>(module, "Simulation")
      .def(nb::init<const Scene&>(), nb::arg("scene"), nb::call_guard<nb::gil_scoped_release>())
      .def("step", &RunningSimulation::step,
           nb::sig("def step(self) -> tuple[typing.Literal['converged', 'not_converged'], str, int, float]"))
      .def("run", &RunningSimulation::run, nb::arg("out").none(), nb::arg("resume").none(),
           nb::arg("max_steps"), nb::arg("after_step").none())
      .def("play", &RunningSimulation::play)
      .def("set_material", &RunningSimulation::set_material, nb::arg("body"), nb::arg("law"),
           nb::arg("constants"), nb::arg("cell_constants"), nb::arg("fibres"), nb::arg("density").none())
      .def("cells", look_at_world(&cells_of), nb::arg("body"))
      .def("skin_positions", look_at(&skin_positions), nb::arg("body"))
      .def("skin_facets", look_at(&skin_facets), nb::arg("body"))
      .def("vertex_range", look_at_world(&vertex_range_of), nb::arg("body"))
      .def("frame", look(&frame))
      .def(
          "draw",
          [](const RunningSimulation& s, const PictureOptions& options) {
            return s.look([&](const Simulation& simulation) {
              const nb::gil_scoped_release release;
              return draw_state(simulation.world(), simulation.state(), options);
            });
          },
          nb::arg("options"))
      .def("bodies", look(+[](const Simulation& s) { return bodies_json(s.world()).dump(); }))
      .def("fixes", look(+[](const Simulation& s) { return fixes_json(s.world()).dump(); }))
      .def("loads", look(+[](const Simulation& s) { return loads_json(s.world()).dump(); }))
      .def("reached", look(&reached))
      .def("positions",
           look(+[](const Simulation& s) { return place_array(s.world(), s.state().positions); }))
      .def("velocities",
           look(+[](const Simulation& s) { return node_array(s.state().velocities, s.world().dimension); }))
      .def("rest_positions",
           look(+[](const Simulation& s) { return place_array(s.world(), s.world().rest_positions); }))
      .def("field", look_at(+[](const Simulation& s, const std::string& name) {
             return field_array(s.world(), {&s.state(), 1}, name);
           }),
           nb::arg("name"))
      .def_prop_ro("warnings", &RunningSimulation::warnings)
      .def_prop_ro("time", of_state(&State::time))
      .def_prop_ro("load", of_state(&State::load))
      .def_prop_ro("step_number", of_state(&State::step))
      .def_prop_ro("end_time", of_world(&World::end_time))
      .def_prop_ro("title", of_world(&World::title))
      .def_prop_ro("is_dynamic", of_world(&World::is_dynamic))
      .def_prop_ro("is_finished", look(+[](const Simulation& s) { return s.is_finished(); }))
      .def_prop_ro("share_done", look(+[](const Simulation& s) { return s.share_done(); }))
      .def_prop_ro("expected_steps", look(+[](const Simulation& s) { return s.expected_steps(); }));
}

}  // namespace resilin::python
