#include "resilin/results/revolved.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/fields/catalog.hpp"
#include "resilin/results/collider_file.hpp"
#include "resilin/results/frame_file.hpp"
#include "resilin/results/frame_history.hpp"
#include "resilin/results/saved_run.hpp"
#include "resilin/world/axisymmetry.hpp"

namespace resilin {
namespace {

/// How the numbers of an array turn.
enum class Turn { copied, vector, tensor };

Turn turn_of(const VtuValues& array) {
  if (array.components == 1) return Turn::copied;
  const auto found = std::ranges::find(fields(), array.name, &FieldInfo::name);
  if (found == fields().end()) return Turn::copied;
  if (found->kind == FieldInfo::Kind::vector) return Turn::vector;
  return found->kind == FieldInfo::Kind::tensor ? Turn::tensor : Turn::copied;
}

/// Turns the plane of the section about the y axis: x goes to (cos t, 0, -sin t).
Matrix<3> rotation(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Matrix<3> turned;
  turned << c, 0, s, 0, 1, 0, -s, 0, c;
  return turned;
}

void append_turned(const double* value, int components, Turn turn, const Matrix<3>& R,
                   std::vector<double>& out) {
  if (turn == Turn::copied) {
    out.insert(out.end(), value, value + components);
  } else if (turn == Turn::vector) {
    const Vector3 turned = R * Vector3(value[0], value[1], value[2]);
    out.insert(out.end(), turned.data(), turned.data() + 3);
  } else {
    using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const Rows turned = R * Eigen::Map<const Rows>(value) * R.transpose();
    out.insert(out.end(), turned.data(), turned.data() + 9);
  }
}

/// Linear cells of the section that a cell is revolved as: corners of each.
std::vector<std::vector<Index>> linear_cells(CellKind kind, std::span<const Index> nodes) {
  using enum CellKind;
  if (kind == triangle6) {  // nodes 3, 4, 5 on the edges 0-1, 1-2, 2-0
    const auto corners = [&nodes](std::size_t a, std::size_t b, std::size_t c) {
      return std::vector<Index>{nodes[a], nodes[b], nodes[c]};
    };
    return {corners(0, 3, 5), corners(3, 1, 4), corners(5, 4, 2), corners(3, 4, 5)};
  }
  if (kind == triangle || kind == quadrilateral || kind == line) return {{nodes.begin(), nodes.end()}};
  return {};  // points
}

CellKind revolved_kind(std::size_t corners) {
  return corners == 2 ? CellKind::quadrilateral : corners == 3 ? CellKind::prism : CellKind::hexahedron;
}

/// A cell between two layers of points. The section turns away from the side from which its cells are seen
/// counter-clockwise. The first face of VTK's hexahedron looks towards the other, that of its wedge away from
/// it.
std::vector<Index> between_layers(const std::vector<Index>& corners, Index first, Index second) {
  if (corners.size() != 3) std::swap(first, second);
  std::vector<Index> nodes;
  for (const Index corner : corners) nodes.push_back(first + corner);
  for (const Index corner : corners) nodes.push_back(second + corner);
  if (corners.size() == 2) std::swap(nodes[2], nodes[3]);  // around the quadrilateral
  return nodes;
}

/// A linear cell of the section, and the number of the cell in the frame whose values it takes.
struct SectionCell {
  std::vector<Index> corners;
  std::size_t number;
};

std::vector<SectionCell> section_cells(const Mesh& mesh) {
  std::vector<SectionCell> cells;
  std::size_t number = 0;
  for (const CellBlock& block : mesh.blocks)
    for (Index i = 0; i < block.num_cells(); ++i, ++number)
      for (std::vector<Index>& corners : linear_cells(block.kind, block.cell(i)))
        cells.push_back({std::move(corners), number});
  // Kind by kind, as the blocks of the revolved mesh hold them.
  std::ranges::stable_sort(cells, {}, [](const SectionCell& cell) { return cell.corners.size(); });
  return cells;
}

/// Lines of colliders, which reach beyond the axis, without their part there. They have values by cell alone.
VtuContent cut_at_axis(const VtuContent& content) {
  VtuContent cut;
  cut.time = content.time;
  std::vector<Vector3>& vertices = cut.file.mesh.vertices;
  vertices = content.file.mesh.vertices;
  std::vector<std::size_t> kept;
  std::size_t number = 0;
  for (const CellBlock& block : content.file.mesh.blocks)
    for (Index i = 0; i < block.num_cells(); ++i, ++number) {
      if (block.kind != CellKind::line) continue;
      std::array<Index, 2> ends = {block.cell(i)[0], block.cell(i)[1]};
      const Vector3 a = vertices[static_cast<std::size_t>(ends[0])],
                    b = vertices[static_cast<std::size_t>(ends[1])];
      if (std::max(a.x(), b.x()) <= 0) continue;
      if (std::min(a.x(), b.x()) < 0) {
        ends[a.x() < 0 ? 0 : 1] = static_cast<Index>(vertices.size());
        Vector3 on_axis = a + a.x() / (a.x() - b.x()) * (b - a);
        on_axis.x() = 0;
        vertices.push_back(on_axis);
      }
      std::vector<Index>& nodes = cut.file.mesh.block(CellKind::line).nodes;
      nodes.insert(nodes.end(), ends.begin(), ends.end());
      kept.push_back(number);
    }
  for (const VtuValues& array : content.cell_data) {
    VtuValues& made = cut.cell_data.emplace_back(array.name, array.components, std::vector<double>());
    const auto width = static_cast<std::ptrdiff_t>(array.components);
    for (const std::size_t cell : kept) {
      const auto first = array.values.begin() + static_cast<std::ptrdiff_t>(cell) * width;
      made.values.insert(made.values.end(), first, first + width);
    }
  }
  return cut;
}

/// Takes away the numbered files of a run that was longer.
void remove_files_from(const std::filesystem::path& folder, const std::string& prefix, std::size_t end) {
  std::error_code error;
  while (std::filesystem::remove(folder / (prefix + numbered_vtu(end)), error)) ++end;
}

void write_list(const std::filesystem::path& file, const std::vector<double>& times,
                const std::vector<std::string>& names) {
  std::vector<PvdEntry> entries;
  const bool grows = std::ranges::adjacent_find(times, std::greater_equal<>()) == times.end();
  for (std::size_t i = 0; i < names.size(); ++i)
    entries.push_back({grows ? times[i] : static_cast<double>(i), names[i]});
  write_pvd(file, entries);
}

}  // namespace

VtuContent revolved(const VtuContent& section, const Revolution& revolution) {
  if (!(revolution.angle > 0 && revolution.angle <= 360) || revolution.sectors < 3)
    throw std::invalid_argument("revolved: an angle in (0, 360] and at least 3 sectors");
  const bool is_closed = revolution.angle == 360;
  const int num_layers = revolution.sectors + (is_closed ? 0 : 1);
  const double sector = revolution.angle / revolution.sectors * std::numbers::pi / 180;
  std::vector<Matrix<3>> at_layers, in_sectors;  // the latter in the middle of each
  for (int k = 0; k < num_layers; ++k) at_layers.push_back(rotation(k * sector));
  for (int k = 0; k < revolution.sectors; ++k) in_sectors.push_back(rotation((k + 0.5) * sector));

  VtuContent content;
  const Mesh& flat = section.file.mesh;
  Mesh& mesh = content.file.mesh;
  for (const Matrix<3>& R : at_layers)
    for (const Vector3& place : flat.vertices) mesh.vertices.push_back(R * place);
  const auto num_points = static_cast<Index>(flat.vertices.size());
  const std::vector<SectionCell> cells = section_cells(flat);
  for (const SectionCell& cell : cells) {
    std::vector<Index>& nodes = mesh.block(revolved_kind(cell.corners.size())).nodes;
    for (int k = 0; k < revolution.sectors; ++k)
      for (const Index node : between_layers(cell.corners, k * num_points, (k + 1) % num_layers * num_points))
        nodes.push_back(node);
  }
  for (const VtuValues& array : section.point_data) {
    VtuValues& made = content.point_data.emplace_back(array.name, array.components, std::vector<double>());
    const auto width = static_cast<std::size_t>(array.components);
    for (const Matrix<3>& R : at_layers)
      for (std::size_t i = 0; i + width <= array.values.size(); i += width)
        append_turned(&array.values[i], array.components, turn_of(array), R, made.values);
  }
  for (const VtuValues& array : section.cell_data) {
    if (array.name == history_name) continue;
    VtuValues& made = content.cell_data.emplace_back(array.name, array.components, std::vector<double>());
    const auto width = static_cast<std::size_t>(array.components);
    for (const SectionCell& cell : cells)
      for (const Matrix<3>& R : in_sectors)
        append_turned(&array.values[cell.number * width], array.components, turn_of(array), R, made.values);
  }
  content.time = section.time;
  return content;
}

std::size_t write_revolved(const std::filesystem::path& folder, const Revolution& revolution) {
  const std::vector<std::filesystem::path> files = frame_files(folder);
  const std::shared_ptr<const World> world = saved_world(folder);
  const std::string place = one_line(folder.string());
  if (!world)
    throw InputError(place, "scene.bin in the folder of a run", "none", "name the folder given by --out");
  if (files.empty())
    throw InputError(place, "frames of the run in one file each", "none",
                     "run the scene with \"vtu\" among output.formats, in one process");
  if (!is_axisymmetric(*world))
    throw InputError(place, "an axisymmetric run", world->dimension == 2 ? "a plane one" : "one in 3D",
                     "only a half section can be revolved; dimension = \"axisymmetric\" makes one");
  std::filesystem::create_directories(folder / "revolved");
  std::vector<double> times, collider_times;
  std::vector<std::string> names, collider_names;
  for (const std::filesystem::path& file : files) {
    const std::string name = file.filename().string();
    const VtuContent content = revolved(read_vtu(file), revolution);
    write_frame(folder / "revolved" / name, content);
    times.push_back(content.time.value_or(static_cast<double>(times.size())));
    names.push_back("revolved/" + name);
    if (!has_colliders(*world)) continue;
    const std::filesystem::path colliders = saved_collider_file(file);
    if (colliders.empty()) continue;
    const std::string shown = "revolved/collider_" + colliders.filename().string();
    const bool is_new = collider_names.empty() || collider_names.back() != shown;
    if (is_new) write_frame(folder / shown, revolved(cut_at_axis(read_vtu(colliders)), revolution));
    collider_times.push_back(times.back());
    collider_names.push_back(shown);
  }
  write_list(folder / "revolved.pvd", times, names);
  remove_files_from(folder / "revolved", "", files.size());
  const std::filesystem::path list_of_colliders = folder / "revolved_colliders.pvd";
  if (collider_names.empty()) {
    std::filesystem::remove(list_of_colliders);
  } else {
    write_list(list_of_colliders, collider_times, collider_names);
    remove_files_from(folder / "revolved", "collider_", files.size());
  }
  return files.size();
}

}  // namespace resilin
