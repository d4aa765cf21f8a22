#include "resilin/world/section.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/world/description_check.hpp"
#include "resilin/world/world.hpp"

namespace resilin {
namespace {

std::span<const Index> cell_nodes(const Body& body, std::size_t cell) {
  const auto count = static_cast<std::size_t>(num_nodes(body.cell_kind));
  return std::span(body.cells).subspan(cell * count, count);
}

/// Whether the mean of a cell's corners lies below the plane.
std::vector<bool> cells_below(const SectionDescription& section, const Body& body, int dim,
                              const VectorX& rest_positions) {
  const auto num_corners = static_cast<std::size_t>(body.domains.element().num_corners());
  std::vector<bool> is_below;
  for (std::size_t cell = 0; cell < static_cast<std::size_t>(body.num_cells()); ++cell) {
    double sum = 0;
    for (const Index node : cell_nodes(body, cell).first(num_corners))
      sum += rest_positions[Eigen::Index{node} * dim + section.axis];
    is_below.push_back(sum < section.at * static_cast<double>(num_corners));
  }
  return is_below;
}

/// Volumes of the cells at each node of the world: below the plane, and all.
struct NodeVolumes {
  std::map<Index, double> below, all;
};

NodeVolumes node_volumes(const Body& body, const std::vector<bool>& is_below) {
  const std::vector<double> volumes = body.domains.rest_volumes();
  NodeVolumes sums;
  for (std::size_t cell = 0; cell < volumes.size(); ++cell)
    for (const Index node : cell_nodes(body, cell)) {
      sums.all[node] += volumes[cell];
      if (is_below[cell]) sums.below[node] += volumes[cell];
    }
  return sums;
}

}  // namespace

void Section::add_cells(const Body& body, const std::vector<Index>& cells, bool is_lower,
                        const VectorX& rest_positions) {
  for (std::size_t d = 0; d < body.domains.size(); ++d) {
    const ElasticEnergy& whole = *body.domains[d].energy;
    Cells side{.is_lower = is_lower,
               .domain = d,
               .is_uniform =
                   whole.parameters().front().size == static_cast<Eigen::Index>(whole.law().constants.size()),
               .cells = {},
               .nodes = {},
               .energy = {}};
    std::vector<double> constants;
    FibreDirections fibres;
    for (const Index cell : cells) {
      const auto [domain, own] = body.domains.place_of(cell);
      if (domain != d) continue;
      side.cells.push_back(own);
      const auto of_cell = cell_nodes(body, static_cast<std::size_t>(cell));
      side.nodes.insert(side.nodes.end(), of_cell.begin(), of_cell.end());
      const Material material = whole.material(own);
      constants.insert(constants.end(), material.constants.begin(), material.constants.end());
      fibres.directions.insert(fibres.directions.end(), material.fibres.begin(), material.fibres.end());
      fibres.num_families = material.fibres.size();
    }
    if (side.cells.empty()) continue;
    side.energy = std::make_shared<const ElasticEnergy>(
        dim_, ElementChoice(whole.element().name, whole.quadrature().name), side.nodes, rest_positions,
        whole.law(), constants, fibres, whole.instruction_set(), ElasticTiles::Gradients::held,
        whole.thickness());
    cells_.push_back(std::move(side));
  }
}

Section::Section(const SectionDescription& description, const Body& body, int dim,
                 const VectorX& rest_positions)
    : name_(description.name), dim_(dim) {
  require_axis(description.axis, dim, description.place + ".plane.axis");
  const std::vector<bool> is_below = cells_below(description, body, dim, rest_positions);
  if (std::ranges::find(is_below, true) == is_below.end() ||
      std::ranges::find(is_below, false) == is_below.end()) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Index node : body.cells) {
      low = std::min(low, rest_positions[Eigen::Index{node} * dim + description.axis]);
      high = std::max(high, rest_positions[Eigen::Index{node} * dim + description.axis]);
    }
    const std::string axis(1, "xyz"[description.axis]);
    throw InputError(
        description.place + ".plane", "a plane with cells on both sides",
        axis + " = " + format_number(description.at),
        "the body reaches from " + axis + " = " + format_number(low) + " to " + format_number(high));
  }

  const NodeVolumes volumes = node_volumes(body, is_below);
  const auto share = [&](Index node) {
    const auto below = volumes.below.find(node);
    return below == volumes.below.end() ? 0.0 : below->second / volumes.all.at(node);
  };
  std::vector<bool> is_cut_node(static_cast<std::size_t>(rest_positions.size() / dim), false);
  std::map<Index, std::array<bool, 2>> sides_at;
  for (std::size_t cell = 0; cell < is_below.size(); ++cell)
    for (const Index node : cell_nodes(body, cell)) sides_at[node][is_below[cell] ? 0 : 1] = true;
  for (const auto& [node, sides] : sides_at) {
    if (!sides[0] || !sides[1]) continue;
    is_cut_node[static_cast<std::size_t>(node)] = true;
    nodes_.push_back({node, share(node), volumes.all.at(node)});
  }
  std::vector<Index> lower, upper;
  for (std::size_t cell = 0; cell < is_below.size(); ++cell)
    if (std::ranges::any_of(cell_nodes(body, cell),
                            [&](Index node) { return is_cut_node[static_cast<std::size_t>(node)]; }))
      (is_below[cell] ? lower : upper).push_back(static_cast<Index>(cell));
  add_cells(body, lower, true, rest_positions);
  add_cells(body, upper, false, rest_positions);

  const CellBlock block{.kind = body.cell_kind, .nodes = body.cells};
  visit_facets(block, [&](std::span<const resilin::Facet> uses) {
    if (uses.size() != 2 ||
        is_below[static_cast<std::size_t>(uses[0].cell)] == is_below[static_cast<std::size_t>(uses[1].cell)])
      return;
    const CellSide& side = cell_sides(block.kind)[static_cast<std::size_t>(uses[0].local)];
    facets_.push_back({first_order(side.kind), facet_corners(block, uses[0])});
  });
}

