#include "differentiated_run.hpp"
#include "resilin/core/error.hpp"
#include "resilin/sensitivity/rest_shape.hpp"

namespace resilin::python {
namespace {

/// (name, rest, deformed) of each body, then distance, size, iterations, colliders that were kept off with
/// their activation distances, and warnings. `on_progress`: null, or called with a share and a text.
std::tuple<std::vector<std::tuple<std::string, NumpyArray<double>, NumpyArray<double>>>, double, double, int,
           std::vector<std::pair<std::string, double>>, std::vector<std::string>>
rest_shape(const Scene& scene, const nb::object& on_progress) {
  RestShape found;
  Interruptible interruptible;
  std::exception_ptr failure;
  {
    const nb::gil_scoped_release release;
    try {
      found = find_rest_shape(scene.description, {.goes_on = [&](const RestShapeProgress& progress) {
                                if (!on_progress.is_none())
                                  interruptible.call(on_progress, progress.share, progress.text());
                                return !interruptible.is_stopped();
                              }});
    } catch (...) {
      failure = std::current_exception();
    }
  }
  interruptible.rethrow();
  if (failure) std::rethrow_exception(failure);
  std::vector<std::tuple<std::string, NumpyArray<double>, NumpyArray<double>>> bodies;
  const int dim = scene.description.dimension;
  for (const RestShape::OfBody& body : found.bodies)
    bodies.emplace_back(body.name, node_array(body.rest, dim), node_array(body.deformed, dim));
  return {std::move(bodies), found.distance, found.size, found.iterations, found.kept_off, found.warnings};
}

/// (T, N, d) of a run's places at the frames that the scene asks for, and whether there may be so many
/// numbers for the parameters of these names.
std::tuple<int, Index, int> simulation_shape(const Scene& scene,
                                             const std::map<std::string, Eigen::Index>& counts) {
  const Simulation simulation{Description(scene.description)};
  const World& world = simulation.world();
  for (const auto& [name, count] : counts) find_parameter_of(world, name, count);
  return {(world.is_dynamic ? simulation.expected_steps() : world.load_steps) + 1, world.num_nodes(),
          world.dimension};
}

}  // namespace

void bind_derivatives(nb::module_& module) {
  module.def(
      "parameter_names",
      [](const Scene& scene) { return parameter_names(World(Description(scene.description))); },
      nb::arg("scene"), nb::call_guard<nb::gil_scoped_release>());
  module.def("simulation_shape", &simulation_shape, nb::arg("scene"), nb::arg("counts"),
             nb::call_guard<nb::gil_scoped_release>());
  module.def("find_rest_shape", &rest_shape, nb::arg("scene"), nb::arg("on_progress").none());
  nb::class_<DifferentiatedRun>(module, "DifferentiatedRun")
      .def(nb::init<const Scene&, const std::vector<std::string>&,
                    const std::map<std::string, Vector1d<double>>&, int>(),
           nb::arg("scene"), nb::arg("wrt"), nb::arg("values"), nb::arg("checkpoints"))
      .def("parameters", &DifferentiatedRun::parameters)
      .def("supports", &DifferentiatedRun::supports)
      .def("positions", &DifferentiatedRun::positions, nb::arg("frame"))
      .def("velocities", &DifferentiatedRun::velocities, nb::arg("frame"))
      .def("time_and_load", &DifferentiatedRun::time_and_load, nb::arg("frame"))
      .def("reactions", &DifferentiatedRun::reactions, nb::arg("frame"))
      .def("vertex_range", &DifferentiatedRun::vertex_range, nb::arg("body"))
      .def("transposed", &DifferentiatedRun::transposed, nb::arg("frames"))
      .def("forward", &DifferentiatedRun::forward, nb::arg("changes"))
      .def("markers", &DifferentiatedRun::markers, nb::arg("body"), nb::arg("at"))
      .def("rest_position", &DifferentiatedRun::rest_position, nb::arg("node"))
      .def("probe", &DifferentiatedRun::probe, nb::arg("name"))
      .def("energy", &DifferentiatedRun::energy, nb::arg("kind"), nb::arg("body").none(), nb::arg("frame"))
      .def("stress", &DifferentiatedRun::stress, nb::arg("body"), nb::arg("at"), nb::arg("component"),
           nb::arg("frame"))
      .def("section", &DifferentiatedRun::section, nb::arg("name"), nb::arg("frame"))
      .def("moment", &DifferentiatedRun::moment, nb::arg("name"), nb::arg("frame"))
      .def("colliders", &DifferentiatedRun::colliders)
      .def("collider_force", &DifferentiatedRun::collider_force, nb::arg("name"), nb::arg("frame"))
      .def("volume", &DifferentiatedRun::volume, nb::arg("body"), nb::arg("frame"))
      .def_prop_ro("warnings", &DifferentiatedRun::warnings)
      .def_prop_ro("asked_frames", &DifferentiatedRun::asked_frames)
      .def_prop_ro("num_steps_beside_way", &DifferentiatedRun::num_steps_beside_way)
      .def_prop_ro("num_frames", &DifferentiatedRun::num_frames);
}

}  // namespace resilin::python
