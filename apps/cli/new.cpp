#include <fmt/format.h>

#include <Eigen/Geometry>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "command.hpp"
#include "offered_words.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/quoted_text.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/surface_lattice.hpp"
#include "resilin/scene/scene.hpp"
#include "terminal.hpp"
#include "viewer/bare_mesh.hpp"

namespace resilin::cli {
namespace {

constexpr double gravity = 9.81;    // [m/s^2]
constexpr double density = 1000;    // [kg/m^3]
constexpr double stiffness = 1000;  // Young's modulus by density gravity extent: little sag
constexpr double held_share = 0.1;  // held share of the height
constexpr double least_spread =
    0.05;  // least spread of held vertices, by the extent: so that they hold against turning

struct NewOptions {
  std::string mesh, out, up = "auto";
  double scale = 1;
  int cells = LatticeOptions{}.cells;
};

std::string number(double value) { return fmt::format("{:.9g}", value); }

/// Rounded up to one digit.
double one_digit(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)));
  return std::ceil(value / unit * (1 - 1e-9)) * unit;
}

/// Measures from which the numbers of the scene follow.
struct Measures {
  int dim;
  int up;                         ///< axis against gravity
  BoundingBox box;                ///< box of the surface, else of the cells, once scaled [m]
  std::vector<Vector3> vertices;  ///< vertices of the cells [m]
  std::vector<std::string> warnings;

  double height() const { return box.max[up] - box.min[up]; }
};

int up_axis(const NewOptions& options, const MeshFile& file, int dim) {
  if (options.up != "auto") return options.up[0] - 'x';
  return dim == 2 || file.format == "OBJ" || file.format == "glTF" ? 1 : 2;
}

std::string mesh_text(const NewOptions& options, const MeshFile& file, const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::path path = std::filesystem::relative(options.mesh, folder, failure);
  if (failure || path.empty()) path = std::filesystem::absolute(options.mesh);
  const std::string name = quoted_text(path.string());
  return file.is_surface ? "{ surface = " + name + ", cells = " + std::to_string(options.cells) + " }" : name;
}

Measures measure(const NewOptions& options, const MeshFile& file, const std::string& mesh,
                 const std::filesystem::path& folder) {
  Measures measures;
  measures.dim = viewer::dimension_of(file);
  measures.up = up_axis(options, file, measures.dim);
  if (measures.up >= measures.dim) throw InputError("new --up", "x or y for a mesh in the plane", options.up);
  const Scene scene = read_scene_from_text("[simulation]\ndimension = " + std::to_string(measures.dim) +
                                               "\n[[body]]\nmesh = " + mesh +
                                               "\nscale = " + format_number(options.scale) + "\n",
                                           "new", folder);
  const BodyDescription& body = scene.description.bodies[0];
  measures.warnings = scene.warnings;
  measures.box = bounding_box(body.skin ? body.skin->surface : body.mesh);
  measures.box.min *= options.scale;
  measures.box.max *= options.scale;
  for (const Vector3& X : body.mesh.vertices) measures.vertices.emplace_back(options.scale * X);
  return measures;
}

/// Whether the vertices up to this height hold a body: it takes three that are not on a line, in 2D two.
bool holds(const Measures& m, double top) {
  std::vector<Vector3> held;
  for (const Vector3& X : m.vertices)
    if (X[m.up] <= top) held.push_back(X);
  const double spread = least_spread * (m.box.max - m.box.min).maxCoeff();
  for (const Vector3& a : held) {
    const Vector3 arm = a - held[0];
    if (arm.norm() < spread) continue;
    if (m.dim == 2) return true;
    for (const Vector3& b : held)
      if (arm.cross(b - held[0]).norm() > spread * arm.norm()) return true;
  }
  return false;
}

/// The height up to which vertices are held: a tenth, or as much as it takes.
double held_height(const Measures& m) {
  for (double share = held_share; share < 1; share += 0.05) {
    const double top = std::stod(number(m.box.min[m.up] + share * m.height()));
    if (holds(m, top)) return top;
  }
  return m.box.max[m.up];
}

/// "[0, 0, -9.81]".
std::string vector_text(const Vector3& value, int dim) {
  std::vector<std::string> numbers;
  for (int i = 0; i < dim; ++i) numbers.push_back(number(value[i] + 0.0));  // no -0
  return "[" + join(numbers) + "]";
}

