#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "command.hpp"
#include "conditions.hpp"
#include "mesh_box.hpp"
#include "offered_words.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/quality.hpp"
#include "resilin/scene/scene.hpp"
#include "resilin/world/world.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

struct CheckOptions {
  std::string input;
  std::vector<std::string> overrides;
};

std::string quality_text(const Mesh& mesh, const CellBlock& block) {
  const std::vector<double> qualities = shape_qualities(mesh, block);
  if (qualities.empty()) return "";
  const auto worst = std::ranges::min_element(qualities);
  double sum = 0;
  for (const double quality : qualities) sum += quality;
  return "worst " + format_short(*worst) + " (number " + std::to_string(worst - qualities.begin()) +
         "), mean " + format_short(sum / static_cast<double>(qualities.size()));
}

/// The cells of a solid, or those of a plane mesh; null for a surface in space.
const CellBlock* solid_cells(const Mesh& mesh) {
  if (const CellBlock* solid = mesh.find_solid(3)) return solid;
  const bool is_plane =
      std::ranges::all_of(mesh.vertices, [](const Vector3& vertex) { return vertex.z() == 0; });
  return is_plane ? mesh.find_solid(2) : nullptr;
}

/// @param box  row about where the mesh is
std::vector<std::vector<std::string>> mesh_rows(const Mesh& mesh, const std::vector<std::string>& box) {
  const CellBlock* solid = solid_cells(mesh);
  std::vector<std::vector<std::string>> rows = {{"  vertices", std::to_string(mesh.vertices.size())}};
  for (const CellBlock& block : mesh.blocks) {
    rows.push_back({"  " + std::string(name(block.kind)), std::to_string(block.num_cells())});
    if (&block == solid) {
      rows.push_back({"  shape (1 is best)", quality_text(mesh, block)});
    }
  }
  rows.push_back(box);
  for (const Group& group : mesh.groups) {
    rows.push_back({"  group " + one_line(group.name), std::to_string(group.vertices.size()) + " vertices"});
  }
  for (const CellField& field : mesh.cell_fields) {
    rows.push_back({"  cell field " + one_line(field.name), std::to_string(field.values.size()) + " values"});
  }
  return rows;
}

/// The row of a body, in the frame of `where`: after scale, rotate and translate.
std::vector<std::string> box_of_body(const World& world, const Body& body) {
  const int dim = world.dimension;
  const Index end = body.first_node + body.num_vertices;
  BoundingBox box{Vector3::Constant(HUGE_VAL), Vector3::Constant(-HUGE_VAL)};
  for (Index node = body.first_node; node < end; ++node) {
    Vector3 X = Vector3::Zero();
    X.head(dim) = world.rest_positions.segment(node * dim, dim);
    X += world.origin;
    box.min = box.min.cwiseMin(X);
    box.max = box.max.cwiseMax(X);
  }
  return {"  box of `where`", box_text(box) + " m"};
}

std::string count_of_warnings(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " warning" : " warnings");
}

int check_mesh_path(const CheckOptions& options) {
  const MeshFile file = read_mesh(options.input);
  const MeshReport report = check_mesh_file(file);
  report.require_no_errors();
  std::vector<std::string> warnings = file.warnings;
  for (const MeshIssue& issue : report.warnings) warnings.push_back(issue.text());
  print_warnings(warnings);
  print_line(one_line(options.input) + ": " + file.format + ", no errors, " +
             count_of_warnings(warnings.size()));
  print_text(format_table(mesh_rows(file.mesh, {"  box", file_box_text(file.mesh)})));
  return done;
}

std::string time_steps_text(const World& world) {
  if (world.modes) return std::to_string(world.modes->count) + " vibration modes";
  if (!world.is_dynamic) return "static";
  if (world.adaptive) return "adaptive time steps up to " + format_short(world.end_time) + " s";
  return format_short(world.end_time / world.time_step) + " time steps";
}

