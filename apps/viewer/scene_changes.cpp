#include "scene_changes.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include "resilin/material/law_sum.hpp"

namespace resilin::viewer {
namespace {

constexpr const char* place = "save";  // begins messages that nobody should see

SceneValue value_of(auto data) {
  SceneValue value;
  value.data = std::move(data);
  return value;
}

SceneValue vector_value(const Vector3& v, int dim) {
  SceneValue::Array numbers;
  for (int i = 0; i < dim; ++i) numbers.push_back(value_of(v[i] + 0.0));  // no -0
  return value_of(std::move(numbers));
}

/// The list of tables [[key]], made when there is none.
SceneValue::Array& list_of(SceneValue& scene, const std::string& key) {
  if (scene.find(key) == nullptr) scene.table().push_back({key, value_of(SceneValue::Array{})});
  return scene.find(key)->array();
}

std::string body_key(std::size_t body) { return "body." + std::to_string(body); }

/// Names "prefix1", "prefix2", ... that no entry of a list has yet.
class FreeNames {
 public:
  FreeNames(std::string prefix, const auto& entries) : prefix_(std::move(prefix)) {
    for (const auto& entry : entries) taken_.insert(entry.name);
  }
  std::string next() {
    std::string name;
    do name = prefix_ + std::to_string(++number_);
    while (taken_.contains(name));
    return name;
  }

