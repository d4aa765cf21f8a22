#include "served_live_scene.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "control_json.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/overloaded.hpp"
#include "resilin/core/text.hpp"
#include "resilin/live/hand_patch.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/view/frame_codec.hpp"
#include "resilin/view/header.hpp"
#include "resilin/view/shown_marks.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin::viewer {
namespace {

using Json = nlohmann::json;

std::string title_of(const World& world) {
  return world.title.empty() ? std::filesystem::path(world.place).filename().string() : world.title;
}

constexpr std::size_t most_arrows = 60;         ///< arrows of a load on a face
constexpr Offset most_smoothed_cells = 20'000;  ///< cells of a scene that smooth every frame

/// Smooth fields cost too much in every frame of a large scene.
std::vector<ScalarField> live_fields(const World& world) {
  Offset num_cells = 0;
  for (const Body& body : world.bodies) num_cells += body.num_cells();
  return num_cells <= most_smoothed_cells ? vertex_fields(world.dimension)
                                          : SurfaceFields::quick(world.dimension);
}

bool is_same_face(const FacePatch& there, const FacePatch& touched) {
  return there.part == touched.part && std::ranges::binary_search(there.facets, touched.touched);
}

/// Takes the last entry with this face from a list and returns its number; none without such an entry.
template <class Face>
std::optional<int> take_touched(std::vector<Face>& faces, const FacePatch& patch) {
  const auto is_touched = [&patch](const Face& face) { return is_same_face(face.patch, patch); };
  const auto last = std::find_if(faces.rbegin(), faces.rend(), is_touched);
  if (last == faces.rend()) return std::nullopt;
  const int number = last->number;
  faces.erase(std::next(last).base());
  return number;
}

}  // namespace

ServedLiveScene::Loaded::Loaded(Scene scene, const std::optional<State>& start)
    : Loaded(std::make_shared<LiveScene>(scene.description, start), std::move(scene.warnings)) {
  description = std::move(scene.description);
  const std::vector<std::string>& more = live->world().warnings;
  warnings.insert(warnings.end(), more.begin(), more.end());
}

ServedLiveScene::Loaded::Loaded(std::shared_ptr<LiveScene> played, std::vector<std::string> words)
    : live(std::move(played)),
      warnings(std::move(words)),
      first_controls(live->controls()),
      first_materials(live->materials()),
      surface(live->world()),
      colliders(shown_colliders(live->world())),
      fields(live->world(), surface),
      evaluator(live->world()),
      field_choices(live_fields(live->world())) {
  const auto num_vertices = static_cast<std::size_t>(surface.num_vertices());
  positions.resize(3 * num_vertices);
  if (surface.dimension() == 3) normals.resize(3 * num_vertices);
  field.resize(num_vertices);
  previous_time = live->state().time;
  previous_conditions = live->conditions();
}

ServedLiveScene::ServedLiveScene(std::function<Scene()> read, SaveChanges save, std::optional<State> start)
    : read_(std::move(read)),
      start_(std::move(start)),
      save_(std::move(save)),
      loaded_(std::make_unique<Loaded>(read_(), start_)) {}

ServedLiveScene::ServedLiveScene(std::shared_ptr<LiveScene> live, std::vector<std::string> warnings)
    : loaded_(std::make_unique<Loaded>(std::move(live), std::move(warnings))) {}

Json ServedLiveScene::header() const {
  Json header = Json::parse(encode_header({.title = title_of(world()),
                                           .version = std::string(version()),
                                           .up = loaded_->live->up(),
                                           .gravity = loaded_->live->controls().gravity,
                                           .fields = loaded_->field_choices,
                                           .colliders = loaded_->colliders},
                                          world(), loaded_->surface));
  header["saves"] = static_cast<bool>(save_);
  header["controls"] = drive_entries(loaded_->live->drives());
  const bool all_are_rigid =
      std::ranges::all_of(world().bodies, [](const Body& body) { return body.rigid != nullptr; });
  for (Json& control :
       control_entries(loaded_->live->controls(), world().largest_extent(), world().contact != nullptr))
    if (!all_are_rigid || !control.contains("of_body")) header["controls"].push_back(std::move(control));
  return header;
}