/// The mean of the facets' middles by their deformed areas.
Vector3 Section::center(const VectorX& x) const {
  Vector3 sum = Vector3::Zero();
  double total = 0;
  for (const Facet& facet : facets_) {
    const auto corners = std::span(facet.corners).first(static_cast<std::size_t>(num_corners(facet.kind)));
    const double area = area_vector(dim_, facet.kind, corners, x).norm();
    Vector3 middle = Vector3::Zero();
    for (const Index corner : corners)
      middle += node_position(dim_, corner, x) / static_cast<double>(corners.size());
    sum += area * middle;
    total += area;
  }
  return total > 0 ? Vector3(sum / total) : sum;
}

// With n the unit normal of a facet of area a and t_k = dx/dxi_k: da = dt_0 . (t_1 x n) + dt_1 . (n x t_0),
// in 2D dt . (-n_y, n_x); d(sum a m / sum a) = sum [a dm + da (m - center)] / sum a.
void Section::add_center_slopes(const Vector3& by, const VectorX& x, VectorX& slopes) const {
  const Vector3 middle_of_all = center(x);
  double total = 0;
  VectorX sum = VectorX::Zero(slopes.size());
  for (const Facet& facet : facets_) {
    const auto corners = std::span(facet.corners).first(static_cast<std::size_t>(num_corners(facet.kind)));
    const Vector3 whole = area_vector(dim_, facet.kind, corners, x);
    const double area = whole.norm();
    if (!(area > 0)) continue;
    const Vector3 n = whole / area;
    const auto count = static_cast<double>(corners.size());
    Vector3 middle = Vector3::Zero();
    for (const Index corner : corners) middle += node_position(dim_, corner, x) / count;
    const double lever = by.dot(middle - middle_of_all);
    for (const FacetPoint& point : facet_points(facet.kind)) {
      Vector3 first = Vector3::Zero(), second = Vector3::Zero();
      for (std::size_t a = 0; a < corners.size(); ++a) {
        first += point.slopes[2 * a] * node_position(dim_, corners[a], x);
        second += point.slopes[2 * a + 1] * node_position(dim_, corners[a], x);
      }
      const Vector3 by_first = dim_ == 2 ? Vector3(-n.y(), n.x(), 0) : Vector3(second.cross(n)),
                    by_second = dim_ == 2 ? Vector3(Vector3::Zero()) : Vector3(n.cross(first));
      for (std::size_t a = 0; a < corners.size(); ++a) {
        const Vector3 slope =
            lever * point.weight * (point.slopes[2 * a] * by_first + point.slopes[2 * a + 1] * by_second);
        sum.segment(Eigen::Index{corners[a]} * dim_, dim_) += slope.head(dim_);
      }
    }
    for (const Index corner : corners)
      sum.segment(Eigen::Index{corner} * dim_, dim_) += area / count * by.head(dim_);
    total += area;
  }
  if (total > 0) slopes += sum / total;
}

const Body& Section::body(const World& world) const { return world.body_of(nodes_.front().node); }

