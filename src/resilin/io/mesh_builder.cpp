#include "resilin/io/mesh_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/io/vtu.hpp"
#include "resilin/mesh/collapsed_cell.hpp"

namespace resilin {

void NumberIndex::add(std::int64_t number) {
  const bool is_next = numbers_.empty() || (number > numbers_.back() && number - 1 == numbers_.back());
  is_consecutive_ = is_consecutive_ && is_next;
  numbers_.push_back(number);
}

void NumberIndex::sort() {
  if (is_consecutive_) return;
  sorted_.clear();
  for (std::size_t i = 0; i < numbers_.size(); ++i) sorted_.emplace_back(numbers_[i], static_cast<Index>(i));
  std::sort(sorted_.begin(), sorted_.end());
}

Index NumberIndex::find(std::int64_t number) const {
  if (is_consecutive_) {
    // Subtract only inside the range: a file may hold any 64-bit number.
    const bool is_inside = !numbers_.empty() && number >= numbers_.front() && number <= numbers_.back();
    return is_inside ? static_cast<Index>(number - numbers_.front()) : -1;
  }
  const auto found = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair{number, Index{0}});
  return found != sorted_.end() && found->first == number ? found->second : -1;
}

std::int64_t NumberIndex::smallest() const {
  return is_consecutive_ || sorted_.empty() ? first() : sorted_.front().first;
}

std::int64_t NumberIndex::largest() const {
  if (numbers_.empty()) return 0;
  return is_consecutive_ || sorted_.empty() ? numbers_.back() : sorted_.back().first;
}

Index NumberIndex::duplicate() const {
  for (std::size_t i = 1; i < sorted_.size(); ++i) {
    if (sorted_[i].first == sorted_[i - 1].first) return sorted_[i].second;
  }
  return -1;
}

MeshBuilder::MeshBuilder(std::string file, std::string format, std::string cell_word) {
  file_.numbering.file = std::move(file);
  file_.numbering.cell_word = std::move(cell_word);
  file_.format = std::move(format);
}

void MeshBuilder::add_vertex(std::int64_t number, const Vector3& position) {
  if (file_.mesh.vertices.size() >= static_cast<std::size_t>(std::numeric_limits<Index>::max())) {
    throw InputError(file_.numbering.file, "fewer than 2^31 vertices", "more");
  }
  vertices_.add(number);
  file_.mesh.vertices.push_back(position);
}

void MeshBuilder::finish_vertices() {
  vertices_.sort();
  const Index duplicate = vertices_.duplicate();
  if (duplicate >= 0) {
    throw InputError(file_.numbering.file + ": node " +
                         std::to_string(vertices_.numbers()[static_cast<std::size_t>(duplicate)]),
                     "given twice");
  }
}

Index MeshBuilder::vertex(std::int64_t number, std::int64_t cell_number) const {
  return vertex(number, cell_number, CellKind::point, 0);
}

Index MeshBuilder::vertex(std::int64_t number, std::int64_t cell_number, CellKind kind,
                          std::size_t position) const {
  const Index found = vertices_.find(number);
  if (found >= 0) return found;
  const bool is_middle = position >= static_cast<std::size_t>(num_corners(kind));
  const std::string range = num_vertices() == 0 ? "none is defined before it"
                                                : "from " + std::to_string(vertices_.smallest()) + " to " +
                                                      std::to_string(vertices_.largest());
  throw InputError(cell_place(cell_number), "a node id that the file defines (" + range + ")",
                   std::to_string(number),
                   is_middle ? "a node in the middle of an edge is missing; save the mesh again, as second "
                               "order or as first order"
                             : "");
}

std::string MeshBuilder::cell_place(std::int64_t number) const {
  return file_.numbering.file + ": " + file_.numbering.cell_word + " " + std::to_string(number);
}

