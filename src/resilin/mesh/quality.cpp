#include "resilin/mesh/quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "resilin/core/parallel.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/element/jacobian_bound.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

const Vector3& corner(const Mesh& mesh, std::span<const Index> nodes, std::size_t i) {
  return mesh.vertices[static_cast<std::size_t>(nodes[i])];
}

bool is_spatial(const CellBlock& block) { return dimension(block.kind) == 3; }

bool is_box_like(CellKind kind) { return kind == CellKind::quadrilateral || kind == CellKind::hexahedron; }

std::vector<double> positions_of(const Mesh& mesh, std::span<const Index> nodes, int dim) {
  std::vector<double> positions;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (int k = 0; k < dim; ++k) positions.push_back(corner(mesh, nodes, i)[k]);
  return positions;
}

double box_like_volume(const Mesh& mesh, const CellBlock& block, Index cell) {
  const ElementInfo& element = *element_of_cells(block.kind);
  const std::vector<double> positions = positions_of(mesh, block.cell(cell), element.dim);
  double volume = 0;
  for (const QuadraturePoint& point : rule_of_degree(element.shape, 2).points)
    volume += point.weight * jacobian(element, point.xi, positions);
  return volume;
}

double signed_volume(const Mesh& mesh, const CellBlock& block, Index cell) {
  if (is_box_like(block.kind)) return box_like_volume(mesh, block, cell);
  const auto nodes = block.cell(cell);
  const Vector3& origin = corner(mesh, nodes, 0);
  const Vector3 a = corner(mesh, nodes, 1) - origin;
  const Vector3 b = corner(mesh, nodes, 2) - origin;
  if (!is_spatial(block)) return 0.5 * (a.x() * b.y() - a.y() * b.x());
  const Vector3 c = corner(mesh, nodes, 3) - origin;
  return a.dot(b.cross(c)) / 6;
}

/// Least Jacobian at a corner over the product of the lengths of its edges.
double least_scaled_jacobian(const Mesh& mesh, const CellBlock& block, Index cell) {
  const ElementInfo& element = *element_of_cells(block.kind);
  const auto nodes = block.cell(cell);
  const std::vector<double> positions = positions_of(mesh, nodes, element.dim);
  std::vector<double> lengths(nodes.size(), 1.0);
  for (const auto& [i, j] : cell_edges(block.kind)) {
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
    const double length = (corner(mesh, nodes, a) - corner(mesh, nodes, b)).norm();
    lengths[a] *= length;
    lengths[b] *= length;
  }
  double least = 1;
  for (std::size_t a = 0; a < nodes.size(); ++a)
    least = std::min(least, lengths[a] > 0 ? jacobian(element, element.nodes[a], positions) / lengths[a] : 0);
  return least;
}

bool has_equal_nodes(std::span<const Index> nodes) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (std::size_t j = i + 1; j < nodes.size(); ++j) {
      if (nodes[i] == nodes[j]) return true;
    }
  }
  return false;
}

template <class Function>
auto per_cell(const CellBlock& block, const Function& function) {
  std::vector<decltype(function(Index{}))> values(static_cast<std::size_t>(block.num_cells()));
  for (Index cell = 0; cell < block.num_cells(); ++cell)
    values[static_cast<std::size_t>(cell)] = function(cell);
  return values;
}

/// Sum of squared edge lengths and their number.
std::pair<double, int> squared_edges(const Mesh& mesh, std::span<const Index> nodes, std::size_t corners) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < corners; ++i) {
    for (std::size_t j = i + 1; j < corners; ++j, ++count) {
      sum += (corner(mesh, nodes, i) - corner(mesh, nodes, j)).squaredNorm();
    }
  }
  return {sum, count};
}

}  // namespace

std::vector<double> signed_volumes(const Mesh& mesh, const CellBlock& block) {
  return per_cell(block, [&](Index cell) { return signed_volume(mesh, block, cell); });
}

std::vector<Vector3> triangle_area_vectors(const Mesh& mesh, const CellBlock& block) {
  return per_cell(block, [&](Index cell) {
    const auto nodes = block.cell(cell);
    const Vector3 a = corner(mesh, nodes, 1) - corner(mesh, nodes, 0);
    const Vector3 b = corner(mesh, nodes, 2) - corner(mesh, nodes, 0);
    return Vector3(0.5 * a.cross(b));
  });
}

std::vector<double> triangle_areas(const Mesh& mesh, const CellBlock& block) {
  std::vector<double> areas;
  for (const Vector3& vector : triangle_area_vectors(mesh, block)) areas.push_back(vector.norm());
  return areas;
}

