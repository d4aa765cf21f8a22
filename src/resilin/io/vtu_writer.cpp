#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <memory>
#include <ostream>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/vtu.hpp"

// VTK XML unstructured grids. Source: Kitware, "VTK XML formats"; cell types from vtkCellType.h.

namespace resilin {
namespace {

constexpr std::array<std::pair<int, CellKind>, 11> cell_types = {{{1, CellKind::point},
                                                                  {3, CellKind::line},
                                                                  {5, CellKind::triangle},
                                                                  {9, CellKind::quadrilateral},
                                                                  {10, CellKind::tetrahedron},
                                                                  {12, CellKind::hexahedron},
                                                                  {13, CellKind::prism},
                                                                  {14, CellKind::pyramid},
                                                                  {21, CellKind::line3},
                                                                  {22, CellKind::triangle6},
                                                                  {24, CellKind::tetrahedron10}}};

/// Second-order types of which the corners are used.
struct ReducedType {
  std::int64_t type;
  CellKind kind;
  std::size_t num_nodes;
};
constexpr std::array<ReducedType, 6> reduced_types = {{{23, CellKind::quadrilateral, 8},
                                                       {25, CellKind::hexahedron, 20},
                                                       {26, CellKind::prism, 15},
                                                       {27, CellKind::pyramid, 13},
                                                       {28, CellKind::quadrilateral, 9},
                                                       {29, CellKind::hexahedron, 27}}};

/// Text that is safe between the quotes of an XML attribute.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < 0x20 ? '_' : c;
    }
  }
  return result;
}

/// Collects the headers now and the raw bytes for the appended section at the end.
class Appended {
 public:
  explicit Appended(std::ostream& stream) : stream_(stream) {}

  template <class T>
  void array(std::string_view type, std::string_view name, int components, std::span<const T> values) {
    stream_ << "<DataArray type=\"" << type << "\" Name=\"" << escaped(name) << "\" NumberOfComponents=\""
            << components << "\" format=\"appended\" offset=\"" << offset_ << "\"/>\n";
    add_bytes(std::as_bytes(values));
  }

  /// Field data need the number of tuples.
  void single_value(std::string_view name, double value) {
    kept_.push_back(std::make_unique<double>(value));
    stream_ << "<DataArray type=\"Float64\" Name=\"" << escaped(name)
            << "\" NumberOfTuples=\"1\" format=\"appended\" offset=\"" << offset_ << "\"/>\n";
    add_bytes(std::as_bytes(std::span<const double>(kept_.back().get(), 1)));
  }

  void write() {
    stream_ << "<AppendedData encoding=\"raw\">\n_";
    for (const auto& bytes : arrays_) {
      const std::uint64_t size = bytes.size();
      stream_.write(reinterpret_cast<const char*>(&size), sizeof size);
      stream_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    stream_ << "\n</AppendedData>\n";
  }

 private:
  void add_bytes(std::span<const std::byte> bytes) {
    arrays_.push_back(bytes);
    offset_ += bytes.size() + sizeof(std::uint64_t);
  }

  std::ostream& stream_;
  std::vector<std::span<const std::byte>> arrays_;
  std::vector<std::unique_ptr<double>> kept_;
  std::uint64_t offset_ = 0;
};

/// Cells in VTK's form.
struct VtkCells {
  std::vector<std::int64_t> connectivity;
  std::vector<std::int64_t> offsets;
  std::vector<std::uint8_t> types;
};

VtkCells vtk_cells(std::span<const CellBlock> blocks) {
  VtkCells cells;
  std::array<Index, max_cell_nodes> nodes{};
  for (const CellBlock& block : blocks) {
    for (Index cell = 0; cell < block.num_cells(); ++cell) {
      const auto given = block.cell(cell);
      std::copy(given.begin(), given.end(), nodes.begin());
      exchange_vtk_nodes(block.kind, std::span(nodes).first(given.size()));
      for (std::size_t n = 0; n < given.size(); ++n) cells.connectivity.push_back(nodes[n]);
      cells.offsets.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
      cells.types.push_back(static_cast<std::uint8_t>(vtk_cell_type(block.kind)));
    }
  }
  return cells;
}

void check_length(const VtuArray& array, std::size_t count, std::string_view what) {
  const std::size_t expected = count * static_cast<std::size_t>(array.components);
  if (array.values.size() == expected) return;
  throw InputError("VTU array \"" + array.name + "\"",
                   std::to_string(expected) + " values (" + std::to_string(array.components) +
                       " for each of " + std::to_string(count) + " " + std::string(what) + ")",
                   std::to_string(array.values.size()));
}

void write_data(std::ostream& stream, Appended& appended, std::string_view element,
                std::span<const VtuArray> arrays) {
  stream << '<' << element << ">\n";
  for (const VtuArray& array : arrays) appended.array("Float64", array.name, array.components, array.values);
  stream << "</" << element << ">\n";
}

}  // namespace