MeshBuilder::Cell MeshBuilder::add_cell_of_numbers(CellKind kind, std::int64_t number,
                                                   std::span<const std::int64_t> nodes) {
  std::array<Index, max_cell_nodes> vertices{};
  const auto size = static_cast<std::size_t>(num_nodes(kind));
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Index found = vertex(nodes[n], number, kind, n);
    if (n < size) vertices[n] = found;
    if (n >= size) middles_.push_back(found);
  }
  if (nodes.size() > size) ++num_reduced_[kind];
  exchange_vtk_nodes(kind, std::span(vertices).first(size));
  return add_cell(kind, number, std::span(vertices).first(size));
}

MeshBuilder::Cell MeshBuilder::add_cell(CellKind kind, std::int64_t number, std::span<const Index> nodes) {
  if (const auto collapsed = cell_of_different_corners(kind, nodes))
    return add_cell(collapsed->kind, number, collapsed->all());
  const auto [found, is_new] = block_numbers_.try_emplace(kind, file_.mesh.blocks.size());
  if (is_new) {
    file_.mesh.blocks.push_back({kind, {}});
    cells_.emplace_back();
  }
  CellBlock& block = file_.mesh.blocks[found->second];
  if (block.nodes.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max()) - nodes.size()) {
    throw InputError(file_.numbering.file, "fewer than 2^31 cell corners", "more");
  }
  const Cell cell{found->second, block.num_cells()};
  block.nodes.insert(block.nodes.end(), nodes.begin(), nodes.end());
  cells_[cell.block].add(number);
  cells_are_sorted_ = false;
  return cell;
}

std::vector<MeshBuilder::Cell> MeshBuilder::add_polygon(std::int64_t number,
                                                        std::span<const std::int64_t> points, bool is_strip) {
  std::vector<Cell> cells;
  for (std::size_t i = 2; i < points.size(); ++i) {
    const bool is_turned = is_strip && i % 2 == 1;
    const std::array<Index, 3> nodes = {vertex(points[is_strip ? i - 2 : 0], number),
                                        vertex(points[is_turned ? i : i - 1], number),
                                        vertex(points[is_turned ? i - 1 : i], number)};
    const bool is_fold = nodes[0] == nodes[1] || nodes[1] == nodes[2] || nodes[2] == nodes[0];
    if (!(is_strip && is_fold)) cells.push_back(add_cell(CellKind::triangle, number, nodes));
  }
  return cells;
}

std::vector<MeshBuilder::Cell> add_vtk_cell(MeshBuilder& mesh, const VtkCell& type, std::int64_t number,
                                            std::span<const std::int64_t> points) {
  if (type.is_polygon) return mesh.add_polygon(number, points, /*is_strip=*/false);
  if (!type.is_lattice) return {mesh.add_cell_of_numbers(type.kind, number, points)};
  std::vector<std::int64_t> around(points.begin(), points.end());
  for (std::size_t layer = 2; layer < around.size(); layer += 4) std::swap(around[layer], around[layer + 1]);
  return {mesh.add_cell_of_numbers(type.kind, number, around)};
}

std::size_t MeshBuilder::group(const std::string& name) {
  const auto [found, is_new] = group_numbers_.try_emplace(name, file_.mesh.groups.size());
  if (is_new) file_.mesh.groups.push_back({name, {}, {}});
  return found->second;
}

void MeshBuilder::add_to_group(std::size_t group, Cell cell) {
  auto& cells = file_.mesh.groups[group].cells;
  if (cells.size() <= cell.block) cells.resize(cell.block + 1);
  cells[cell.block].push_back(cell.number);
}

void MeshBuilder::add_vertex_to_group(std::size_t group, Index vertex) {
  file_.mesh.groups[group].vertices.push_back(vertex);
}

bool MeshBuilder::find_cell(std::int64_t number, Cell& cell) {
  if (!cells_are_sorted_) {
    for (NumberIndex& numbers : cells_) numbers.sort();
    cells_are_sorted_ = true;
  }
  for (std::size_t b = 0; b < cells_.size(); ++b) {
    const Index found = cells_[b].find(number);
    if (found < 0) continue;
    cell = {b, found};
    return true;
  }
  return false;
}