double volume_round_off(const Mesh& mesh, const CellBlock& block, Index cell) {
  const auto nodes = block.cell(cell);
  const auto corners = static_cast<std::size_t>(num_corners(block.kind));
  double length = 0;
  double coordinate = 0;
  for (std::size_t i = 0; i < corners; ++i) {
    coordinate = std::max(coordinate, corner(mesh, nodes, i).cwiseAbs().maxCoeff());
    for (std::size_t j = i + 1; j < corners; ++j) {
      length = std::max(length, (corner(mesh, nodes, i) - corner(mesh, nodes, j)).norm());
    }
  }
  const double side = is_spatial(block) ? length * length : length;
  return 16 * std::numeric_limits<double>::epsilon() * side * std::max(length, coordinate);
}

namespace {

CellSigns signs_of_some(const Mesh& mesh, const CellBlock& block, Index first, Index last) {
  CellSigns signs;
  const bool has_constant_jacobian = !is_box_like(block.kind) && !is_second_order(block.kind);
  std::vector<Index> nodes;
  for (Index cell = first; cell < last; ++cell) {
    const double volume = signed_volume(mesh, block, cell);
    const double round_off = volume_round_off(mesh, block, cell);
    if (!std::isfinite(volume) || !std::isfinite(round_off)) {
      signs.not_finite.push_back(cell);
      continue;
    }
    if (std::abs(volume) <= round_off || has_equal_nodes(block.cell(cell))) {
      signs.flat.push_back(cell);
      continue;
    }
    if (volume < 0) signs.inverted.push_back(cell);
    if (has_constant_jacobian) continue;
    nodes.assign(block.cell(cell).begin(), block.cell(cell).end());
    if (volume < 0) turn_around(block.kind, nodes);
    const ElementInfo& element = *element_of_cells(block.kind);
    const JacobianSign sign = jacobian_sign(element, positions_of(mesh, nodes, element.dim));
    if (sign.kind != JacobianSign::Kind::positive) signs.folded.push_back({cell, sign.value, sign.xi});
  }
  return signs;
}

}  // namespace

CellSigns cell_signs(const Mesh& mesh, const CellBlock& block) {
  constexpr std::size_t cells_per_chunk = 2048;
  CellSigns all;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  parallel_in_order(
      static_cast<std::size_t>(block.num_cells()), cells_per_chunk,
      [&](std::size_t first, std::size_t last) {
        return signs_of_some(mesh, block, static_cast<Index>(first), static_cast<Index>(last));
      },
      [&](std::size_t, const CellSigns& signs) {
        append(all.inverted, signs.inverted);
        append(all.flat, signs.flat);
        append(all.not_finite, signs.not_finite);
        append(all.folded, signs.folded);
      });
  return all;
}

