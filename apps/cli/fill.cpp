#include "fill.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>

#include "interrupt.hpp"
#include "mesher.hpp"
#include "resilin/core/error.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/embedding.hpp"
#include "resilin/mesh/fitted_mesh.hpp"
#include "resilin/mesh/quality.hpp"
#include "resilin/mesh/surface_groups.hpp"
#include "resilin/mesh/surface_lattice.hpp"
#include "temporary_place.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

constexpr double near_enough = 0.1;  // tolerance relative to the wanted number: no further attempt
constexpr double acceptable = 0.2;   // more is said in a warning
constexpr int most_attempts = 8;
constexpr double flat_angle = 5;  // degrees between sides; cells below it are slivers

/// Edges that do not have two triangles.
std::size_t count_open_edges(const CellBlock& triangles) {
  std::map<std::pair<Index, Index>, int> uses;
  for (Index t = 0; t < triangles.num_cells(); ++t) {
    const auto corners = triangles.cell(t);
    for (std::size_t i = 0; i < 3; ++i) ++uses[std::minmax(corners[i], corners[(i + 1) % 3])];
  }
  return static_cast<std::size_t>(
      std::ranges::count_if(uses, [](const auto& use) { return use.second != 2; }));
}

double enclosed_volume(const Mesh& surface, const CellBlock& triangles) {
  double volume = 0;
  for (Index t = 0; t < triangles.num_cells(); ++t) {
    const auto corners = triangles.cell(t);
    const auto at = [&](std::size_t i) -> const Vector3& {
      return surface.vertices[static_cast<std::size_t>(corners[i])];
    };
    volume += at(0).dot(at(1).cross(at(2))) / 6;
  }
  return std::abs(volume);
}

/// The triangles alone, every place once, checked.
Mesh cleaned(const MeshFile& file) {
  Mesh surface = file.mesh;
  to_first_order(surface);
  const CellBlock* triangles = surface.find_block(CellKind::triangle);
  if (triangles == nullptr) {
    throw InputError("mesh --tets: " + file.numbering.file, "a surface of triangles", "none",
                     "`resilin mesh IN OUT.obj --surface` makes one of a solid mesh");
  }
  const auto block = static_cast<std::size_t>(triangles - surface.blocks.data());
  for (Group& group : surface.groups) {
    std::vector<Index> own;
    if (group.cells.size() > block) own = group.cells[block];
    group.cells = {std::move(own)};
  }
  surface.blocks = {CellBlock(*triangles)};
  surface.cell_fields.clear();
  const MeshReport report = check_surface(surface, file.numbering);
  report.require_no_errors();
  merge_duplicate_vertices(surface);
  return surface;
}

/// The program to use and where it is.
struct Found {
  const Mesher* mesher;
  std::filesystem::path program;
};

Found find_mesher(const FillOptions& options, const std::filesystem::path& folder) {
  std::vector<std::string> cures;
  for (const Mesher& mesher : meshers()) {
    if (options.mesher != mesher.name) continue;
    if (const auto program = mesher.find(folder)) return {&mesher, *program};
    cures.push_back(mesher.name + " (" + mesher.how_to_install + ")");
  }
  if (cures.empty())
    throw InputError("mesh --mesher", "one of " + join(all_meshers()), "\"" + options.mesher + "\"");
  throw InputError("mesh --mesher", "a program that is installed", "none of that name on PATH",
                   "install " + join(cures, " or ") + ", or leave --mesher out");
}

/// Throws one line when the program did not make the file.
void check_end(const Subprocess& run, const Found& found, const std::filesystem::path& result,
               double seconds) {
  using enum Subprocess::End;
  const std::string place = "mesh --tets: " + found.mesher->name;
  const std::string log = run.log_end.empty() ? "it said nothing" : "it said last: " + run.log_end;
  if (run.end == interrupted) throw Interrupted();
  if (run.end == not_started) throw InputError(place, "cannot be started at " + found.program.string());
  if (run.end == out_of_time)
    throw InputError(place, "stopped after " + format_seconds(seconds) + "; " + log + "; see --time-limit");
  if (run.end == killed_by_signal)
    throw InputError(place, "was ended by signal " + std::to_string(run.exit_code) + "; " + log);
  if (run.exit_code != 0)
    throw InputError(place, "failed with exit code " + std::to_string(run.exit_code) + "; " + log);
  if (!std::filesystem::exists(result)) throw InputError(place, "made no mesh; " + log);
}

Index num_tetrahedra(const Mesh& mesh) { return mesh.find_block(CellKind::tetrahedron)->num_cells(); }

/// Calls the program with one size of cells after another until their number is near enough.
struct Attempts {
  const Found& found;
  const std::filesystem::path& folder;
  double extent;  ///< diagonal of the surface's box [m]
  const FillOptions& options;

  /// How far off the number is: a logarithm.
  double miss(const Mesh& mesh) const {
    return std::abs(std::log(static_cast<double>(num_tetrahedra(mesh)) / options.tetrahedra));
  }

