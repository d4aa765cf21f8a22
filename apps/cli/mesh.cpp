#include <memory>
#include <string>
#include <vector>

#include "command.hpp"
#include "fill.hpp"
#include "mesh_box.hpp"
#include "offered_words.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/generators.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

struct MeshOptions {
  std::vector<std::string> files;  ///< IN OUT, or OUT with --box
  std::vector<double> box;         ///< edge lengths; 2 or 3
  std::vector<int> cells;
  bool is_uncut = false;  ///< hexahedra, quadrilaterals
  bool reorient = false;
  bool remove_unused = false;
  bool surface = false;
  bool merge = false;
  bool fills = false;  ///< a surface with tetrahedra
  FillOptions fill;
};

Mesh make_tetrahedron_box(const Vector3& size, const std::array<int, 3>& cells, const Vector3& origin) {
  return make_box(size, cells, origin);
}

Mesh make_triangle_rectangle(const Vector<2>& size, const std::array<int, 2>& cells,
                             const Vector<2>& origin) {
  return make_rectangle(size, cells, origin);
}

Mesh make_box_mesh(const MeshOptions& options) {
  const std::string place = "mesh --box";
  for (const double length : options.box) {
    if (!(length > 0) || !std::isfinite(length))
      throw InputError(place, "lengths > 0", format_number(length));
  }
  if (options.cells.size() != options.box.size()) {
    throw InputError(place, "--cells with " + std::to_string(options.box.size()) + " numbers",
                     std::to_string(options.cells.size()), "such as --box 4 1 1 --cells 40 10 10");
  }
  for (const int count : options.cells) {
    if (count < 1) throw InputError("mesh --cells", "whole numbers >= 1", std::to_string(count));
  }
  if (options.box.size() == 2) {
    const auto make = options.is_uncut ? make_quadrilateral_rectangle : make_triangle_rectangle;
    return make({options.box[0], options.box[1]}, {options.cells[0], options.cells[1]}, {0, 0});
  }
  const auto make = options.is_uncut ? make_hexahedron_box : make_tetrahedron_box;
  return make({options.box[0], options.box[1], options.box[2]},
              {options.cells[0], options.cells[1], options.cells[2]}, {0, 0, 0});
}

/// The mesh to start from, and the name of the file that it goes to.
Mesh read_input(const MeshOptions& options, std::string& out) {
  if (!options.box.empty()) {
    if (options.fills) throw InputError("mesh --tets, --mesher", "a surface to fill", "--box");
    if (options.files.size() != 1)
      throw InputError("mesh --box", "one file, OUT", std::to_string(options.files.size()));
    out = options.files[0];
    return make_box_mesh(options);
  }
  if (!options.cells.empty()) throw InputError("mesh --cells", "--box beside it", "none");
  if (options.is_uncut) throw InputError("mesh --uncut", "--box beside it", "none");
  if (options.files.size() != 2) {
    throw InputError("mesh", "two files, IN and OUT", std::to_string(options.files.size()),
                     "see resilin mesh --help");
  }
  out = options.files[1];
  MeshFile file = read_mesh(options.files[0]);
  if (!options.fills) {
    print_warnings(file.warnings);
    return std::move(file.mesh);
  }
  Mesh filled = fill_surface(file, options.fill);
  print_warnings(file.warnings);
  remove_unused_nodes(filled);
  return filled;
}

void edit(Mesh& mesh, const MeshOptions& options) {
  if (options.reorient) {
    const int dim = mesh.find_solid(3) != nullptr ? 3 : 2;
    if (const CellBlock* solid = mesh.find_solid(dim)) {
      const CellKind kind = solid->kind;
      const std::size_t count = reorient(mesh, kind).size();
      if (count > 0) print_line("turned " + std::to_string(count) + " inverted " + std::string(name(kind)));
    }
  }
  const std::size_t num_vertices = mesh.vertices.size();
  if (options.merge) merge_duplicate_vertices(mesh);
  if (options.remove_unused) remove_unused_nodes(mesh);
  if (mesh.vertices.size() != num_vertices) {
    print_line("dropped " + std::to_string(num_vertices - mesh.vertices.size()) + " vertices");
  }
  if (options.surface) mesh = extract_surface(mesh).mesh;
}

int convert(const MeshOptions& options) {
  std::string out;
  Mesh mesh = read_input(options, out);
  edit(mesh, options);
  write_mesh(out, mesh);
  std::string summary = std::to_string(mesh.vertices.size()) + " vertices";
  for (const CellBlock& block : mesh.blocks) {
    summary += ", " + std::to_string(block.num_cells()) + " " + std::string(name(block.kind));
  }
  print_line(out + ": " + summary + ", from " + file_box_text(mesh));
  return done;
}

}  // namespace

void add_mesh(CommandLine& line, Action& action) {
  auto options = std::make_shared<MeshOptions>();
  const Command command = line.command(
      "mesh", "Convert or repair a mesh, extract its surface, fill a surface with tetrahedra, or make a box");
  command
      .option("files", options->files, "IN and OUT, or OUT alone with --box; the extension tells the format")
      .values(1, 2)
      .type_name("[IN] OUT")
      .is_file(mesh_extensions());
  command.option("--box", options->box, "Make a box (rectangle) with these edge lengths [m]")
      .values(2, 3)
      .type_name("SX SY [SZ]");
  command.option("--cells", options->cells, "Cubes (squares) along each direction of the box")
      .values(2, 3)
      .type_name("NX NY [NZ]");
  command.flag("--uncut", options->is_uncut,
               "Make hexahedra (quadrilaterals) instead of tetrahedra (triangles)");
  command.flag("--reorient", options->reorient, "Reorient inverted cells");
  command.flag("--remove-unused", options->remove_unused, "Remove unused vertices");
  command.flag("--merge", options->merge, "Merge coincident vertices");
  command.flag("--surface", options->surface, "Write the boundary as triangles");
  const Option tets =
      command
          .option("--tets", options->fill.tetrahedra,
                  "Fill the surface IN with about this many tetrahedra (5000 with --mesher alone)")
          .type_name("N");
  const Option mesher =
      command
          .option(
              "--mesher", options->fill.mesher,
              "How to fill: fitted (cells end at the surface) or lattice (congruent cells that enclose it), "
              "both built in; gmsh or pytetwild call that program")
          .type_name("NAME")
          .shows_default()
          .offers(all_meshers);
  command.option("--time-limit", options->fill.time_limit, "How long gmsh or pytetwild may take [s]")
      .type_name("SECONDS")
      .positive()
      .shows_default();
  command.footer(
      "Examples:\n  resilin mesh armadillo.node armadillo.msh --remove-unused\n  resilin mesh bar.msh "
      "bar.obj --surface\n"
      "  resilin mesh bar.msh --box 4 1 1 --cells 40 10 10\n"
      "  resilin mesh creature.obj creature.msh --tets 5000\n\nAn existing OUT is replaced once the new file "
      "is complete.");
  command.on_chosen([options, tets, mesher, &action] {
    options->fills = tets.is_given() || mesher.is_given();
    action = [options] { return convert(*options); };
  });
}

}  // namespace resilin::cli
