#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Values on points or cells, `components` numbers each, one after another. Views: the numbers stay the
/// caller's.
struct VtuArray {
  std::string name;
  int components = 1;  ///< 1: scalars; 3: vectors; 9: tensors, row by row
  std::span<const double> values;
};

/// One time of a result, or a mesh, for ParaView.
struct VtuData {
  std::span<const Vector3> points;    ///< [m]
  std::span<const CellBlock> blocks;  ///< written one after another
  std::vector<VtuArray> point_data;
  std::vector<VtuArray> cell_data;             ///< over the cells of all blocks, in their order
  std::optional<double> time = {};             ///< [s], shown by ParaView
  std::map<std::string, double> numbers = {};  ///< numbers of the whole
};

/// Writes VTK XML (UnstructuredGrid) with raw appended doubles; beside and renamed.
/// @throws InputError  when an array has another length than points or cells ask for
void write_vtu(const std::filesystem::path& path, const VtuData& data);
void write_vtu(std::ostream& stream, const VtuData& data);  ///< a stream of the classic locale, binary

/// The file that joins pieces, each a .vtu file with the arrays of `piece`, into one result (.pvtu).
/// @param sources  of the pieces, relative to the file
void write_pvtu(const std::filesystem::path& path, const VtuData& piece,
                std::span<const std::string> sources);

/// Values read from a file: `components` numbers for each point or cell, one after another.
struct VtuValues {
  std::string name;
  int components = 1;
  std::vector<double> values;
};

/// Content of a .vtu file; cell data are in the order of the file, block by block when we wrote it.
struct VtuContent {
  MeshFile file;
  std::vector<VtuValues> point_data;
  std::vector<VtuValues> cell_data;
  std::optional<double> time = {};
  std::map<std::string, double> numbers = {};  ///< others of the whole
};

/// Reads VTK XML unstructured grids: one piece, ASCII, base64 or appended (raw or base64), also
/// compressed by zlib.
/// Scalars per cell are also in `file.mesh.cell_fields`. @throws InputError
VtuContent read_vtu(const std::filesystem::path& path);
/// The same from bytes in memory; `name` is for messages. @throws InputError  for a malformed file
VtuContent read_vtu_from_memory(const std::string& name, std::string_view bytes);

/// One frame of a series; `file` is relative to the .pvd file.
struct PvdEntry {
  double time;
  std::string file;
};
/// Writes the list of frames that ParaView opens, in one step. @throws FileError
void write_pvd(const std::filesystem::path& path, std::span<const PvdEntry> entries);

/// VTK's number of a kind of cell.
int vtk_cell_type(CellKind kind);
/// Meaning of a VTK cell type: the kind of the first nodes, or a polygon, which is cut into triangles.
struct VtkCell {
  CellKind kind;
  std::size_t num_nodes;
  bool is_polygon = false;
  bool is_lattice = false;  ///< a pixel or a voxel, whose corners are in the order of a lattice
};
/// @param size  points of the cell, which a polygon may have any number of
/// @return empty for a type that is not read
std::optional<VtkCell> vtk_cell(std::int64_t type, std::size_t size);
/// Exchanges the nodes that VTK and MSH order differently (its own inverse).
void exchange_vtk_nodes(CellKind kind, std::span<Index> nodes);

}  // namespace resilin