int vtk_cell_type(CellKind kind) {
  for (const auto& [type, known] : cell_types) {
    if (known == kind) return type;
  }
  return 0;
}

std::optional<VtkCell> vtk_cell(std::int64_t type, std::size_t size) {
  for (const auto& [known, kind] : cell_types)
    if (known == type) return VtkCell{kind, static_cast<std::size_t>(num_nodes(kind))};
  for (const ReducedType& known : reduced_types)
    if (known.type == type) return VtkCell{known.kind, known.num_nodes};
  constexpr std::int64_t polygon = 7, pixel = 8, voxel = 11;
  if (type == polygon && size >= 3) return VtkCell{CellKind::triangle, size, /*is_polygon=*/true};
  if (type == pixel) return VtkCell{CellKind::quadrilateral, 4, false, /*is_lattice=*/true};
  if (type == voxel) return VtkCell{CellKind::hexahedron, 8, false, /*is_lattice=*/true};
  return std::nullopt;
}

void exchange_vtk_nodes(CellKind kind, std::span<Index> nodes) {
  // The last two edges of a tetrahedron are (1,3), (2,3) in VTK and (2,3), (1,3) in MSH.
  if (kind == CellKind::tetrahedron10) std::swap(nodes[8], nodes[9]);
}

void write_vtu(std::ostream& stream, const VtuData& data) {
  static_assert(sizeof(Vector3) == 3 * sizeof(double));
  const VtkCells cells = vtk_cells(data.blocks);
  for (const VtuArray& array : data.point_data) check_length(array, data.points.size(), "points");
  for (const VtuArray& array : data.cell_data) check_length(array, cells.types.size(), "cells");

  constexpr bool is_little = std::endian::native == std::endian::little;
  stream << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\""
         << (is_little ? "LittleEndian" : "BigEndian") << "\" header_type=\"UInt64\">\n<UnstructuredGrid>\n";
  Appended appended(stream);
  if (data.time || !data.numbers.empty()) {
    stream << "<FieldData>\n";
    if (data.time) appended.single_value("TimeValue", *data.time);
    for (const auto& [name, number] : data.numbers) appended.single_value(name, number);
    stream << "</FieldData>\n";
  }
  stream << "<Piece NumberOfPoints=\"" << data.points.size() << "\" NumberOfCells=\"" << cells.types.size()
         << "\">\n";
  write_data(stream, appended, "PointData", data.point_data);
  write_data(stream, appended, "CellData", data.cell_data);
  const std::span<const double> coordinates(data.points.empty() ? nullptr : data.points[0].data(),
                                            3 * data.points.size());
  stream << "<Points>\n";
  appended.array("Float64", "Points", 3, coordinates);
  stream << "</Points>\n<Cells>\n";
  appended.array<std::int64_t>("Int64", "connectivity", 1, cells.connectivity);
  appended.array<std::int64_t>("Int64", "offsets", 1, cells.offsets);
  appended.array<std::uint8_t>("UInt8", "types", 1, cells.types);
  stream << "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
  appended.write();
  stream << "</VTKFile>\n";
}

