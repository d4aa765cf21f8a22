#include "mesher.hpp"

#include <fstream>

#include "resilin/core/text.hpp"
#include "resilin/io/mesh_file.hpp"

namespace resilin::cli {
namespace {

// ---- Gmsh: gmsh.info

std::optional<std::filesystem::path> find_gmsh(const std::filesystem::path&) { return find_program("gmsh"); }

/// Cuts the surface into patches, meshes them anew, finer where they are curved, and fills what they enclose.
std::string gmsh_script(double size) {
  constexpr double finest =
      1.0 / 3;  // smallest cells, relative to the size; coarser ones would cut thin parts off
  return "Merge \"surface.msh\";\n"
         "ClassifySurfaces{40 * Pi / 180, 1, 1, Pi};\n"
         "CreateGeometry;\n"
         "patches() = Surface{:};\n"
         "Surface Loop(1) = patches();\n"
         "Volume(1) = {1};\n"
         "Physical Volume(\"body\") = {1};\n"
         "Mesh.MeshSizeMin = " +
         format_number(finest * size) + ";\nMesh.MeshSizeMax = " + format_number(size) +
         ";\n"
         "Mesh.MeshSizeFromCurvature = 6;\n"
         "Mesh.MeshSizeFromPoints = 0;\n"
         "Mesh.Optimize = 1;\n"
         "Mesh.OptimizeNetgen = 1;\n"
         "General.NumThreads = 1;\n";
}

Subprocess run_gmsh(const std::filesystem::path& program, const std::filesystem::path& folder, double size,
                    double, double seconds) {
  write_mesh(folder / "surface.msh", read_mesh(folder / "surface.obj").mesh);
  std::ofstream(folder / "fill.geo") << gmsh_script(size);
  return run_subprocess(program, {"fill.geo", "-3", "-format", "msh41", "-o", "filled.msh"}, folder, seconds);
}

// ---- fTetWild by its Python package: github.com/pyvista/pytetwild

std::optional<std::filesystem::path> find_pytetwild(const std::filesystem::path& folder) {
  constexpr double seconds = 60;  // a first import compiles
  const auto python = find_program("python3");
  if (!python) return std::nullopt;
  const Subprocess import = run_subprocess(*python, {"-c", "import pytetwild"}, folder, seconds);
  const bool is_there = import.end == Subprocess::End::exited && import.exit_code == 0;
  return is_there ? python : std::nullopt;
}

constexpr const char* pytetwild_script = R"(import sys
import numpy
import pytetwild

size, extent = float(sys.argv[1]), float(sys.argv[2])
rows = [line.split() for line in open("surface.obj")]
vertices = numpy.array([[float(x) for x in row[1:4]] for row in rows if row[:1] == ["v"]])
faces = numpy.array([[int(i) - 1 for i in row[1:4]] for row in rows if row[:1] == ["f"]], dtype=numpy.int32)
points, cells = pytetwild.tetrahedralize(
    vertices, faces, edge_length_abs=size, epsilon=0.1 * size / extent, num_threads=1, quiet=True)
with open("filled.mesh", "w") as file:
    print("MeshVersionFormatted 2\nDimension 3\nVertices", len(points), sep="\n", file=file)
    for point in points.tolist():
        print(*map(repr, point), 0, file=file)
    print("Tetrahedra", len(cells), sep="\n", file=file)
    for cell in cells.tolist():
        print(*(i + 1 for i in cell), 0, file=file)
    print("End", file=file)
)";

Subprocess run_pytetwild(const std::filesystem::path& program, const std::filesystem::path& folder,
                         double size, double extent, double seconds) {
  return run_subprocess(program, {"-c", pytetwild_script, format_number(size), format_number(extent)}, folder,
                        seconds);
}

}  // namespace

const std::vector<Mesher>& meshers() {
  static const std::vector<Mesher> table = {
      {"pytetwild", "pip install pytetwild pyvista", false, find_pytetwild, run_pytetwild, "filled.mesh"},
      {"gmsh", "pip install gmsh, or apt-get install gmsh", true, find_gmsh, run_gmsh, "filled.msh"},
  };
  return table;
}

}  // namespace resilin::cli
