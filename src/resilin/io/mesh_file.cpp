#include "resilin/io/mesh_file.hpp"

#include <algorithm>
#include <array>

#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/mesh/cut_cells.hpp"
#include "resilin/mesh/edit.hpp"

namespace resilin {
namespace {

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  return lower_case(extension);
}

bool has_extension(const MeshFormat& format, const std::string& extension) {
  return std::find(format.extensions.begin(), format.extensions.end(), extension) != format.extensions.end();
}

/// "MSH (.msh), Medit (.mesh), ..." of the formats that can be read or written.
std::string known_formats(bool for_writing) {
  std::vector<std::string> words;
  for (const MeshFormat& format : mesh_formats()) {
    if (for_writing && format.write == nullptr) continue;
    std::vector<std::string> extensions;
    for (const std::string_view extension : format.extensions)
      extensions.push_back("." + std::string(extension));
    words.push_back(std::string(format.name) + " (" + join(extensions) + ")");
  }
  return join(words);
}

/// Advice on how to convert a file that cannot be read.
std::string cure_of_unknown(const MeshSource& source) {
  const std::string extension = source.extension();
  constexpr std::array<std::string_view, 5> geometries = {"step", "stp", "iges", "igs", "brep"};
  if (std::ranges::find(geometries, extension) != geometries.end())
    return "it is a geometry without a mesh: `gmsh FILE." + extension + " -3 -o FILE.msh` makes one";
  return "in Python, resilin.Mesh.from_meshio(meshio.read(FILE)) takes what meshio reads, such as XDMF";
}

const MeshFormat& format_of(const MeshSource& source) {
  if (source.bytes.empty()) throw InputError(source.name, "the file is empty");
  for (const MeshFormat& format : mesh_formats()) {
    if (format.has_signature != nullptr && format.has_signature(source.bytes)) return format;
  }
  for (const MeshFormat& format : mesh_formats()) {
    if (has_extension(format, source.extension())) return format;
  }
  throw InputError(source.name, "a mesh in one of the formats " + known_formats(false), "something else",
                   cure_of_unknown(source));
}

/// Throws OutOfMemory where a mesh file does not fit: its bytes and, in whatever format, half as many for the
/// mesh.
void foresee_reading(const std::filesystem::path& path) {
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (!failure && !fits(1.5 * static_cast<double>(size)))
    foresee_memory(1.5 * static_cast<double>(size), "reading " + path.string(),
                   "take a coarser mesh, or raise the limit");
}

bool is_flat(const Mesh& mesh) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vector3& X) { return X.z() == 0; });
}

bool has_cells_of(const Mesh& mesh, int dimension) {
  return std::ranges::any_of(mesh.blocks, [&](const CellBlock& block) {
    return block.num_cells() > 0 && resilin::dimension(block.kind) == dimension;
  });
}

/// Triangles and quadrilaterals outside the plane z = 0 are no body in 2D.
bool is_surface_in_space(const Mesh& mesh) {
  return has_cells_of(mesh, 2) && !has_cells_of(mesh, 3) && !is_flat(mesh);
}

void add_warning(MeshFile& file, const std::string& text) {
  if (!text.empty()) file.warnings.push_back(file.numbering.file + ": " + text);
}

/// A body has cells of one kind.
void make_one_kind(MeshFile& file, int dimension) {
  if (file.mesh.is_whole()) add_warning(file, cut_into_simplices(file.mesh, dimension, file.numbering));
}

}  // namespace

std::string MeshSource::extension() const { return lower_case_extension(name); }

std::string MeshSource::name_beside(const std::string& extension) const {
  return std::filesystem::path(name).filename().replace_extension(extension).string();
}

std::string MeshSource::file_beside(const std::string& other, const std::string& place,
                                    const std::string& cure) const {
  const bool is_elsewhere = other.empty() || other[0] == '/' || other.find("..") != other.npos ||
                            other.find(':') != other.npos || other.find('\0') != other.npos;
  if (is_elsewhere) throw InputError(place, "a file beside this one", printable(other));
  if (!companion) throw InputError(place, "data in the file itself", "the file " + printable(other), cure);
  return companion(other);
}

MeshFile read_mesh(const std::filesystem::path& path) {
  foresee_reading(path);
  const std::string bytes = read_file(path);
  return read_mesh_from_memory(path.string(), bytes, [&path](const std::string& name) {
    return read_file(path.parent_path() / name);
  });
}

MeshFile read_mesh_from_memory(const std::string& name, std::string_view bytes, const Companion& companion) {
  const MeshSource source{name, without_byte_order_mark(bytes, name), companion};
  const MeshFormat& format = format_of(source);
  MeshFile file = format.read(source);
  file.is_surface |= format.holds_surfaces;
  file.is_surface = file.is_surface || is_surface_in_space(file.mesh);
  return file;
}

void prepare_solid_mesh(MeshFile& file, int dimension) {
  make_one_kind(file, dimension);
  const MeshReport report = check_mesh(file.mesh, dimension, file.numbering);
  report.require_no_errors();
  for (const MeshIssue& warning : report.warnings) file.warnings.push_back(warning.text());
  reorient(file.mesh, file.mesh.find_solid(dimension)->kind);
}

void prepare_surface(MeshFile& file) {
  to_first_order(file.mesh);
  cut_into_triangles(file.mesh, file.numbering);
}

void use_corners_only(MeshFile& file) {
  if (!to_first_order(file.mesh)) return;
  file.warnings.push_back(file.numbering.file +
                          ": second-order cells are used by their corners (straight sides)");
}

MeshFile read_solid_mesh(const std::filesystem::path& path, int dimension) {
  MeshFile file = read_mesh(path);
  prepare_solid_mesh(file, dimension);
  return file;
}

MeshReport check_mesh_file(const MeshFile& file) {
  const bool is_solid = has_cells_of(file.mesh, 3);
  if (is_solid || (!file.is_surface && is_flat(file.mesh))) {
    const int dimension = is_solid ? 3 : 2;
    if (!needs_cuts(file.mesh, dimension)) return check_mesh(file.mesh, dimension, file.numbering);
    MeshFile cut = file;
    const std::string words = cut_into_simplices(cut.mesh, dimension, cut.numbering);
    MeshReport report = check_mesh(cut.mesh, dimension, cut.numbering);
    report.warnings.push_back({file.numbering.file, words});
    return report;
  }
  MeshFile surface = file;
  prepare_surface(surface);
  return check_surface(surface.mesh, surface.numbering);
}

void write_mesh(const std::filesystem::path& path, const Mesh& mesh) {
  for (const MeshFormat& format : mesh_formats()) {
    if (format.write == nullptr || !has_extension(format, lower_case_extension(path))) continue;
    write_atomically(path, [&](std::ostream& stream) { format.write(stream, mesh); });
    return;
  }
  throw InputError(path.string(), "an extension of " + known_formats(true),
                   "\"" + path.extension().string() + "\"");
}

}  // namespace resilin