void write_vtu(const std::filesystem::path& path, const VtuData& data) {
  write_atomically(path, [&](std::ostream& stream) { write_vtu(stream, data); });
}

void write_vtu_mesh(std::ostream& stream, const Mesh& mesh) {
  // A field of one block gets NaN on the cells of the others; a group is 1 on its cells and 0 elsewhere.
  std::vector<std::size_t> first_cell;
  std::size_t num_cells = 0;
  for (const CellBlock& block : mesh.blocks) {
    first_cell.push_back(num_cells);
    num_cells += static_cast<std::size_t>(block.num_cells());
  }
  std::vector<std::vector<double>> arrays;
  VtuData data{mesh.vertices, mesh.blocks, {}, {}};
  const auto add = [&](const std::string& name, std::vector<double> values) {
    arrays.push_back(std::move(values));
    data.cell_data.push_back({name, 1, {}});
  };
  for (const CellField& field : mesh.cell_fields) {
    std::vector<double> values(num_cells, std::numeric_limits<double>::quiet_NaN());
    std::copy(field.values.begin(), field.values.end(),
              values.begin() + static_cast<std::ptrdiff_t>(first_cell[field.block]));
    add(field.name, std::move(values));
  }
  for (const Group& group : mesh.groups) {
    std::vector<double> values(num_cells, 0.0);
    for (std::size_t b = 0; b < group.cells.size(); ++b) {
      for (const Index cell : group.cells[b]) values[first_cell[b] + static_cast<std::size_t>(cell)] = 1;
    }
    add("group:" + group.name, std::move(values));
  }
  for (std::size_t i = 0; i < arrays.size(); ++i) data.cell_data[i].values = arrays[i];

  // Vertices of groups, since a group may hold vertices without cells.
  std::vector<std::vector<double>> on_vertices;
  for (const Group& group : mesh.groups) {
    std::vector<double>& values = on_vertices.emplace_back(mesh.vertices.size(), 0.0);
    for (const Index v : group.vertices) values[static_cast<std::size_t>(v)] = 1;
  }
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    data.point_data.push_back({"group:" + mesh.groups[g].name, 1, on_vertices[g]});
  }
  write_vtu(stream, data);
}

void write_pvtu(const std::filesystem::path& path, const VtuData& piece,
                std::span<const std::string> sources) {
  write_atomically(path, [&](std::ostream& stream) {
    const auto write_arrays = [&](const char* name, std::span<const VtuArray> arrays) {
      stream << '<' << name << ">\n";
      for (const VtuArray& array : arrays)
        stream << "<PDataArray type=\"Float64\" Name=\"" << escaped(array.name) << "\" NumberOfComponents=\""
               << array.components << "\"/>\n";
      stream << "</" << name << ">\n";
    };
    stream << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\""
           << (std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian")
           << "\" header_type=\"UInt64\">\n<PUnstructuredGrid GhostLevel=\"0\">\n";
    write_arrays("PPointData", piece.point_data);
    write_arrays("PCellData", piece.cell_data);
    stream
        << "<PPoints>\n<PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n";
    for (const std::string& source : sources) stream << "<Piece Source=\"" << escaped(source) << "\"/>\n";
    stream << "</PUnstructuredGrid>\n</VTKFile>\n";
  });
}

void write_pvd(const std::filesystem::path& path, std::span<const PvdEntry> entries) {
  write_atomically(path, [&](std::ostream& stream) {
    stream << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
    for (const PvdEntry& entry : entries) {
      stream << "<DataSet timestep=\"" << format_number(entry.time) << "\" part=\"0\" file=\""
             << escaped(entry.file) << "\"/>\n";
    }
    stream << "</Collection>\n</VTKFile>\n";
  });
}

}  // namespace resilin