std::vector<Vector3> Section::node_forces(const VectorX& x) const {
  const Conditions any;
  VectorX lower = VectorX::Zero(x.size()), upper = VectorX::Zero(x.size());
  for (const Cells& side : cells_) side.energy->add_gradient(x, any, side.is_lower ? lower : upper);
  std::vector<Vector3> forces;
  for (const auto& [node, share, volume] : nodes_)
    forces.push_back((1 - share) * node_position(dim_, node, lower) -
                     share * node_position(dim_, node, upper));
  return forces;
}

SectionForce Section::measure(const VectorX& x) const {
  const std::vector<Vector3> forces = node_forces(x);
  SectionForce result{.name = name_, .center = center(x)};
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    result.force += forces[i];
    result.moment += (node_position(dim_, nodes_[i].node, x) - result.center).cross(forces[i]);
  }
  return result;
}

/// slopes += those of the sum over the cut's nodes of by_node times the volume of the side's cells there.
void Section::add_volume_slopes(const Cells& side, const std::vector<double>& by_node,
                                VectorX& slopes) const {
  std::map<Index, double> by;
  for (std::size_t i = 0; i < nodes_.size(); ++i) by[nodes_[i].node] = by_node[i];
  std::vector<double> by_cell(side.cells.size(), 0.0);
  const std::size_t width = side.nodes.size() / side.cells.size();
  for (std::size_t k = 0; k < side.nodes.size(); ++k)
    if (const auto found = by.find(side.nodes[k]); found != by.end()) by_cell[k / width] += found->second;
  side.energy->add_volume_slopes(by_cell, slopes);
}

void Section::add_slopes(const Vector3& by, const VectorX& x, Slopes& slopes) const {
  add_force_slopes(std::vector<Vector3>(nodes_.size(), by), x, slopes);
}

// by . (r x f) = f . (by x r) = r . (f x by), r from the center to each node.
void Section::add_moment_slopes(const Vector3& by, const VectorX& x, Slopes& slopes) const {
  const Vector3 middle = center(x);
  std::vector<Vector3> by_force;
  for (const Node& node : nodes_) by_force.push_back(by.cross(node_position(dim_, node.node, x) - middle));
  add_force_slopes(by_force, x, slopes);
  if (slopes.positions.size() == 0) return;
  const std::vector<Vector3> forces = node_forces(x);
  Vector3 by_center = Vector3::Zero();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Vector3 by_place = forces[i].cross(by);
    slopes.positions.segment(Eigen::Index{nodes_[i].node} * dim_, dim_) += by_place.head(dim_);
    by_center -= by_place;
  }
  add_center_slopes(by_center, x, slopes.positions);
}

// by . force = w_lower . dE_lower/dx + w_upper . dE_upper/dx with w_lower = (1 - s) by, w_upper = -s by at
// the cut's nodes; s = V_lower / V, whose change takes by . (g + h) ds off.
void Section::add_force_slopes(const std::vector<Vector3>& by, const VectorX& x, Slopes& slopes) const {
  const Conditions any;
  std::vector<double> of_lower_volume, of_volume;
  VectorX forces = VectorX::Zero(x.size());
  for (const Cells& side : cells_) {
    side.energy->add_gradient(x, any, forces);
    VectorX w = VectorX::Zero(x.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      w.segment(Eigen::Index{nodes_[i].node} * dim_, dim_) =
          (side.is_lower ? 1 - nodes_[i].share : -nodes_[i].share) * by[i].head(dim_);
    if (slopes.positions.size() > 0) side.energy->add_tangent_forces(x, w, slopes.positions);
    if (slopes.rest_positions.size() > 0)
      side.energy->add_parameter_slopes("rest_positions", x, w, any, slopes.rest_positions);
    if (side.domain >= slopes.constants.size() || slopes.constants[side.domain].size() == 0) continue;
    VectorX& by_constants = slopes.constants[side.domain];
    VectorX of_cells = VectorX::Zero(side.energy->parameters().front().size);
    side.energy->add_parameter_slopes("constants", x, w, any, of_cells);
    const auto cells = static_cast<Eigen::Index>(side.cells.size()), n = of_cells.size() / cells;
    for (Eigen::Index i = 0; i < cells; ++i) {
      const Eigen::Index set = side.is_uniform ? 0 : side.cells[static_cast<std::size_t>(i)];
      by_constants.segment(set * n, n) += of_cells.segment(i * n, n);
    }
  }
  if (slopes.rest_positions.size() == 0) return;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const auto& [node, share, volume] = nodes_[i];
    const double power = by[i].dot(node_position(dim_, node, forces)) / volume;
    of_lower_volume.push_back(-(1 - share) * power);
    of_volume.push_back(share * power);
  }
  for (const Cells& side : cells_)
    add_volume_slopes(side, side.is_lower ? of_lower_volume : of_volume, slopes.rest_positions);
}

}  // namespace resilin