std::string ServedLiveScene::topology() const {
  return encode_topology(loaded_->surface, loaded_->colliders);
}

std::vector<std::string> ServedLiveScene::field_names() const {
  std::vector<std::string> names;
  for (const ScalarField& field : loaded_->field_choices) names.push_back(field.name);
  return names;
}

Json ServedLiveScene::state() const {
  const LiveControls& controls = loaded_->live->controls();
  Json pinned = Json::array();
  for (const Index node : loaded_->live->pinned())
    if (const std::optional<std::uint32_t> vertex = shown_vertex(node)) pinned.push_back(*vertex);
  Json held = Json::array();
  for (const ShownFace& face : loaded_->faces)
    held.push_back({{"vertices", shown_support(face.patch.vertices)}});
  Json bodies = Json::array();
  for (const BodyControls& material : loaded_->live->materials())
    bodies.push_back(body_values(with_material(controls, material)));
  Json loads = Json::array();
  for (const LoadedFace& load : loaded_->loads) {
    Json directions = Json::array();
    for (const Vector3& d : load.directions) directions.push_back({d.x(), d.y(), d.z()});
    loads.push_back({{"vertices", load.vertices}, {"directions", std::move(directions)}});
  }
  Json values = control_values(controls, world().contact != nullptr);
  values.update(drive_values(loaded_->live->drives()));
  return {
      {"values", std::move(values)}, {"ground", controls.has_ground ? Json(controls.ground_height) : Json()},
      {"pinned", std::move(pinned)}, {"held", std::move(held)},
      {"bodies", std::move(bodies)}, {"loads", std::move(loads)},
      {"poking", is_poking()},       {"warnings", loaded_->warnings}};
}

Json ServedLiveScene::status() const {
  const LiveReport& report = loaded_->live->report();
  const std::optional<LiveContact> contact = loaded_->live->contact();
  return {{"time", time()},
          {"drives", drive_values(loaded_->live->drives())},
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
          {"smallest_gap", contact ? Json(contact->smallest_gap) : Json()},
          {"active_pairs", contact ? Json(contact->active_pairs) : Json()},
          {"elastic_energy", report.elastic_energy},
          {"kinetic_energy", report.kinetic_energy},
          {"hand_force", is_grabbed() ? Json(loaded_->live->hand_force().norm()) : Json()},
          {"words", report.state},
          {"warnings", report.warnings}};
}

void ServedLiveScene::step(double seconds) {
  const State& state = loaded_->live->state();
  loaded_->previous_positions = state.positions;
  loaded_->previous_time = state.time;
  loaded_->previous_conditions = loaded_->live->conditions();
  loaded_->live->step({seconds});
}

void ServedLiveScene::forget_previous_state() {
  loaded_->previous_positions.resize(0);
  loaded_->previous_time = loaded_->live->state().time;
  loaded_->previous_conditions = loaded_->live->conditions();
}

void ServedLiveScene::apply(const SceneMessage& message) {
  Loaded& loaded = *loaded_;
  std::visit(Overloaded{
                 [this](const Grab& taken) { grab(taken); },
                 [&](const Drag& drag) {
                   loaded.live->drag(checked_place(drag.target, "drag: target") + loaded.grab_offset);
                 },
                 [&](const Release&) { loaded.live->release(); },
                 [&](const Pin& pin) {
                   const Index vertex = checked_vertex(pin.vertex, "pin");
                   const Index node = loaded.surface.nearest_node(vertex);
                   loaded.vertex_of_node[node] = pin.vertex;
                   loaded.live->pin(node, loaded.surface.material_point(vertex));
                 },
                 [&](const Unpin& unpin) {
                   loaded.live->unpin(loaded.surface.nearest_node(checked_vertex(unpin.vertex, "unpin")));
                 },
                 [&](const UnpinAll&) { loaded.live->unpin_all(); },
                 [this](const HoldFace& face) { hold(face); },
                 [this](const FreeFaces&) { free_faces(); },
                 [&](const Poke& poke) {
                   loaded.live->poke(checked_place(poke.center, "poke: center"), poke.radius);
                 },
                 [&](const PokeEnd&) { loaded.live->stop_poking(); },
                 [this](const SetControl& control) { set(control); },
                 [this](const LoadFace& face) { load(face); },
                 [this](const RemoveLoads&) { remove_loads(); },
                 [&](const Settle&) { loaded.live->settle(); },
                 [&](const Reset&) {
                   loaded.live->reset();
                   forget_previous_state();
                 },
                 [this](const Reload&) { reload(); },
             },
             message);
}

