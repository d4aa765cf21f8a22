#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "resilin/io/mesh_file.hpp"

namespace resilin {

/// Finds things by the numbers that a file gives them: an addition when they count on, a search otherwise.
class NumberIndex {
 public:
  void add(std::int64_t number);
  Index find(std::int64_t number) const;  ///< -1 when there is none; needs `sort` after the last `add`
  void sort();
  bool is_consecutive() const { return is_consecutive_; }
  std::int64_t first() const { return numbers_.empty() ? 0 : numbers_.front(); }
  std::int64_t smallest() const;
  std::int64_t largest() const;
  /// Position of a number that was added before, -1 when all differ. Needs `sort`.
  Index duplicate() const;
  const std::vector<std::int64_t>& numbers() const { return numbers_; }

 private:
  std::vector<std::int64_t> numbers_;
  std::vector<std::pair<std::int64_t, Index>> sorted_;  ///< filled by `sort` when not consecutive
  bool is_consecutive_ = true;
};

/// Puts a MeshFile together while a file is read, and checks all that has to do with numbers.
class MeshBuilder {
 public:
  struct Cell {
    std::size_t block;
    Index number;
  };

  MeshBuilder(std::string file, std::string format, std::string cell_word = "element");

  void add_vertex(std::int64_t number, const Vector3& position);
  void finish_vertices();  ///< to be called before cells are added; refuses a number used twice

  /// The vertex that a cell names. @throws InputError "FILE: element N: expected a node id ..., got ..."
  Index vertex(std::int64_t number, std::int64_t cell_number) const;
  /// Node `position` of a cell of this kind; says so when it is the missing one in the middle of an edge.
  Index vertex(std::int64_t number, std::int64_t cell_number, CellKind kind, std::size_t position) const;
  Index find_vertex(std::int64_t number) const { return vertices_.find(number); }  ///< -1 when there is none
  Index num_vertices() const { return static_cast<Index>(file_.mesh.vertices.size()); }

  /// A hexahedron, prism, pyramid or quadrilateral some of whose corners are the same vertex becomes the cell
  /// of those that differ, where it is one of our kinds.
  Cell add_cell(CellKind kind, std::int64_t number, std::span<const Index> nodes);
  /// A cell by the numbers of its nodes in the order of VTK, which is that of most formats. Nodes beyond
  /// those of `kind`, as a hexahedron of 20 has them, are passed over; `finish` leaves out those of no other
  /// cell.
  Cell add_cell_of_numbers(CellKind kind, std::int64_t number, std::span<const std::int64_t> nodes);

  /// A polygon as a fan of triangles; of a strip every second triangle is turned, and those without area,
  /// which join parts of it, are left out.
  std::vector<Cell> add_polygon(std::int64_t number, std::span<const std::int64_t> points, bool is_strip);

  std::size_t group(const std::string& name);  ///< made when there is none
  void add_to_group(std::size_t group, Cell cell);
  void add_vertex_to_group(std::size_t group, Index vertex);

  /// One value of a field; fields that do not cover a whole block are left out with a warning.
  void set_cell_value(const std::string& field, Cell cell, double value);
  /// The cell with this number in the file, in the first block that has it. Sorts at the first call.
  bool find_cell(std::int64_t number, Cell& cell);

  void warn(const std::string& text) { file_.warnings.push_back(file_.numbering.file + ": " + text); }
  MeshFile finish();  ///< @throws InputError "FILE: no elements"

  std::string cell_place(std::int64_t number) const;  ///< "FILE: element N"

 private:
  void leave_out_middles();
  void finish_groups();
  void finish_numbering();
  void finish_fields();

  MeshFile file_;
  NumberIndex vertices_;
  std::vector<NumberIndex> cells_;
  bool cells_are_sorted_ = false;
  std::map<std::string, std::size_t, std::less<>> group_numbers_;
  std::map<std::pair<std::string, std::size_t>, std::vector<double>> values_;
  std::map<CellKind, std::size_t> block_numbers_;
  std::map<CellKind, Index> num_reduced_;  ///< cells whose nodes in the middle of edges are passed over
  std::vector<Index> middles_;             ///< those nodes
};

struct VtkCell;
/// Adds the cell of a VTK type, all pieces of a polygon. @param points  numbers, as many as the type has
std::vector<MeshBuilder::Cell> add_vtk_cell(MeshBuilder& mesh, const VtkCell& type, std::int64_t number,
                                            std::span<const std::int64_t> points);

/// Name of a group for which the file has only a number: "volume_3", "surface_3", "curve_3", "point_3".
std::string numbered_group_name(int dimension, std::int64_t number);

}  // namespace resilin
