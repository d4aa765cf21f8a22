#include "resilin/world/description_image.hpp"

#include <algorithm>

#include "resilin/core/archive.hpp"
#include "resilin/core/hash.hpp"
#include "resilin/mesh/mesh_members.hpp"

namespace resilin {

// The members of each struct, in the order of its declaration.

template <OneOf<Where> T>
auto members(T& where) {
  auto& [kind, group, min, max, axis, at, tolerance, center, radius, vertices] = where;
  return std::tie(kind, group, min, max, axis, at, tolerance, center, radius, vertices);
}

template <OneOf<MaterialDescription> T>
auto members(T& material) {
  auto& [place, law, constants, cell_constants, fibres, density] = material;
  return std::tie(place, law, constants, cell_constants, fibres, density);
}

template <OneOf<Rotation> T>
auto members(T& rotation) {
  auto& [axis, center, degrees] = rotation;
  return std::tie(axis, center, degrees);
}

template <OneOf<DampingDescription> T>
auto members(T& damping) {
  auto& [mass, stiffness, shear_viscosity, bulk_viscosity] = damping;
  return std::tie(mass, stiffness, shear_viscosity, bulk_viscosity);
}

template <OneOf<SkinDescription> T>
auto members(T& skin) {
  auto& [place, surface, surface_name, is_smooth] = skin;
  return std::tie(place, surface, surface_name, is_smooth);
}

template <OneOf<BodyDescription> T>
auto members(T& body) {
  auto& [place, name, mesh, mesh_name, element, quadrature, material, scale, rotate, translate, velocity,
         velocity_gradient, initial_positions, initial_velocities, mass, damping, skin] = body;
  return std::tie(place, name, mesh, mesh_name, element, quadrature, material, scale, rotate, translate,
                  velocity, velocity_gradient, initial_positions, initial_velocities, mass, damping, skin);
}

template <OneOf<TimeFunction::Constant> T>
auto members(T&) {
  return std::tie();
}

template <OneOf<TimeFunction::Table> T>
auto members(T& table) {
  auto& [times, values] = table;
  return std::tie(times, values);
}

template <OneOf<TimeFunction::Sine> T>
auto members(T& sine) {
  auto& [frequency, amplitude, phase, offset] = sine;
  return std::tie(frequency, amplitude, phase, offset);
}

template <OneOf<TimeFunction::Ramp> T>
auto members(T& ramp) {
  auto& [from, until] = ramp;
  return std::tie(from, until);
}

template <OneOf<TimeFunction> T>
auto members(T& function) {
  auto& [form] = function;
  return std::tie(form);
}

template <OneOf<FixDescription> T>
auto members(T& fix) {
  auto& [place, name, body, where, components, displacement, gradient, rotate, velocity, until,
         time_function] = fix;
  return std::tie(place, name, body, where, components, displacement, gradient, rotate, velocity, until,
                  time_function);
}

template <OneOf<LoadDescription> T>
auto members(T& load) {
  auto& [place, name, body, kind, where, value, pressure, stiffness, displacement, velocity, from, until,
         time_function] = load;
  return std::tie(place, name, body, kind, where, value, pressure, stiffness, displacement, velocity, from,
                  until, time_function);
}

template <OneOf<ShapeDescription> T>
auto members(T& shape) {
  auto& [point, normal, center, radius] = shape;
  return std::tie(point, normal, center, radius);
}

template <OneOf<ColliderDescription> T>
auto members(T& collider) {
  auto& [place, name, kind, shape, velocity, until, activation_distance, stiffness] = collider;
  return std::tie(place, name, kind, shape, velocity, until, activation_distance, stiffness);
}

template <OneOf<ProbeDescription> T>
auto members(T& probe) {
  auto& [place, name, body, at] = probe;
  return std::tie(place, name, body, at);
}

template <OneOf<SectionDescription> T>
auto members(T& section) {
  auto& [place, name, body, axis, at] = section;
  return std::tie(place, name, body, axis, at);
}

template <OneOf<NewtonOptions> T>
auto members(T& newton) {
  auto& [tolerance, max_iterations, projection, inversion_bound] = newton;
  return std::tie(tolerance, max_iterations, projection, inversion_bound);
}

template <OneOf<SolverOptions> T>
auto members(T& solver) {
  auto& [kind, max_iterations] = solver;
  return std::tie(kind, max_iterations);
}

template <OneOf<OutputOptions> T>
auto members(T& output) {
  auto& [every, fields, formats] = output;
  return std::tie(every, fields, formats);
}

template <OneOf<AdaptiveSteps> T>
auto members(T& adaptive) {
  auto& [tolerance, min_step, max_step] = adaptive;
  return std::tie(tolerance, min_step, max_step);
}

template <OneOf<ModesOptions> T>
auto members(T& modes) {
  auto& [count, is_loaded] = modes;
  return std::tie(count, is_loaded);
}

template <OneOf<Description> T>
auto members(T& description) {
  auto& [place, title, is_dynamic, dimension, gravity, time_step, end_time, integrator, adaptive, modes,
         load_steps, load_control, max_steps, unstable_modes, bodies, fixes, loads, colliders, probes,
         sections, newton, solver, output] = description;
  return std::tie(place, title, is_dynamic, dimension, gravity, time_step, end_time, integrator, adaptive,
                  modes, load_steps, load_control, max_steps, unstable_modes, bodies, fixes, loads, colliders,
                  probes, sections, newton, solver, output);
}

namespace {

constexpr std::string_view magic = "resilin scene 1\n";

}  // namespace

std::string serialize(const Description& description) {
  ArchiveWriter writer;
  writer(description);
  const std::string content = writer.take();
  const std::uint64_t sum = hash_of(content);
  return std::string(magic) + std::string(reinterpret_cast<const char*>(&sum), sizeof(sum)) + content;
}

Description deserialize_description(std::string_view image, const std::string& place) {
  if (!image.starts_with(magic))
    throw InputError(place, "a scene as this version of the program keeps it", "something else",
                     "run the scene again");
  ArchiveReader reader(image.substr(magic.size()), place, "run the scene again");
  std::uint64_t sum = 0;
  reader(sum);
  if (sum != hash_of(image.substr(magic.size() + sizeof(sum)))) reader.fail();
  Description description;
  reader(description);
  const bool is_sound = std::ranges::all_of(description.bodies, [](const BodyDescription& body) {
    return body.mesh.is_whole() && (!body.skin || body.skin->surface.is_whole());
  });
  if (!reader.is_at_end() || !is_sound) reader.fail();
  return description;
}

}  // namespace resilin