  /// The nearest that comes of it. @param size  of the first attempt's cells [m]
  Mesh run(double size) const {
    const Stopwatch watch;
    const std::filesystem::path result = folder / found.mesher->result;
    Mesh best;
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
      const double rest = std::max(options.time_limit - watch.seconds(), 0.1);
      std::filesystem::remove(result);
      const Subprocess run = found.mesher->run(found.program, folder, size, extent, rest);
      if (attempt > 0 && run.end == Subprocess::End::out_of_time) break;
      check_end(run, found, result, options.time_limit);
      Mesh mesh = read_solid_mesh(result, 3).mesh;
      const Index count = num_tetrahedra(mesh);
      print_line(found.mesher->name + ": cells of " + format_short(size) + " m: " + std::to_string(count) +
                 " tetrahedra after " + format_seconds(watch.seconds()));
      size *= std::cbrt(static_cast<double>(count) / options.tetrahedra);
      if (attempt == 0 || miss(mesh) < miss(best)) best = std::move(mesh);
      if (miss(best) < near_enough) break;
    }
    return best;
  }
};

void print_volume_ratio(double ratio) {
  if (ratio > 0) print_line("the mesh has " + format_short(ratio) + " times the volume of the surface");
}

/// How well shaped the cells are and how far the given surface stands out of them.
void print_quality(const Mesh& mesh, const Mesh& surface) {
  const CellBlock& cells = *mesh.find_block(CellKind::tetrahedron);
  const std::vector<double> angles = smallest_dihedral_angles(mesh, cells);
  const auto flat = std::ranges::count_if(angles, [](double angle) { return angle < flat_angle; });
  VectorX X(static_cast<Eigen::Index>(3 * mesh.vertices.size()));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    X.segment<3>(static_cast<Eigen::Index>(3 * v)) = mesh.vertices[v];
  const Embedding embedding(*find_element("P1", 3), cells.nodes, X, surface.vertices);
  const BoundingBox box = bounding_box(surface);
  print_line("smallest angle between sides " + format_short(std::ranges::min(angles)) +
             " degrees; the surface stands at most " + format_short(embedding.outside().distance) +
             " m outside (" +
             format_short(100 * embedding.outside().distance / (box.max - box.min).maxCoeff()) +
             " % of its extent)");
  if (flat > 0)
    print_warnings({std::to_string(flat) + " tetrahedra are flat (below " + format_short(flat_angle) +
                    " degrees): another number of tetrahedra or another --mesher may do better"});
}

/// By Resilin's own meshers.
Mesh fill_by_itself(const Mesh& surface, const MeshFile& file, const FillOptions& options) {
  const std::string& name = file.numbering.file;
  Mesh mesh;
  double ratio = 0;
  if (options.mesher == "lattice") {
    SurfaceLattice lattice = make_surface_lattice(surface, name, {.cells = options.tetrahedra});
    print_warnings(lattice.remarks);
    ratio = lattice.volume_ratio;
    mesh = std::move(lattice.mesh);
  } else {
    FittedMesh fitted = make_fitted_mesh(surface, name, {.cells = options.tetrahedra});
    print_warnings(fitted.remarks);
    ratio = fitted.volume_ratio;
    mesh = std::move(fitted.mesh);
  }
  carry_groups(surface, mesh);
  print_volume_ratio(ratio);
  print_quality(mesh, surface);
  return mesh;
}

}  // namespace

std::vector<std::string> all_meshers() {
  std::vector<std::string> names = {"fitted", "lattice"};
  for (const Mesher& mesher : meshers()) names.push_back(mesher.name);
  return names;
}

Mesh fill_surface(const MeshFile& file, const FillOptions& options) {
  const std::string place = "mesh --tets";
  if (options.tetrahedra < 1)
    throw InputError(place, "a whole number >= 1", std::to_string(options.tetrahedra));
  const Mesh surface = cleaned(file);
  if (options.mesher == "fitted" || options.mesher == "lattice")
    return fill_by_itself(surface, file, options);
  const CellBlock& triangles = surface.blocks[0];
  const std::size_t open_edges = count_open_edges(triangles);
  const TemporaryPlace folder("resilin-mesh");
  const Found found = find_mesher(options, folder.path());
  if (found.mesher->needs_closed_surface && open_edges > 0) {
    throw InputError(place, file.numbering.file + " is not closed: " + std::to_string(open_edges) +
                                " edges do not have two triangles; close it, or use --mesher fitted");
  }
  write_mesh(folder.path() / "surface.obj", surface);
  const BoundingBox box = bounding_box(surface);
  const double extent = (box.max - box.min).norm();
  const double volume = enclosed_volume(surface, triangles);
  if (!(volume > 0)) throw InputError(place, file.numbering.file + " encloses no volume");

  catch_interrupts();
  const Attempts attempts{found, folder.path(), extent, options};
  Mesh best =
      attempts.run(std::cbrt(6 * std::sqrt(2.0) * volume / options.tetrahedra));  // regular tetrahedra
  if (attempts.miss(best) > acceptable)
    print_warnings({"the nearest to " + std::to_string(options.tetrahedra) + " tetrahedra that " +
                    found.mesher->name + " makes of this surface is " +
                    std::to_string(num_tetrahedra(best))});
  carry_groups(surface, best);
  print_quality(best, surface);
  return best;
}

}  // namespace resilin::cli
