#include "resilin/results/report.hpp"

#include <sys/resource.h>

#include "resilin/core/parallel.hpp"
#include "resilin/fields/contact_traction.hpp"
#include "resilin/fields/extremes.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/results/mesh_volume_ratio.hpp"
#include "resilin/world/resultants.hpp"

namespace resilin {
namespace {

Json vector_json(const Vector3& vector, int dimension) {
  Json list = Json::array();
  for (int i = 0; i < dimension; ++i) list.push_back(vector[i]);
  return list;
}

/// Three numbers; in 2D the one about the plane's normal.
Json moment_json(const Vector3& moment, int dimension) {
  return dimension == 3 ? vector_json(moment, 3) : Json::array({moment[2]});
}

Json mode_json(const Frame::ModeValues& mode, int dimension) {
  Json json = {{"number", mode.number},
               {"frequency", mode.frequency},
               {"rigid", mode.is_rigid},
               {"unstable", mode.is_unstable},
               {"effective_mass", vector_json(mode.effective_mass, dimension)}};
  if (mode.is_unstable) json["growth_rate"] = mode.growth_rate;
  return json;
}

Json extreme_json(const World& world, const Extreme& extreme, bool is_on_nodes) {
  return {{"value", extreme.value},
          {"body", world.bodies[extreme.body].name},
          {is_on_nodes ? "vertex" : "cell", extreme.number},
          {"position", vector_json(extreme.position, world.dimension)}};
}

}  // namespace

std::string_view name(RunStatus status) {
  switch (status) {
    case RunStatus::running:
      return "running";
    case RunStatus::done:
      return "done";
    case RunStatus::not_converged:
      return "not_converged";
    case RunStatus::failed:
      return "failed";
    case RunStatus::budget:
      return "budget";
  }
  return "";
}

Json frame_json(const Frame& frame, int dimension) {
  Json json;
  json["step"] = frame.step;
  if (!frame.step_name.empty()) json["step_name"] = frame.step_name;
  json["time"] = frame.time;
  json["load"] = frame.load;
  if (frame.mode) json["mode"] = mode_json(*frame.mode, dimension);
  json["newton_iterations"] = frame.newton_iterations;
  json["linear_iterations"] = frame.linear_iterations;
  json["converged"] = frame.converged;
  json["residual"] = frame.residual;
  json["residual_newton"] = frame.residual_newton;
  json["failed_attempts"] = frame.failed_attempts;
  if (frame.time_step > 0) json["time_step"] = frame.time_step;
  if (frame.time_error > 0) json["time_error"] = frame.time_error;
  json["unstable_modes"] = frame.unstable_modes ? Json(*frame.unstable_modes) : Json(nullptr);
  if (frame.jump_energy > 0) json["jump_energy"] = frame.jump_energy;
  if (frame.inversion) json["inversion_load"] = frame.inversion->load;
  json["min_volume_ratio"] = frame.min_volume_ratio;
  json["worst_cell"] = frame.worst_cell;
  json["worst_body"] = frame.worst_body;
  json["energy"] = {{"elastic", frame.elastic_energy},   {"kinetic", frame.kinetic_energy},
                    {"external", frame.external_energy}, {"contact", frame.contact_energy},
                    {"total", frame.total_energy()},     {"dissipated", frame.dissipated_energy},
                    {"friction", frame.friction_work}};
  json["momentum"]["linear"] = vector_json(frame.linear_momentum, dimension);
  json["momentum"]["angular"] = moment_json(frame.angular_momentum, dimension);
  json["probes"] = Json::object();
  for (const Frame::ProbeValue& probe : frame.probes) {
    json["probes"][probe.name] = {{"displacement", vector_json(probe.displacement, dimension)},
                                  {"velocity", vector_json(probe.velocity, dimension)}};
  }
  json["reactions"] = Json::object();
  for (const auto& [name, force] : frame.reactions) json["reactions"][name] = vector_json(force, dimension);
  json["reaction_moments"] = Json::object();
  for (std::size_t i = 0; i < frame.reactions.size(); ++i) {
    json["reaction_moments"][frame.reactions[i].first] = moment_json(frame.reaction_torques[i], dimension);
  }
  for (const Frame::RigidMotion& body : frame.rigid_bodies) {
    json["rigid_bodies"][body.name] = {{"position", vector_json(body.position, dimension)},
                                       {"rotation", body.rotation},
                                       {"velocity", vector_json(body.velocity, dimension)},
                                       {"angular_velocity", moment_json(body.angular_velocity, dimension)}};
  }
  for (const JointForce& joint : frame.joints) {
    Json& entry = json["joints"][joint.name];
    entry = {{"force", vector_json(joint.force, dimension)},
             {"moment", moment_json(joint.moment, dimension)},
             {"value", joint.value},
             {"gap", joint.gap}};
    if (joint.angle) entry["angle"] = *joint.angle;
  }
  for (const Frame::CableForce& cable : frame.cables) {
    Json& entry = json["cables"][cable.name];
    entry = {{"force", cable.force}, {"length", cable.length}};
    if (!cable.tensions.empty()) entry["tensions"] = cable.tensions;
  }
  for (const auto& [body, region, elastic_energy] : frame.regions)
    json["regions"][body][region]["energy"] = elastic_energy;
  json["sections"] = Json::object();
  for (const SectionForce& section : frame.sections) {
    json["sections"][section.name] = {{"force", vector_json(section.force, dimension)},
                                      {"moment", moment_json(section.moment, dimension)},
                                      {"center", vector_json(section.center, dimension)}};
  }
  return json;
}

namespace {

Json extremes_json(const World& world, const State& state, std::span<const FieldValues> fields) {
  Json json = Json::object();
  for (const FieldValues& values : fields) {
    const std::optional<Extremes> found = extremes(world, state, values);
    if (!found) continue;
    const bool is_on_nodes = values.field->is_on_nodes();
    json[values.field->name] = {{"min", extreme_json(world, found->min, is_on_nodes)},
                                {"max", extreme_json(world, found->max, is_on_nodes)}};
  }
  return json;
}

const std::string& body_name(const World& world, Index body) {
  return world.bodies[static_cast<std::size_t>(body)].name;
}

void add_patch(const ContactPatch& patch, int dimension, Json& json) {
  json["area"] = patch.area;
  json["reference_area"] = patch.reference_area;
  if (dimension == 2) json["width"] = patch.width;
  json["pressure"] = patch.largest_pressure;
  json["mean_pressure"] = patch.mean_pressure();
  json["normal_force"] = patch.force;
  json["center"] = vector_json(patch.center, dimension);
  json["extent"] = vector_json(patch.extent, dimension);
}

Json contacts_json(const Frame& frame, const World& world, std::span<const ContactPatch> patches) {
  Json list = Json::array();
  for (const SurfaceContact::BodyContact& contact : frame.contacts) {
    list.push_back({{"bodies", {body_name(world, contact.body), body_name(world, contact.other)}},
                    {"force", vector_json(contact.force, world.dimension)},
                    {"gap", contact.gap},
                    {"pairs", contact.num_pairs}});
    for (const ContactPatch& patch : patches)
      if (patch.body == contact.body && patch.other == contact.other)
        add_patch(patch, world.dimension, list.back());
  }
  return list;
}

Json collider_contacts_json(const Frame& frame, const World& world, std::span<const ContactPatch> patches) {
  Json json = Json::object();
  for (const ContactPatch& patch : patches) {
    if (patch.collider.empty()) continue;
    for (const auto& [name, force] : frame.reactions)
      if (name == patch.collider) json[name]["force"] = vector_json(force, world.dimension);
    add_patch(patch, world.dimension, json[patch.collider]);
  }
  return json;
}

}  // namespace

Json frame_json(const Frame& frame, const World& world, const State& state,
                std::span<const FieldValues> fields) {
  Json json = frame_json(frame, world.dimension);
  const std::vector<ContactPatch> patches =
      world.share.is_whole() ? contact_patches(world, state) : std::vector<ContactPatch>();
  json["contacts"] = contacts_json(frame, world, patches);
  if (Json of_colliders = collider_contacts_json(frame, world, patches); !of_colliders.empty())
    json["collider_contacts"] = std::move(of_colliders);
  json["extremes"] = extremes_json(world, state, fields);
  return json;
}

namespace {

Json constants_json(const Domain& domain) {
  Json constants = Json::object();
  for (const auto& [name, value] : domain.constants) constants[name] = value;
  return constants;
}

/// The domains of a body that has regions; its own material under the name "".
Json regions_json(const Body& body) {
  Json list = Json::array();
  for (const Domain& domain : body.domains) {
    const double volume = domain.energy->total_rest_volume();
    list.push_back({{"name", domain.name},
                    {"law", domain.law},
                    {"constants", constants_json(domain)},
                    {"density", domain.density},
                    {"cells", domain.energy->num_cells()},
                    {"volume", volume},
                    {"mass", domain.density * volume}});
  }
  return list;
}

}  // namespace

Json bodies_json(const World& world) {
  Json list = Json::array();
  for (const Body& body : world.bodies) {
    list.push_back({{"name", body.name},
                    {"law", body.domains.front().law},
                    {"constants", constants_json(body.domains.front())},
                    {"element", body.element},
                    {"element_reason", body.element_reason},
                    {"quadrature", body.domains.quadrature().name},
                    {"mass", spelling(body.mass_kind)},
                    {"cells", body.num_cells()},
                    {"vertices", body.num_vertices},
                    {"unknowns", Offset{body.num_nodes} * world.dimension}});
    if (body.has_regions()) list.back()["regions"] = regions_json(body);
  }
  return list;
}

namespace {

/// Selections of loads and boundary conditions, and the resultants of loads.
Json resultants_json(const std::vector<Resultant>& resultants, int dim) {
  Json list = Json::array();
  for (const Resultant& on : resultants) {
    list.push_back({{"name", on.name},
                    {"nodes", on.num_nodes},
                    {"facets", on.num_facets},
                    {"area", on.area},
                    {"center", vector_json(on.center, dim)}});
    if (on.kind == "fix") continue;
    list.back()["kind"] = on.kind;
    list.back()["force"] = on.force ? vector_json(*on.force, dim) : Json(nullptr);
    list.back()["moment"] = on.force ? moment_json(on.moment, dim) : Json(nullptr);
  }
  return list;
}

}  // namespace

Json fixes_json(const World& world) { return resultants_json(fixed_selections(world), world.dimension); }

Json loads_json(const World& world) { return resultants_json(load_resultants(world), world.dimension); }

namespace {

void add_stiffness(const SupportStiffness& stiffness, int dimension, Json& fix) {
  const auto n = static_cast<std::size_t>(dimension);
  Json rows = Json::array();
  for (std::size_t row = 0; row < n; ++row) {
    rows.push_back(Json::array());
    for (std::size_t k = 0; k < n; ++k) rows.back().push_back(stiffness.by_displacement[row * n + k]);
  }
  fix["stiffness"] = std::move(rows);
  if (stiffness.by_rotation) fix["rotational_stiffness"] = *stiffness.by_rotation;
}

}  // namespace

Json report_json(const World& world, Json frames, const RunSummary& summary) {
  Json report;
  report["status"] = name(summary.outcome.status);
  report["reason"] = summary.outcome.reason;
  report["warnings"] = summary.outcome.warnings;
  report["title"] = world.title;
  report["version"] = version();
  report["dimension"] = world.dimension;
  report["kind"] = world.modes ? "modes" : world.is_dynamic ? "dynamic" : "static";
  if (world.modes) {
    report["modes"] = Json::array();
    for (const Json& frame : frames)
      if (frame.contains("mode")) report["modes"].push_back(frame["mode"]);
  }
  report["is_linear"] = is_linear(world);
  report["frames"] = std::move(frames);
  report["bodies"] = bodies_json(world);
  const bool has_ended = summary.outcome.status != RunStatus::running;
  const bool tells_conditions = has_ended && world.share.is_whole();
  report["fixes"] = tells_conditions ? fixes_json(world) : Json::array();
  for (Json& fix : report["fixes"])
    for (const SupportStiffness& stiffness : summary.outcome.stiffness)
      if (fix["name"] == stiffness.name) add_stiffness(stiffness, world.dimension, fix);
  report["loads"] = tells_conditions ? loads_json(world) : Json::array();
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const DiscretisationErrors& errors = summary.outcome.discretisation_errors;
    const auto error = b < errors.size() ? errors[b] : std::nullopt;
    const bool is_told = error && error->share != cannot_tell;
    report["bodies"][b]["discretisation_error"] = is_told ? Json(error->share) : Json(nullptr);
    report["bodies"][b]["discretisation_error_by"] = is_told ? Json(name(error->estimate)) : Json(nullptr);
    const std::optional<double> ratio = has_ended ? mesh_volume_ratio(world, world.bodies[b]) : std::nullopt;
    report["bodies"][b]["mesh_volume_ratio"] = ratio ? Json(*ratio) : Json(nullptr);
  }
  if (const SmallestVolume& smallest = summary.most_strained.smallest_volume; smallest.cell >= 0)
    report["smallest_volume_ratio"] = {{"value", smallest.ratio}, {"body", body_name(world, smallest.body)},
                                       {"cell", smallest.cell},   {"step", smallest.step},
                                       {"time", smallest.time},   {"load", smallest.load}};
  report["solver"] = summary.solver;
  report["timing"] = {{"total", summary.total_seconds},
                      {"assembly", summary.timing.assembly},
                      {"solve", summary.timing.solve},
                      {"estimate", summary.outcome.estimate_seconds},
                      {"output", summary.output_seconds}};
  report["peak_memory_MiB"] = peak_memory_MiB();
  report["threads"] = num_threads();
  return report;
}

std::string report_text(const Json& report) {
  std::string text = "{";
  for (const auto& [key, value] : report.items()) {
    text += (text.size() > 1 ? ",\n " : "\n ") + Json(key).dump() + ": ";
    if (!value.is_array()) {
      text += value.dump();
      continue;
    }
    text += '[';
    for (std::size_t i = 0; i < value.size(); ++i) text += (i > 0 ? ",\n  " : "\n  ") + value[i].dump();
    text += ']';
  }
  return text + "\n}\n";
}

double peak_memory_MiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

}  // namespace resilin