 private:
  std::string prefix_;
  std::set<std::string> taken_;
  int number_ = 0;
};

/// A table with a name and, where there are several, a body.
SceneValue::Table table_on(const Description& before, const std::string& name, const std::string& body) {
  SceneValue::Table table = {{"name", value_of(name)}};
  if (before.bodies.size() > 1) table.push_back({"body", value_of(body)});
  return table;
}

SceneMember where_of(const std::vector<Index>& vertices) {
  SceneValue::Array numbers;
  for (const Index v : vertices) numbers.push_back(value_of(std::int64_t{v}));
  return {"where", value_of(SceneValue::Table{{"vertices", value_of(std::move(numbers))}})};
}

void hold(SceneValue& scene, const SceneChanges& changes) {
  if (changes.held.empty()) return;
  const Description& before = *changes.before;
  SceneValue::Array& fixes = list_of(scene, "fix");
  FreeNames names("held_", before.fixes);
  for (const HeldFace& face : changes.held) {
    SceneValue::Table fix = table_on(before, names.next(), before.bodies[face.body].name);
    fix.push_back(where_of(face.vertices));
    fixes.push_back(value_of(std::move(fix)));
  }
}

void place_ground(SceneValue& scene, const SceneChanges& changes) {
  const LiveControls& now = changes.now;
  SceneValue::Array& colliders = list_of(scene, "collider");
  for (std::size_t i = changes.before->colliders.size(); i-- > 0;)
    if (is_floor(changes.before->colliders[i], changes.up))
      colliders.erase(colliders.begin() + static_cast<std::ptrdiff_t>(i));
  if (now.has_ground) {
    const int dim = changes.before->dimension;
    SceneValue::Table ground = {{"name", value_of(std::string("ground"))},
                                {"kind", value_of(std::string("half_space"))},
                                {"point", vector_value(now.ground_height * changes.up, dim)},
                                {"normal", vector_value(changes.up, dim)}};
    if (now.ground_friction > 0) ground.push_back({"friction", value_of(now.ground_friction)});
    colliders.push_back(value_of(std::move(ground)));
  }
  if (colliders.empty())
    std::erase_if(scene.table(), [](const SceneMember& member) { return member.key == "collider"; });
}

/// Faces with loads, by vertices of their meshes.
void put_loads(SceneValue& scene, const SceneChanges& changes) {
  if (changes.loads.empty()) return;
  const Description& before = *changes.before;
  SceneValue::Array& loads = list_of(scene, "load");
  FreeNames names("load_", before.loads);
  for (const FaceLoad& face : changes.loads) {
    SceneValue::Table load = table_on(before, names.next(), face.description.body);
    load.push_back({"kind", value_of(face.description.kind)});
    load.push_back(where_of(face.description.where.vertices));
    load.push_back({"value", face.description.kind == "pressure"
                                 ? value_of(face.description.pressure)
                                 : vector_value(face.description.value, before.dimension)});
    loads.push_back(value_of(std::move(load)));
  }
}

/// The key of a drive's value in its table.
std::string key_of(const Drive& drive) {
  switch (drive.kind) {
    case Drive::Kind::angle:
    case Drive::Kind::displacement:
      return "position";
    case Drive::Kind::angular_velocity:
      return "velocity";
    default:
      return std::string(drive.quantity());
  }
}

/// Motors and cables keep the values that they were driven to; in dynamics they go there in a moment.
void set_drives(SceneValue& scene, const SceneChanges& changes) {
  const Description& before = *changes.before;
  for (const Drive& drive : changes.drives) {
    if (!drive.is_driven) continue;
    SceneValue& entry = scene.find(drive.is_of_cable() ? "cable" : "joint")->array()[drive.number];
    SceneValue::Table& table = drive.is_of_cable() ? entry.table() : entry.find("motor")->table();
    const std::string key = key_of(drive);
    std::erase_if(
        table, [&](const SceneMember& member) { return member.key == "time_function" || member.key == key; });
    table.push_back({key, value_of(drive.goal)});
    if (!before.is_dynamic || drive.is_rate()) continue;
    SceneValue::Table ramp = {{"from", value_of(0.0)},
                              {"until", value_of(std::min(seconds_of_slider, before.end_time))}};
    table.push_back({"time_function", value_of(SceneValue::Table{{"ramp", value_of(std::move(ramp))}})});
  }
}

}  // namespace

void write_material(SceneValue& scene, const SceneChanges& changes, bool writes_all) {
  for (std::size_t b = 0; b < changes.before->bodies.size(); ++b) {
    if (!writes_all && changes.materials[b] == changes.first_materials[b]) continue;
    const MaterialDescription& before = changes.before->bodies[b].material;
    const MaterialDescription after = material_of(changes.materials[b], before);
    if (is_sum(require_law(after.law, place))) continue;  // as it was
    set_value(scene, body_key(b) + ".material.law", value_of(after.law), place);
    SceneValue::Table& table = scene.find("body")->array()[b].find("material")->table();
    std::erase_if(table, [&](const SceneMember& member) {
      const bool is_constant = before.constants.contains(member.key);
      const bool is_of_cells = before.cell_constants.contains(member.key);
      const bool is_dropped = is_constant || (is_of_cells && !after.cell_constants.contains(member.key));
      return is_dropped || after.constants.contains(member.key) ||
             (member.key == "fibres" && after.fibres.empty()) || member.key == "sum";
    });
    for (const auto& [name, value] : after.constants) table.push_back({name, value_of(value)});
  }
}

void apply_changes(SceneValue& scene, const SceneChanges& changes) {
  const LiveControls &first = changes.first, &now = changes.now;
  const auto set = [&scene](const std::string& key, SceneValue value) {
    set_value(scene, key, std::move(value), place);
  };
  hold(scene, changes);
  put_loads(scene, changes);
  if (now.gravity != first.gravity)
    set("simulation.gravity", vector_value(now.gravity, changes.before->dimension));
  write_material(scene, changes);
  set_drives(scene, changes);
  if (now.damping != first.damping)
    for (std::size_t b = 0; b < changes.before->bodies.size(); ++b)
      set(body_key(b) + ".damping.mass", value_of(now.damping));
  if (now.has_ground != first.has_ground ||
      (now.has_ground &&
       (now.ground_height != first.ground_height || now.ground_friction != first.ground_friction)))
    place_ground(scene, changes);
  if (now.contact_friction != first.contact_friction) set("contact.friction", value_of(now.contact_friction));
  // Settings that nobody has chosen follow the bodies in the new scene, too.
  const ContactDescription &was = changes.before->contact, &is = changes.contact;
  if (is.stiffness && is.stiffness != was.stiffness) set("contact.stiffness", value_of(*is.stiffness));
  if (is.activation_distance && is.activation_distance != was.activation_distance)
    set("contact.activation_distance", value_of(*is.activation_distance));
}

}  // namespace resilin::viewer
