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
  const auto num_corners = static_cast<std::size_t>(body.elastic->element().num_corners());
  std::vector<bool> is_below;
  for (std::size_t cell = 0; cell < static_cast<std::size_t>(body.num_cells()); ++cell) {
    double sum = 0;
    for (const Index node : cell_nodes(body, cell).first(num_corners))
      sum += rest_positions[Eigen::Index{node} * dim + section.axis];
    is_below.push_back(sum < section.at * static_cast<double>(num_corners));
  }
  return is_below;
}

/// The elastic energy of some cells of a body.
std::shared_ptr<const ElasticEnergy> energy_of(const Body& body, const std::vector<Index>& cells, int dim,
                                               const VectorX& rest_positions) {
  const ElasticEnergy& whole = *body.elastic;
  std::vector<Index> nodes;
  std::vector<double> constants;
  FibreDirections fibres;
  for (const Index cell : cells) {
    const auto of_cell = cell_nodes(body, static_cast<std::size_t>(cell));
    nodes.insert(nodes.end(), of_cell.begin(), of_cell.end());
    const Material material = whole.material(cell);
    constants.insert(constants.end(), material.constants.begin(), material.constants.end());
    fibres.directions.insert(fibres.directions.end(), material.fibres.begin(), material.fibres.end());
    fibres.num_families = material.fibres.size();
  }
  return std::make_shared<const ElasticEnergy>(
      dim, ElementChoice(whole.element().name, whole.quadrature().name), nodes, rest_positions, whole.law(),
      constants, fibres, whole.instruction_set());
}

/// Volumes of the cells at each node of the world: below the plane, and all.
struct NodeVolumes {
  std::map<Index, double> below, all;
};

NodeVolumes node_volumes(const Body& body, const std::vector<bool>& is_below) {
  const std::vector<double> volumes = body.elastic->rest_volumes();
  NodeVolumes sums;
  for (std::size_t cell = 0; cell < volumes.size(); ++cell)
    for (const Index node : cell_nodes(body, cell)) {
      sums.all[node] += volumes[cell];
      if (is_below[cell]) sums.below[node] += volumes[cell];
    }
  return sums;
}

}  // namespace

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
    nodes_.push_back({node, share(node)});
  }
  std::vector<Index> lower, upper;
  for (std::size_t cell = 0; cell < is_below.size(); ++cell)
    if (std::ranges::any_of(cell_nodes(body, cell),
                            [&](Index node) { return is_cut_node[static_cast<std::size_t>(node)]; }))
      (is_below[cell] ? lower : upper).push_back(static_cast<Index>(cell));
  lower_ = energy_of(body, lower, dim, rest_positions);
  upper_ = energy_of(body, upper, dim, rest_positions);

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

SectionForce Section::measure(const VectorX& x) const {
  const Conditions any;
  VectorX lower = VectorX::Zero(x.size()), upper = VectorX::Zero(x.size());
  lower_->add_gradient(x, any, lower);
  upper_->add_gradient(x, any, upper);
  SectionForce result{.name = name_, .center = center(x)};
  for (const auto& [node, share] : nodes_) {
    const Vector3 force =
        (1 - share) * node_position(dim_, node, lower) - share * node_position(dim_, node, upper);
    result.force += force;
    result.moment += (node_position(dim_, node, x) - result.center).cross(force);
  }
  return result;
}

}  // namespace resilin