/// The vertex by which a node was pinned; of one that a program has pinned the first that stands for it.
std::optional<std::uint32_t> ServedLiveScene::shown_vertex(Index node) const {
  std::map<Index, std::uint32_t>& vertices = loaded_->vertex_of_node;
  if (!vertices.contains(node))
    for (Index vertex = 0; vertex < num_vertices(); ++vertex)
      vertices.emplace(loaded_->surface.nearest_node(vertex), static_cast<std::uint32_t>(vertex));
  const auto known = vertices.find(node);
  if (known == vertices.end()) return std::nullopt;  // it lies inside
  return known->second;
}

/// A second time on the same face lets it go.
void ServedLiveScene::hold(const HoldFace& hold) {
  Loaded& loaded = *loaded_;
  FacePatch patch = patch_at(hold, "hold");
  if (const std::optional<int> held = take_touched(loaded.faces, patch)) return loaded.live->let_go(*held);
  const int number = loaded.live->hold(body_of(patch), mesh_vertices(patch));
  loaded.faces.push_back({number, std::move(patch)});
}

FacePatch ServedLiveScene::patch_at(const HoldFace& hold, const char* what) {
  Loaded& loaded = *loaded_;
  const Vector3 point = checked_place(hold.point, what);
  const Index vertex = checked_vertex(hold.vertex, what);
  loaded.surface.positions(loaded.live->state().positions, loaded.positions);
  loaded.shown_frame = 0;
  return face_patch(loaded.surface, vertex, point, loaded.positions, hold.reach);
}

std::vector<Index> ServedLiveScene::mesh_vertices(const FacePatch& patch) const {
  const Body& body = world().bodies[body_of(patch)];
  std::vector<Index> vertices;
  if (body.rigid) {  // those of its mesh at the patch
    const std::span<const float> rest = loaded_->surface.rest_positions();
    const VectorX& X = body.rigid->rest_positions;
    for (const Index shown : patch.vertices) {
      const float* at = &rest[3 * static_cast<std::size_t>(shown)];
      const Vector3 place(at[0], at[1], at[2]);
      const auto distance = [&](Index v) {
        return (node_position(world().dimension, v, X) - place).squaredNorm();
      };
      Index nearest = 0;
      for (Index v = 1; v < body.rigid->body.num_nodes; ++v)
        if (distance(v) < distance(nearest)) nearest = v;
      vertices.push_back(nearest);
    }
    std::ranges::sort(vertices);
    vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
    return vertices;
  }
  for (const Index node : nodes_of_patch(loaded_->surface, patch))
    if (node - body.first_node < body.num_vertices) vertices.push_back(node - body.first_node);
  return vertices;
}

/// A second time on the same face takes the load away.
void ServedLiveScene::load(const LoadFace& load) {
  Loaded& loaded = *loaded_;
  FacePatch patch = patch_at(load.face, "load");
  if (const std::optional<int> put = take_touched(loaded.loads, patch)) return loaded.live->remove_load(*put);
  LoadedFace made{loaded.live->put_load(body_of(patch), mesh_vertices(patch), load.choice), std::move(patch)};
  VectorX gradient = VectorX::Zero(world().rest_positions.size());
  loaded.live->face_loads().back().term->add_gradient(world().rest_positions, world().at_load(1), gradient);
  Vector3 resultant = Vector3::Zero();
  for (Index node = 0; node < world().num_nodes(); ++node)
    resultant -= node_position(world().dimension, node, gradient);
  const bool is_on_rigid = world().bodies[body_of(made.patch)].rigid != nullptr;
  const auto force = [&](Index vertex) -> Vector3 {
    if (is_on_rigid) return resultant;  // its control nodes are not where the force acts
    return -node_position(world().dimension, loaded.surface.nearest_node(vertex), gradient);
  };
  double greatest = 0;
  const std::vector<Index> shown = thinned(made.patch.vertices, most_arrows);
  for (const Index vertex : shown) greatest = std::max(greatest, force(vertex).norm());
  for (const Index vertex : shown) {
    if (!(force(vertex).norm() > 1e-3 * greatest)) continue;
    made.vertices.push_back(vertex);
    made.directions.emplace_back(force(vertex) / greatest);
  }
  loaded.loads.push_back(std::move(made));
}