void MeshBuilder::set_cell_value(const std::string& field, Cell cell, double value) {
  auto& values = values_[{field, cell.block}];
  values.resize(static_cast<std::size_t>(file_.mesh.blocks[cell.block].num_cells()),
                std::numeric_limits<double>::quiet_NaN());
  values[static_cast<std::size_t>(cell.number)] = value;
}

MeshFile MeshBuilder::finish() {
  if (file_.mesh.blocks.empty()) throw InputError(file_.numbering.file, "no elements");
  leave_out_middles();
  finish_groups();
  finish_numbering();
  finish_fields();
  return std::move(file_);
}

void MeshBuilder::leave_out_middles() {
  for (const auto& [kind, count] : num_reduced_)
    warn(std::to_string(count) + " second-order " + std::string(resilin::name(kind)) +
         " are used by their corners (straight sides)");
  if (middles_.empty()) return;
  std::vector<bool> is_left_out(file_.mesh.vertices.size(), false);
  for (const Index middle : middles_) is_left_out[static_cast<std::size_t>(middle)] = true;
  for (const CellBlock& block : file_.mesh.blocks)
    for (const Index node : block.nodes) is_left_out[static_cast<std::size_t>(node)] = false;
  NumberIndex numbers;
  std::vector<Vector3> vertices;
  std::vector<Index> renumbered(is_left_out.size(), -1);
  for (std::size_t v = 0; v < is_left_out.size(); ++v) {
    if (is_left_out[v]) continue;
    renumbered[v] = static_cast<Index>(vertices.size());
    numbers.add(vertices_.numbers()[v]);
    vertices.push_back(file_.mesh.vertices[v]);
  }
  const auto renumber = [&](Index& vertex) { vertex = renumbered[static_cast<std::size_t>(vertex)]; };
  for (CellBlock& block : file_.mesh.blocks) std::ranges::for_each(block.nodes, renumber);
  for (Group& group : file_.mesh.groups) {
    std::ranges::for_each(group.vertices, renumber);
    std::erase(group.vertices, -1);
  }
  file_.mesh.vertices = std::move(vertices);
  vertices_ = std::move(numbers);
}

void MeshBuilder::finish_groups() {
  for (Group& group : file_.mesh.groups) {
    for (std::size_t b = 0; b < group.cells.size(); ++b) {
      auto& cells = group.cells[b];
      std::sort(cells.begin(), cells.end());
      cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
      for (const Index cell : cells) {
        const auto nodes = file_.mesh.blocks[b].cell(cell);
        group.vertices.insert(group.vertices.end(), nodes.begin(), nodes.end());
      }
    }
    std::sort(group.vertices.begin(), group.vertices.end());
    group.vertices.erase(std::unique(group.vertices.begin(), group.vertices.end()), group.vertices.end());
  }
}

void MeshBuilder::finish_numbering() {
  Numbering& numbering = file_.numbering;
  numbering.first_vertex = vertices_.first();
  if (!vertices_.is_consecutive()) numbering.vertices = vertices_.numbers();
  numbering.first_cell = cells_[0].first();
  numbering.cells.resize(cells_.size());
  for (std::size_t b = 0; b < cells_.size(); ++b) {
    const bool counts_from_first = cells_[b].is_consecutive() && cells_[b].first() == numbering.first_cell;
    if (!counts_from_first) numbering.cells[b] = cells_[b].numbers();
  }
}

void MeshBuilder::finish_fields() {
  for (auto& [key, values] : values_) {
    const auto& [name, block] = key;
    values.resize(static_cast<std::size_t>(file_.mesh.blocks[block].num_cells()),
                  std::numeric_limits<double>::quiet_NaN());
    if (std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
      file_.mesh.cell_fields.push_back({name, block, std::move(values)});
    } else {
      warn("field \"" + name + "\" has no finite value for some " +
           std::string(resilin::name(file_.mesh.blocks[block].kind)) + "; it is left out");
    }
  }
}

std::string numbered_group_name(int dimension, std::int64_t number) {
  constexpr std::array<const char*, 4> words = {"point_", "curve_", "surface_", "volume_"};
  return words[static_cast<std::size_t>(std::clamp(dimension, 0, 3))] + std::to_string(number);
}

}  // namespace resilin
