#include "resilin/scene/scene.hpp"

#include "resilin/element/axisymmetric.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/material/law_sum.hpp"
#include "resilin/material/plane_stress.hpp"
#include "resilin/scene/tables.hpp"
#include "resilin/world/rigid_region.hpp"

namespace resilin {
namespace {

/// Calls `read(node, entry)` for each table of [[key]].
template <class T, class Read>
void read_list(const SceneNode& root, const std::string& key, std::vector<T>& entries, const Read& read) {
  if (!root.has(key)) return;
  const SceneNode list = root.child(key);
  if (!list.value->is_array()) list.fail("a list of tables, each headed [[" + key + "]]");
  for (std::size_t i = 0; i < list.value->array().size(); ++i) {
    entries.emplace_back();
    read(list.element(i), entries.back());
  }
}

void read_probe(const SceneNode& node, ProbeDescription& probe) {
  probe.place = node.place();
  probe.name = node.path;
  read_table(node, probe_keys(), probe);
}

template <class T>
void read_optional(const SceneNode& root, const char* key, const Keys<T>& keys, T& target) {
  if (root.has(key)) read_table(root.child(key), keys, target);
}

/// A file of a fit is no scene with a slip of the pen.
void refuse_fit(const SceneNode& root) {
  if (root.has("body")) return;
  for (const char* key : {"experiment", "test", "fit"})
    if (root.has(key))
      root.fail_with(std::string("this is a fit file, because it has \"") + key +
                     "\" and no [[body]]; resilin fit FILE takes it");
}

/// In plane stress each body has the twins of its laws (material/plane_stress.hpp).
void take_plane_stress(MaterialDescription& material) {
  if (find_law(material.law) != nullptr && is_sum(*find_law(material.law)))
    throw InputError(material.place + ".sum", "one law in plane stress", '"' + material.law + '"',
                     "take one law, or plane strain or 3D");
  material.law = plane_stress_name(material.law);
}
void take_plane_stress(Description& d) {
  for (BodyDescription& body : d.bodies) {
    take_plane_stress(body.material);
    for (RegionDescription& region : body.regions) take_plane_stress(region.material);
  }
}

/// In axisymmetric solids each body has the twin of its element (element/axisymmetric.hpp).
void take_axisymmetry(Description& d) {
  for (BodyDescription& body : d.bodies) body.element = axisymmetric_name(body.element);
}

void read_root(const SceneNode& root, Description& d) {
  refuse_fit(root);
  refuse_unknown_keys(
      root, {"title", "simulation", "body", "fix", "tie", "constraint", "joint", "spring", "cable", "load",
             "collider", "contact", "newton", "solver", "probe", "section", "step", "output"});
  if (root.has("title")) d.title = read_text(root.child("title"));
  read_optional(root, "simulation", simulation_keys(), d);
  if (root.has("contact")) read_contact(root.child("contact"), d.contact);
  read_optional(root, "newton", newton_keys(), d.newton);
  read_optional(root, "solver", solver_keys(), d.solver);
  read_optional(root, "output", output_keys(), d.output);
  read_list(root, "body", d.bodies, read_body);
  read_list(root, "fix", d.fixes, read_fix);
  read_list(root, "tie", d.ties, read_tie);
  read_list(root, "constraint", d.constraints, read_constraint);
  read_list(root, "joint", d.joints, read_joint);
  read_list(root, "spring", d.springs, read_spring);
  read_list(root, "cable", d.cables, read_cable);
  read_list(root, "load", d.loads, read_load);
  read_list(root, "collider", d.colliders, read_collider);
  read_list(root, "probe", d.probes, read_probe);
  read_list(root, "section", d.sections, read_section);
  read_steps(root, d);
  if (root.has("simulation") && root.child("simulation").has("dimension")) {
    const SceneNode dimension = root.child("simulation").child("dimension");
    if (is_plane_stress_dimension(dimension)) take_plane_stress(d);
    if (is_axisymmetric_dimension(dimension)) take_axisymmetry(d);
  }
  add_rigid_regions(d);
  if (d.bodies.empty()) root.fail_with("there is no [[body]]; a scene needs at least one body with a mesh");
}

}  // namespace

Scene read_scene_from_values(SceneValue values, const std::string& name, const std::filesystem::path& folder,
                             const SceneOptions& options) {
  for (const std::string& assignment : options.overrides) apply_override(values, assignment);
  SceneContext context;
  context.folder = folder;
  context.max_box_cells = options.max_box_cells;
  context.meshes = options.meshes;
  context.is_for_real_time = options.is_for_real_time;
  values.source = std::make_shared<const std::string>(name);
  values.line = 0;
  Scene scene;
  scene.description.place = name;
  read_root({&values, "", &context}, scene.description);
  check_names(scene.description);
  scene.warnings = std::move(context.warnings);
  return scene;
}

Scene read_scene_from_text(std::string_view text, const std::string& name,
                           const std::filesystem::path& folder, const SceneOptions& options) {
  return read_scene_from_values(parse_toml(text, name), name, folder, options);
}

Scene read_scene(const std::filesystem::path& path, const SceneOptions& options) {
  return read_scene_from_text(read_file(path), path.string(), path.parent_path(), options);
}

}  // namespace resilin
