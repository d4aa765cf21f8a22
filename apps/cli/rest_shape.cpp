#include "resilin/sensitivity/rest_shape.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "command.hpp"
#include "interrupt.hpp"
#include "offered_words.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/quoted_text.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/scene/scene.hpp"
#include "share_line.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

struct RestShapeCommand {
  std::string scene, out;
  std::vector<std::string> overrides;
  bool quiet = false;
};

/// A name for a file or a group that no other has.
std::string own_name(const std::string& wanted, const std::string& otherwise, std::set<std::string>& taken) {
  std::string plain = wanted.empty() ? otherwise : wanted;
  std::ranges::replace_if(
      plain,
      [](char c) {
        const auto code = static_cast<unsigned char>(c);
        return code <= 0x20 || code == 0x7f || c == '/' || c == '\\' || c == '"' || c == ':';
      },
      '_');
  std::string name = plain;
  for (int number = 2; !taken.insert(name).second; ++number) name = plain + "-" + std::to_string(number);
  return name;
}

/// Lines that a scene file needs instead.
using Lines = std::vector<std::string>;

/// Gives the mesh of a body groups for what the scene selects by place in the shape as drawn.
template <class Table>
void keep_selections(const std::string& key, const std::vector<Table>& drawn, const std::vector<Table>& found,
                     const BodyDescription& body, Mesh& mesh, std::set<std::string>& groups, Lines& lines) {
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const bool is_own = drawn[i].body.empty() || drawn[i].body == body.name;
    if (!is_own || !drawn[i].where.is_by_place()) continue;
    const std::string what = "[[" + key + "]] " + quoted_text(one_line(drawn[i].name)) + ": ";
    if (found[i].where.kind != Where::Kind::vertices) {
      lines.push_back(what + "where = ... for the same selection in the stress-free shape");
      continue;
    }
    Group group{
        .name = own_name(drawn[i].name, key, groups), .cells = {}, .vertices = found[i].where.vertices};
    std::ranges::sort(group.vertices);
    lines.push_back(what + "where = { group = " + quoted_text(group.name) + " }");
    mesh.groups.push_back(std::move(group));
  }
}

void write_places(const std::filesystem::path& path, const VectorX& places, int dim) {
  write_atomically(path, [&](std::ostream& out) {
    for (Eigen::Index i = 0; i < places.size(); ++i)
      out << format_number(places[i]) << ((i + 1) % dim == 0 ? '\n' : ',');
  });
}

int find(const RestShapeCommand& options) {
  const Stopwatch watch;
  const auto tell = [&](const std::string& line) {
    if (!options.quiet) print_line(line);
  };
  const Scene scene = read_scene(options.scene, {.overrides = options.overrides});
  print_warnings(scene.warnings);
  catch_interrupts();
  ShareLine shown(Progress::style_for_stdout(options.quiet));
  const RestShape found =
      find_rest_shape(scene.description, {.goes_on = [&](const RestShapeProgress& progress) {
                        shown.show(progress.share, [&] { return progress.text(); });
                        return !is_interrupted();
                      }});
  shown.end();
  const std::filesystem::path source = options.scene,
                              folder = options.out.empty()
                                           ? std::filesystem::path("out") / (source.stem().string() + "_rest")
                                           : std::filesystem::path(options.out);
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw FileError(folder.string(), "cannot be made: " + failure.message());
  const auto path_text = [](const std::filesystem::path& path) { return one_line(path.generic_string()); };
  // As the scene file names them.
  const auto name_in_scene = [&](const std::filesystem::path& path) {
    return quoted_text(
        path_text(std::filesystem::proximate(path, source.has_parent_path() ? source.parent_path() : ".")));
  };
  Lines lines;
  std::set<std::string> files;
  for (std::size_t b = 0; b < found.bodies.size(); ++b) {
    const BodyDescription& body = found.scene.bodies[b];
    const std::string table = "[[body]] " + quoted_text(one_line(body.name)) + ": ";
    Mesh mesh = body.mesh;
    std::set<std::string> groups;
    for (const Group& group : mesh.groups) groups.insert(group.name);
    const std::filesystem::path path = folder / (own_name(body.name, "body", files) + ".msh");
    lines.push_back(table + "mesh = " + name_in_scene(path));
    keep_selections("fix", scene.description.fixes, found.scene.fixes, body, mesh, groups, lines);
    keep_selections("load", scene.description.loads, found.scene.loads, body, mesh, groups, lines);
    write_mesh(path, mesh);
    tell(path_text(path) + ": the stress-free shape of " + quoted_text(one_line(body.name)));
    if (!body.initial_positions.empty() && scene.description.bodies[b].initial_positions.empty()) {
      std::filesystem::path start = path;
      start.replace_filename(path.stem().string() + "_drawn.csv");
      const std::vector<double>& places = body.initial_positions;
      write_places(start, Eigen::Map<const VectorX>(places.data(), static_cast<Eigen::Index>(places.size())),
                   found.scene.dimension);
      tell(path_text(start) + ": its vertices as drawn");
      lines.push_back(table + "initial_positions = " + name_in_scene(start));
    }
  }
  for (const auto& [collider, distance] : found.kept_off)
    lines.push_back("[[collider]] " + quoted_text(one_line(collider)) +
                    ": activation_distance = " + format_number(distance));
  tell("a run from it ends " + format_short(found.distance) + " m from the drawn shape, " +
       format_short(found.distance / found.size) + " of its size; " + std::to_string(found.iterations) +
       (found.iterations == 1 ? " iteration, " : " iterations, ") + format_seconds(watch.seconds()));
  tell("in a scene that uses it:");
  for (const std::string& line : lines) tell("  " + line);
  print_warnings(found.warnings);
  return done;
}

}  // namespace

void add_rest_shape(CommandLine& line, Action& action) {
  auto options = std::make_shared<RestShapeCommand>();
  const Command command = line.command(
      "rest-shape", "Inverse design: find the stress-free shape that the loads deform into the drawn shape");
  command.option("scene", options->scene, "Scene file of a static analysis (.toml)")
      .required()
      .is_file({"toml"});
  command
      .option("--out", options->out, "Output folder, one mesh per body; default: out/NAME_rest of the scene")
      .type_name("DIR")
      .is_folder();
  command.option("--set", options->overrides, "Change a value of the scene first; repeatable")
      .type_name("KEY=VALUE")
      .repeatable()
      .offers(scene_settings);
  command.flag("--quiet", options->quiet, "Print nothing but warnings");
  command.footer(
      "The meshes of the scene are the shape under load. The command writes the stress-free meshes "
      "with\ntheir groups, and prints the scene lines to use them. A run from the found shape must end "
      "within\n1e-8 of the size.\n"
      "Example:\n  resilin rest-shape examples/straight_beam.toml --out out/mould\n\n"
      "Exit codes: 0 found; 1 the scene is wrong, or there is no such shape; 2 interrupted.");
  command.on_chosen([options, &action] { action = [options] { return find(*options); }; });
}

}  // namespace resilin::cli