void ServedLiveScene::remove_loads() {
  for (const LoadedFace& face : loaded_->loads) loaded_->live->remove_load(face.number);
  loaded_->loads.clear();
}

void ServedLiveScene::set(const SetControl& set) {
  LiveScene& live = *loaded_->live;
  if (set.control == nullptr) return drive(set);
  LiveControls controls = live.controls();
  if (!set.body) {
    set_value(*set.control, set.value, controls);
    live.set_controls(controls);
    return;
  }
  if (*set.body >= live.materials().size())
    throw InputError("set: body", "a number from 0 to " + std::to_string(live.materials().size() - 1),
                     std::to_string(*set.body));
  controls = with_material(controls, live.materials()[*set.body]);
  set_value(*set.control, set.value, controls);
  live.set_material(*set.body, {controls.law, controls.youngs_modulus, controls.poissons_ratio});
}

void ServedLiveScene::drive(const SetControl& set) {
  LiveScene& live = *loaded_->live;
  const auto found = std::ranges::find(live.drives(), set.drive, &Drive::key);
  if (found == live.drives().end()) {
    std::vector<std::string> known;
    for (const Drive& drive : live.drives()) known.push_back(drive.key);
    throw InputError(
        "message \"set\": key",
        known.empty() ? "no drive in a scene without motors and cables" : "one of " + join(known),
        '"' + one_line(set.drive.substr(0, 40)) + '"');
  }
  live.drive(static_cast<std::size_t>(found - live.drives().begin()), std::get<double>(set.value));
}

void ServedLiveScene::free_faces() {
  for (const ShownFace& face : loaded_->faces) loaded_->live->let_go(face.number);
  loaded_->faces.clear();
}

std::string ServedLiveScene::save() {
  if (!save_)
    throw InputError("save", "a scene that was read from a file", "one that was not",
                     "`resilin view SCENE.toml` saves fixed faces");
  return save_({.before = &loaded_->description,
                .up = loaded_->live->up(),
                .first = loaded_->first_controls,
                .now = loaded_->live->controls(),
                .first_materials = loaded_->first_materials,
                .materials = loaded_->live->materials(),
                .contact = loaded_->live->contact_choices(),
                .held = loaded_->live->held_faces(),
                .loads = loaded_->live->face_loads(),
                .drives = loaded_->live->drives()});
}

/// Everything anew but the speed, which is not the scene's.
void ServedLiveScene::reload() {
  const double present_speed = speed();
  if (read_) {
    loaded_ = std::make_unique<Loaded>(read_(), start_);
  } else {
    free_faces();
    remove_loads();
    loaded_->live->stop_driving();
    loaded_->live->set_controls(loaded_->first_controls);
    for (std::size_t b = 0; b < loaded_->first_materials.size(); ++b)
      if (!world().bodies[b].rigid) loaded_->live->set_material(b, loaded_->first_materials[b]);
    loaded_->live->reset();
    forget_previous_state();
  }
  LiveControls controls = loaded_->live->controls();
  controls.speed = present_speed;
  loaded_->live->set_controls(controls);
}