std::string scene_text(const NewOptions& options, const std::string& mesh, bool is_surface,
                       const Measures& m) {
  const double extent = (m.box.max - m.box.min).maxCoeff();
  Vector3 low = m.box.min.array() - extent, high = m.box.max.array() + extent;
  high[m.up] = held_height(m);
  const std::string name = std::filesystem::path(options.mesh).stem().string();
  const std::string young = number(one_digit(stiffness * density * gravity * extent));
  std::string text;
  text += "# " + one_line(name) +
          " sags under its own weight, fixed at its lowest part. All keys: docs/scene.md\n";
  text += "title = " + quoted_text(one_line(name)) + "\n\n[simulation]\n";
  text += "kind = \"static\"          # quasi-static; or \"dynamic\" with time_step and end_time\n";
  if (m.dim == 2) text += "dimension = 2\n";
  text += "gravity = " + vector_text(-gravity * Vector3::Unit(m.up), m.dim) + "  # [m/s^2]\n";
  text += "\n[[body]]\nname = \"body\"\nmesh = " + mesh + "\n";
  if (is_surface) text += "# cells: tetrahedra that fill the surface; more are slower and more accurate\n";
  text += "scale = " + format_number(options.scale) +
          "                # 0.001 for a file in millimetres; it is " + format_short(extent) +
          " m long now\n";
  text += "\n[body.material]\nlaw = \"stable_neo_hookean\"  # soft tissue and rubber; others: docs/laws.md\n";
  text += "youngs_modulus = " + young +
          "   # [Pa] a guess by its size, so that it sags little; rubber has about 1e6\n";
  text += "poissons_ratio = 0.4     # rubber: up to 0.499\n";
  text += "density = " + number(density) + "           # [kg/m^3]\n";
  text +=
      "\n[[fix]]\nname = \"clamp\"           # all vertices in a box that reaches beyond the body, except "
      "its top\n";
  text += "where = { box = [" + vector_text(low, m.dim) + ", " + vector_text(high, m.dim) + "] }\n";
  text += "\n[output]\nfields = [\"displacement\", \"von_mises\"]\n";
  return text;
}

int make_scene(const NewOptions& options) {
  if (!(options.scale > 0) || !std::isfinite(options.scale))
    throw InputError("new --scale", "a number > 0", format_number(options.scale));
  const std::filesystem::path mesh_path = options.mesh;
  const std::filesystem::path out =
      options.out.empty() ? mesh_path.stem().concat(".toml") : std::filesystem::path(options.out);
  const std::filesystem::path folder = std::filesystem::absolute(out).parent_path();
  if (!std::filesystem::is_directory(folder))
    throw FileError(out.string(), "cannot be written: there is no folder " + folder.string());
  const MeshFile file = read_mesh(mesh_path);
  const std::string mesh = mesh_text(options, file, folder);
  const Measures measures = measure(options, file, mesh, folder);
  if (!write_new_file(out, scene_text(options, mesh, file.is_surface, measures)))
    throw InputError(out.string(), "exists already and is not overwritten; choose another --out");
  print_warnings(measures.warnings);
  print_line(one_line(out.string()) + ": a scene of " + one_line(options.mesh) + ", " +
             format_short((measures.box.max - measures.box.min).maxCoeff()) + " m long; next: resilin run " +
             one_line(out.string()));
  return done;
}

}  // namespace

void add_new(CommandLine& line, Action& action) {
  auto options = std::make_shared<NewOptions>();
  const Command command =
      line.command("new", "Write a commented scene for a mesh or a surface, to start from");
  command
      .option("mesh", options->mesh,
              "Mesh file, or surface (STL, PLY, OBJ, VTP, glTF), which is filled with cells")
      .required()
      .type_name("MESH")
      .is_file(mesh_extensions());
  command.option("--out", options->out, "Output scene, never overwrites a file; default MESH's name")
      .type_name("SCENE.toml")
      .is_file({"toml"});
  command.option("--scale", options->scale, "Factor on the coordinates; default 1, 0.001 for millimetres");
  command.option("--cells", options->cells, "Approximate number of tetrahedra in a surface; default 4000")
      .between(1, LatticeOptions::most_cells);
  command
      .option("--up", options->up, "Upward axis, against gravity; default z, but y for OBJ, glTF and in 2D")
      .one_of({"auto", "x", "y", "z"});
  command.footer(
      "Example:\n  resilin new data/spot_surface.obj --scale 0.1 --out spot.toml && resilin run spot.toml");
  command.on_chosen([options, &action] { action = [options] { return make_scene(*options); }; });
}

}  // namespace resilin::cli