std::vector<std::pair<Index, Index>> duplicate_cells(const CellBlock& block) {
  const auto width = static_cast<std::size_t>(num_nodes(block.kind));
  std::vector<Index> sorted_nodes = block.nodes;
  const auto nodes_of = [&](Index cell) {
    return std::span(sorted_nodes).subspan(static_cast<std::size_t>(cell) * width, width);
  };
  for (Index cell = 0; cell < block.num_cells(); ++cell)
    std::sort(nodes_of(cell).begin(), nodes_of(cell).end());
  std::vector<Index> order(static_cast<std::size_t>(block.num_cells()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return std::lexicographical_compare(nodes_of(a).begin(), nodes_of(a).end(), nodes_of(b).begin(),
                                        nodes_of(b).end());
  });
  std::vector<std::pair<Index, Index>> pairs;
  for (std::size_t first = 0, i = 1; i < order.size(); ++i) {
    if (std::equal(nodes_of(order[first]).begin(), nodes_of(order[first]).end(),
                   nodes_of(order[i]).begin())) {
      pairs.emplace_back(order[first], order[i]);
    } else {
      first = i;
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<std::pair<Index, Index>> duplicate_vertices(const Mesh& mesh) {
  const auto at = [&](Index i) -> const Vector3& { return mesh.vertices[static_cast<std::size_t>(i)]; };
  std::vector<Index> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return std::lexicographical_compare(at(a).begin(), at(a).end(), at(b).begin(), at(b).end());
  });
  std::vector<std::pair<Index, Index>> pairs;
  for (std::size_t first = 0, i = 1; i < order.size(); ++i) {
    if (at(order[first]) == at(order[i])) {
      pairs.emplace_back(order[first], order[i]);
    } else {
      first = i;
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<std::array<Index, 2>> nonmanifold_edges(const CellBlock& triangles) {
  std::vector<std::array<Index, 2>> result;
  visit_facets(triangles, [&](std::span<const Facet> uses) {
    if (uses.size() < 3) return;
    const auto nodes = facet_corners(triangles, uses[0]);
    result.push_back({std::min(nodes[0], nodes[1]), std::max(nodes[0], nodes[1])});
  });
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<std::array<Index, 2>> open_edges(const Mesh& mesh, const CellBlock& triangles) {
  std::vector<Index> first(mesh.vertices.size());
  std::iota(first.begin(), first.end(), 0);
  for (const auto& [one, other] : duplicate_vertices(mesh)) first[static_cast<std::size_t>(other)] = one;
  CellBlock joined = triangles;
  for (Index& node : joined.nodes) node = first[static_cast<std::size_t>(node)];
  std::vector<std::array<Index, 2>> result;
  visit_facets(joined, [&](std::span<const Facet> uses) {
    const auto nodes = facet_corners(joined, uses[0]);
    if (uses.size() == 1 && nodes[0] != nodes[1])
      result.push_back({std::min(nodes[0], nodes[1]), std::max(nodes[0], nodes[1])});
  });
  std::sort(result.begin(), result.end());
  return result;
}

namespace {

/// Whether the corners of a side, seen from outside its cell, go round in one sense or in the other.
bool sense_from_outside(const CellBlock& block, const Facet& facet, bool is_inverted) {
  const std::array<Index, 4> corners = facet_corners(block, facet);
  const auto count = static_cast<std::size_t>(std::ranges::find(corners, -1) - corners.begin());
  std::size_t least = 0;
  for (std::size_t i = 1; i < count; ++i)
    if (corners[i] < corners[least]) least = i;
  const bool is_rising =
      count == 2 ? least == 0 : corners[(least + 1) % count] < corners[(least + count - 1) % count];
  return is_rising != is_inverted;
}

}  // namespace

// Cells with a side between them see its corners go round in opposite senses.
std::vector<std::array<Index, 2>> cells_on_one_side(const Mesh& mesh, const CellBlock& block) {
  const std::vector<double> volumes = signed_volumes(mesh, block);
  const auto sense = [&](const Facet& facet) {
    return sense_from_outside(block, facet, volumes[static_cast<std::size_t>(facet.cell)] < 0);
  };
  std::vector<std::array<Index, 2>> result;
  visit_facets(block, [&](std::span<const Facet> uses) {
    if (uses.size() == 2 && sense(uses[0]) == sense(uses[1]))
      result.push_back({std::min(uses[0].cell, uses[1].cell), std::max(uses[0].cell, uses[1].cell)});
  });
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<double> smallest_dihedral_angles(const Mesh& mesh, const CellBlock& tetrahedra) {
  return per_cell(tetrahedra, [&](Index cell) {
    const auto nodes = tetrahedra.cell(cell);
    const auto at = [&](int i) -> const Vector3& {
      return mesh.vertices[static_cast<std::size_t>(nodes[static_cast<std::size_t>(i)])];
    };
    std::array<Vector3, 4> normals;  // normals of the sides, outward
    for (std::size_t s = 0; s < 4; ++s) {
      const auto corners = cell_sides(CellKind::tetrahedron)[s].corners();
      normals[s] = (at(corners[1]) - at(corners[0])).cross(at(corners[2]) - at(corners[0]));
    }
    double smallest = std::numbers::pi;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        smallest =
            std::min(smallest, std::atan2(normals[i].cross(normals[j]).norm(), -normals[i].dot(normals[j])));
    return smallest * 180 / std::numbers::pi;
  });
}

std::vector<double> shape_qualities(const Mesh& mesh, const CellBlock& block) {
  return per_cell(block, [&](Index cell) {
    if (is_box_like(block.kind)) return least_scaled_jacobian(mesh, block, cell);
    const auto [sum, count] = squared_edges(mesh, block.cell(cell), is_spatial(block) ? 4 : 3);
    const double mean_square = sum / count;
    if (mean_square == 0) return 0.0;
    const double volume = signed_volume(mesh, block, cell);
    return is_spatial(block) ? 6 * std::numbers::sqrt2 * volume / std::pow(mean_square, 1.5)
                             : 4 / std::numbers::sqrt3 * volume / mean_square;
  });
}

}  // namespace resilin
