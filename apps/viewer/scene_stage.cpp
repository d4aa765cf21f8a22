#include "scene_stage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/live/live_controls.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/view/frame_codec.hpp"
#include "resilin/view/header.hpp"

namespace resilin::viewer {
namespace {

using Json = nlohmann::json;

Json numbers(const Vector3& vector) { return {vector.x(), vector.y(), vector.z()}; }

std::string title_of(const World& world) {
  return world.title.empty() ? std::filesystem::path(world.place).filename().string() : world.title;
}

/// Where the lowest vertex is at rest, along `up` [m].
double lowest(const ShownSurface& surface, const Vector3& up) {
  double lowest = std::numeric_limits<double>::infinity();
  const std::span<const float> x = surface.rest_positions();
  for (std::size_t i = 0; i < x.size(); i += 3) {
    const Vector3 vertex(static_cast<double>(x[i]), static_cast<double>(x[i + 1]),
                         static_cast<double>(x[i + 2]));
    lowest = std::min(lowest, vertex.dot(up));
  }
  return lowest;
}

Json laws_to_choose() {
  Json laws = Json::array();
  for (const LawInfo* law : live_laws()) laws.push_back({{"name", law->name}, {"label", law->title}});
  return laws;
}

}  // namespace

SceneStage::Loaded::Loaded(Scene scene)
    : warnings(std::move(scene.warnings)),
      live(scene.description),
      surface(live.world()),
      fields(live.world(), surface) {
  const std::vector<std::string>& more = live.world().warnings;
  warnings.insert(warnings.end(), more.begin(), more.end());
  ground_height = live.controls().ground.value_or(lowest(surface, live.up()));
  const auto num_vertices = static_cast<std::size_t>(surface.num_vertices());
  positions.resize(3 * num_vertices);
  if (surface.dimension() == 3) normals.resize(3 * num_vertices);
  field.resize(num_vertices);
}

SceneStage::SceneStage(std::function<Scene()> read)
    : read_(std::move(read)), loaded_(std::make_unique<Loaded>(read_())) {}

Json SceneStage::header() const {
  const std::vector<const FieldInfo*> fields = SurfaceFields::known();
  Json header = Json::parse(encode_header({.title = title_of(world()),
                                           .version = std::string(version()),
                                           .up = loaded_->live.up(),
                                           .gravity = loaded_->live.controls().gravity,
                                           .fields = fields},
                                          world(), loaded_->surface));
  header["laws"] = laws_to_choose();
  return header;
}

std::string SceneStage::topology() const { return encode_topology(loaded_->surface); }

std::vector<std::string> SceneStage::field_names() const {
  std::vector<std::string> names;
  for (const FieldInfo* field : SurfaceFields::known()) names.push_back(field->name);
  return names;
}

Json SceneStage::state() const {
  const LiveControls& controls = loaded_->live.controls();
  Json pinned = Json::array();
  for (const Index node : loaded_->live.pinned()) pinned.push_back(loaded_->vertex_of_node.at(node));
  return {{"youngs_modulus", controls.youngs_modulus},
          {"poissons_ratio", controls.poissons_ratio},
          {"law", controls.law},
          {"damping", controls.damping},
          {"gravity", numbers(controls.gravity)},
          {"time_step", controls.time_step},
          {"max_force", controls.max_force},
          {"ground", controls.ground.has_value()},
          {"ground_height", loaded_->ground_height},
          {"newton_limit", controls.newton_limit},
          {"tolerance", controls.tolerance},
          {"pinned", std::move(pinned)},
          {"poking", is_poking()},
          {"warnings", loaded_->warnings}};
}

Json SceneStage::status() const {
  const LiveReport& report = loaded_->live.report();
  return {{"time", time()},
          {"step_ms", report.step_ms},
          {"assembly_ms", report.assembly_ms},
          {"solve_ms", report.solve_ms},
          {"other_ms", std::max(0.0, report.step_ms - report.assembly_ms - report.solve_ms)},
          {"newton_iterations", report.newton_iterations},
          {"linear_iterations", report.linear_iterations},
          {"residual", report.residual},
          {"relative_residual", report.relative_residual},
          {"min_volume_ratio", report.min_volume_ratio},
          {"inverted_cells", report.inverted_cells},
          {"converged", report.converged},
          {"at_rest", report.at_rest},
          {"elastic_energy", report.elastic_energy},
          {"kinetic_energy", report.kinetic_energy},
          {"words", report.words}};
}

void SceneStage::step(double seconds) {
  const State& state = loaded_->live.state();
  loaded_->previous_positions = state.positions;
  loaded_->previous_time = state.time;
  loaded_->live.step({seconds});
}

void SceneStage::forget_previous_state() {
  loaded_->previous_positions.resize(0);
  loaded_->previous_time = loaded_->live.state().time;
}

void SceneStage::apply(const PageMessage& message) {
  Loaded& loaded = *loaded_;
  if (const auto* taken = std::get_if<Grab>(&message)) {
    grab(*taken);
  } else if (const auto* drag = std::get_if<Drag>(&message)) {
    loaded.live.drag(checked_place(drag->target, "drag: target") + loaded.grab_offset);
  } else if (std::holds_alternative<Release>(message)) {
    loaded.live.release();
  } else if (const auto* pin = std::get_if<Pin>(&message)) {
    const Index node = loaded.surface.nearest_node(checked_vertex(pin->vertex, "pin"));
    loaded.vertex_of_node[node] = pin->vertex;
    loaded.live.pin(node);
  } else if (const auto* unpin = std::get_if<Unpin>(&message)) {
    loaded.live.unpin(loaded.surface.nearest_node(checked_vertex(unpin->vertex, "unpin")));
  } else if (std::holds_alternative<UnpinAll>(message)) {
    loaded.live.unpin_all();
  } else if (const auto* poke = std::get_if<Poke>(&message)) {
    loaded.live.poke(checked_place(poke->center, "poke: center"), poke->radius);
  } else if (std::holds_alternative<PokeEnd>(message)) {
    loaded.live.stop_poking();
  } else if (const auto* control = std::get_if<SetControl>(&message)) {
    set(*control);
  } else if (std::holds_alternative<Reset>(message)) {
    loaded.live.reset();
    forget_previous_state();
  } else if (std::holds_alternative<Reload>(message)) {
    loaded_ = std::make_unique<Loaded>(read_());
  }
}

/// The hand holds the vertex and keeps its distance from the place where the pointer hit, so that taking hold
/// moves nothing.
void SceneStage::grab(const Grab& grab) {
  Loaded& loaded = *loaded_;
  const Vector3 point = checked_place(grab.point, "grab: point");
  const auto held = loaded.surface.material_point(checked_vertex(grab.vertex, "grab"));
  const MaterialPoint place{held.nodes, held.weights};
  const Vector3 position = place.position(world().dimension, loaded.live.state().positions);
  loaded.live.grab(place, position);
  loaded.grab_offset = position - point;
}

void SceneStage::set(const SetControl& set) {
  LiveControls controls = loaded_->live.controls();
  double ground_height = loaded_->ground_height;
  const std::map<std::string_view, double*> plain = {{"youngs_modulus", &controls.youngs_modulus},
                                                     {"poissons_ratio", &controls.poissons_ratio},
                                                     {"damping", &controls.damping},
                                                     {"time_step", &controls.time_step},
                                                     {"max_force", &controls.max_force},
                                                     {"ground_height", &ground_height},
                                                     {"tolerance", &controls.tolerance}};
  if (const auto number = plain.find(set.key); number != plain.end()) {
    *number->second = std::get<double>(set.value);
    if (controls.ground) controls.ground = ground_height;
  } else if (set.key == "law") {
    controls.law = std::get<std::string>(set.value);
  } else if (set.key == "gravity") {
    controls.gravity = std::get<Vector3>(set.value);
  } else if (set.key == "ground") {
    controls.ground = std::get<bool>(set.value) ? std::optional(ground_height) : std::nullopt;
  } else if (set.key == "newton_limit") {
    const double limit = std::get<double>(set.value);
    if (!(limit >= 0 && limit <= 1000 && limit == std::floor(limit))) {
      throw InputError("newton_limit", "a whole number from 0 to 1000", format_short(limit));
    }
    controls.newton_limit = static_cast<int>(limit);
  }
  loaded_->live.set_controls(controls);
  loaded_->ground_height = ground_height;
}

Index SceneStage::checked_vertex(std::uint32_t vertex, const char* what) const {
  if (vertex >= static_cast<std::uint32_t>(num_vertices())) {
    throw InputError(std::string(what) + ": vertex",
                     "a number from 0 to " + std::to_string(num_vertices() - 1), std::to_string(vertex));
  }
  return static_cast<Index>(vertex);
}

Vector3 SceneStage::checked_place(const Vector3& place, const char* what) const {
  const double reach = 1000 * world().largest_extent();
  if (!(place.cwiseAbs().maxCoeff() <= reach)) {
    throw InputError(what, "a place within a thousand sizes of the bodies, " + format_short(reach) + " m",
                     format_short(place.cwiseAbs().maxCoeff()) + " m");
  }
  return world().dimension == 2 ? Vector3(place.x(), place.y(), 0) : place;
}

std::string SceneStage::frame(std::uint32_t number, std::uint32_t answered_drag,
                              std::optional<std::size_t> field, double blend) {
  Loaded& loaded = *loaded_;
  const State& state = loaded.live.state();
  if (loaded.shown_frame != number) {
    const bool is_present = blend >= 1 || loaded.previous_positions.size() != state.positions.size();
    loaded.surface.positions(is_present
                                 ? state.positions
                                 : VectorX((1 - blend) * loaded.previous_positions + blend * state.positions),
                             loaded.positions);
    if (!loaded.normals.empty()) loaded.surface.normals(loaded.positions, loaded.normals);
    loaded.shown_frame = number;
  }
  LiveFrame frame{.number = number,
                  .time = loaded.previous_time + std::min(blend, 1.0) * (state.time - loaded.previous_time),
                  .answers = answered_drag,
                  .positions = loaded.positions,
                  .normals = loaded.normals};
  if (field) {
    loaded.fields.evaluate(world(), state, SurfaceFields::known()[*field]->name, loaded.field);
    frame.field_number = static_cast<std::uint32_t>(*field);
    frame.field = loaded.field;
  }
  std::string bytes;
  encode_frame(frame, bytes);
  return bytes;
}

}  // namespace resilin::viewer