std::string skin_text(const Skin& skin) {
  const Embedding::Outside& outside = skin.embedding.outside();
  const std::string text = skin.name + ": " + std::to_string(skin.num_vertices()) + " vertices, " +
                           std::to_string(skin.facets.num_cells()) + " " +
                           std::string(name(skin.facets.kind));
  if (outside.count == 0) return text + ", all inside the cells";
  return text + ", " + std::to_string(outside.count) + " vertices outside the cells by at most " +
         format_short(outside.distance) + " m";
}

void print_scene(const Scene& scene, const World& world) {
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    const BodyDescription& description = scene.description.bodies[b];
    print_line("body " + one_line(body.name) + ": " + body.domains.laws() + ", " +
               one_line(description.mesh_name) + ", mass " + format_short(body.mass) + " kg");
    std::vector<std::vector<std::string>> rows = {
        {"  element", body.element + (body.element_reason.empty() ? "" : ": " + body.element_reason)},
        {"  quadrature", std::string(body.domains.quadrature().name)}};
    const bool has_regions = !description.regions.empty();
    for (const Domain& domain : body.domains) {
      if (has_regions)
        rows.push_back({domain.name.empty() ? "  other cells" : "  region " + one_line(domain.name),
                        domain.law + ", " + std::to_string(domain.energy->num_cells()) +
                            (domain.energy->num_cells() == 1 ? " cell" : " cells") + ", density " +
                            format_short(domain.density) + " kg/m^3"});
      for (const auto& [constant, value] : domain.constants)
        rows.push_back({(has_regions ? "    " : "  ") + constant, format_short(value)});
    }
    for (auto& row : mesh_rows(description.mesh, box_of_body(world, body))) rows.push_back(std::move(row));
    if (body.skin)
      rows.push_back(
          {"  skin", skin_text(*body.skin) +
                         (body.meets_with_skin() ? "; it is the contact surface of the body" : "")});
    print_text(format_table(rows));
  }
  print_conditions(world);
  for (const auto& collider : world.colliders) {
    print_line("collider " + one_line(collider->name()) + ": " + std::string(collider->shape().kind()) +
               ", activation distance " + format_short(collider->activation_distance()) + " m");
  }
  for (const auto& collider : world.mesh_colliders) {
    print_line("collider " + one_line(collider->name()) + ": " +
               std::to_string(collider->obstacle().mesh.vertices.size()) + " vertices, activation distance " +
               format_short(collider->activation_distance()) + " m");
  }
  if (world.contact)
    print_line("contact between bodies: activation distance " +
               format_short(world.contact->activation_distance()) + " m");
  print_line(std::to_string(world.num_free_unknowns()) + " DOFs, " + time_steps_text(world));
}

int check_scene(const CheckOptions& options) {
  const Scene scene = read_scene(options.input, {.overrides = options.overrides});
  const World world(scene.description);
  std::vector<std::string> warnings = scene.warnings;
  for (std::string& warning : all_warnings(world)) warnings.push_back(std::move(warning));
  print_warnings(warnings);
  print_line(one_line(options.input) + ": no errors, " + count_of_warnings(warnings.size()));
  print_scene(scene, world);
  return done;
}

int check(const CheckOptions& options) {
  const bool is_scene = std::filesystem::path(options.input).extension() == ".toml";
  return is_scene ? check_scene(options) : check_mesh_path(options);
}

}  // namespace

void add_check(CommandLine& line, Action& action) {
  auto options = std::make_shared<CheckOptions>();
  const Command command =
      line.command("check", "Check a scene or a mesh: what is wrong, where, and how to fix it");
  command.option("input", options->input, "Scene (.toml) or mesh file")
      .required()
      .is_file(scene_and_mesh_extensions());
  command.option("--set", options->overrides, "Change a value of the scene first; repeatable")
      .type_name("KEY=VALUE")
      .repeatable()
      .offers(scene_settings);
  command.footer("Example:\n  resilin check beam.toml\n\nExit codes: 0 it can be simulated; 1 it cannot.");
  command.on_chosen([options, &action] { action = [options] { return check(*options); }; });
}

}  // namespace resilin::cli