/// The hand holds what is around the place where the pointer hit, and keeps its distance from there, so that
/// taking hold moves nothing.
void ServedLiveScene::grab(const Grab& grab) {
  Loaded& loaded = *loaded_;
  const Vector3 point = checked_place(grab.point, "grab: point");
  const Index vertex = checked_vertex(grab.vertex, "grab");
  loaded.surface.positions(loaded.live->state().positions, loaded.positions);
  loaded.shown_frame = 0;
  const MaterialPoint place =
      hand_patch(world(), loaded.surface.touched_place(vertex, point, loaded.positions));
  const Vector3 position = place.position(world().dimension, loaded.live->state().positions);
  loaded.live->grab(place, position);
  loaded.grab_offset = position - point;
}

Index ServedLiveScene::checked_vertex(std::uint32_t vertex, const char* what) const {
  if (vertex >= static_cast<std::uint32_t>(num_vertices())) {
    throw InputError(std::string(what) + ": vertex",
                     "a number from 0 to " + std::to_string(num_vertices() - 1), std::to_string(vertex));
  }
  return static_cast<Index>(vertex);
}

Vector3 ServedLiveScene::checked_place(const Vector3& place, const char* what) const {
  const double reach = 1000 * world().largest_extent();
  if (!(place.cwiseAbs().maxCoeff() <= reach)) {
    throw InputError(what, "a place within a thousand sizes of the bodies, " + format_short(reach) + " m",
                     format_short(place.cwiseAbs().maxCoeff()) + " m");
  }
  return world().dimension == 2 ? Vector3(place.x(), place.y(), 0) : place;
}

void ServedLiveScene::evaluate_arrows(const ScalarField& length) {
  Loaded& loaded = *loaded_;
  std::vector<ScalarField> components;
  for (const char axis : std::string_view("xyz")) {
    const auto found = std::ranges::find(loaded.field_choices, length.name + '.' + axis, &ScalarField::name);
    if (found != loaded.field_choices.end()) components.push_back(*found);
  }
  const auto n = static_cast<std::size_t>(num_vertices());
  std::vector<std::vector<float>> values(components.size(), std::vector<float>(n));
  loaded.fields.evaluate(loaded.evaluator, loaded.live->state(), components, values);
  loaded.arrows.assign(3 * n, 0);
  for (std::size_t k = 0; k < values.size(); ++k)
    for (std::size_t v = 0; v < n; ++v) loaded.arrows[3 * v + k] = values[k][v];
}

std::string ServedLiveScene::frame(std::uint32_t number, std::uint32_t answered_drag,
                                   const FieldChoice& shown, double blend) {
  Loaded& loaded = *loaded_;
  const State& state = loaded.live->state();
  if (loaded.shown_frame != number) {
    const bool is_present = blend >= 1 || loaded.previous_positions.size() != state.positions.size();
    loaded.surface.positions(is_present
                                 ? state.positions
                                 : VectorX((1 - blend) * loaded.previous_positions + blend * state.positions),
                             loaded.positions);
    if (!loaded.normals.empty()) loaded.surface.normals(loaded.positions, loaded.normals);
    loaded.shown_frame = number;
  }
  // Colliders turn and move between the two steps as they do in the scene, not on straight lines.
  const Conditions now = loaded.live->conditions();
  const auto blended = [&](double before, double after) {
    return before + std::min(blend, 1.0) * (after - before);
  };
  const std::vector<float> places =
      collider_places(loaded.colliders, {.time = blended(loaded.previous_conditions.time, now.time),
                                         .delay = blended(loaded.previous_conditions.delay, now.delay)});
  LiveFrame frame{.number = number,
                  .time = blended(loaded.previous_time, state.time),
                  .answers = answered_drag,
                  .positions = loaded.positions,
                  .normals = loaded.normals,
                  .colliders = places};
  if (shown.field) {
    loaded.fields.evaluate(loaded.evaluator, state, {&loaded.field_choices[*shown.field], 1},
                           {&loaded.field, 1});
    frame.field_number = static_cast<std::uint32_t>(*shown.field);
    frame.field = loaded.field;
  }
  if (shown.arrows) {
    evaluate_arrows(loaded.field_choices[*shown.arrows]);
    frame.arrows_number = static_cast<std::uint32_t>(*shown.arrows);
    frame.arrows = loaded.arrows;
  }
  std::string bytes;
  encode_frame(frame, bytes);
  return bytes;
}

}  // namespace resilin::viewer
