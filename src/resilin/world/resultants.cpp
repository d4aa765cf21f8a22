#include "resilin/world/resultants.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>

#include "resilin/core/text.hpp"
#include "resilin/energy/dead_load.hpp"
#include "resilin/energy/handle_spring.hpp"
#include "resilin/energy/pressure.hpp"
#include "resilin/energy/ring_loads.hpp"
#include "resilin/energy/spread_force.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/facet_faces.hpp"
#include "resilin/world/selection.hpp"

namespace resilin {
namespace {

/// Selection of a load: facets, or else nodes.
struct Site {
  const CellBlock* facets = nullptr;
  std::vector<Index> nodes;  ///< rising
};

std::vector<Index> sorted(std::vector<Index> nodes) {
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

std::vector<Index> nodes_of(const CellBlock& facets) {
  const std::vector<Index>& all = facets.nodes;
  return sorted(all);
}

Site site_of(const Energy& term) {
  if (const auto* pressure = dynamic_cast<const Pressure*>(&term))
    return {&pressure->facets(), nodes_of(pressure->facets())};
  if (const auto* pressure = dynamic_cast<const RingPressure*>(&term))
    return {&pressure->facets(), nodes_of(pressure->facets())};
  if (const auto* spring = dynamic_cast<const HandleSpring*>(&term))
    return {nullptr, sorted(spring->nodes())};
  const auto* dead = dynamic_cast<const DeadLoad*>(&term);
  if (dead == nullptr) return {};
  if (const auto* on = dynamic_cast<const LoadedFacets*>(dead->region()))
    return {&on->facets(), nodes_of(on->facets())};
  if (const auto* on = dynamic_cast<const RingTraction*>(dead->region()))
    return {&on->facets(), nodes_of(on->facets())};
  if (const auto* on = dynamic_cast<const SpreadForce*>(dead->region()))
    return {&on->facets(), nodes_of(on->facets())};
  if (const auto* on = dynamic_cast<const LoadedNodes*>(dead->region()))
    return {nullptr, sorted(on->nodes())};
  if (const auto* on = dynamic_cast<const LoadedCells*>(dead->region())) {
    const std::vector<Index>& nodes = on->cells();
    return {nullptr, sorted(nodes)};
  }
  return {};
}

/// Nodal forces at factor 1 on the rest shape; empty where there are none to tell.
VectorX full_forces(const World& world, const Energy& term) {
  VectorX forces = VectorX::Zero(world.rest_positions.size());
  if (const auto* pressure = dynamic_cast<const Pressure*>(&term)) {
    const CellBlock& facets = pressure->facets();
    for (Index facet = 0; facet < facets.num_cells(); ++facet) {
      const std::span<const Index> nodes = facets.cell(facet);
      for (const FacetPoint& point : facet_points(facets.kind)) {
        const Vector3 area = area_vector(world.dimension, point, nodes, world.rest_positions);
        for (std::size_t a = 0; a < nodes.size(); ++a)
          forces.segment(Eigen::Index{nodes[a]} * world.dimension, world.dimension) -=
              pressure->full_pressure() * point.weight * point.values[a] * area.head(world.dimension);
      }
    }
    return forces;
  }
  if (const auto* pressure = dynamic_cast<const RingPressure*>(&term)) {
    pressure->add_full_forces(world.rest_positions, forces);
    return forces;
  }
  const auto* dead = dynamic_cast<const DeadLoad*>(&term);
  if (dead == nullptr) return {};
  if (dead->region() != nullptr) {
    dead->region()->add_forces(dead->full_value(), world.rest_positions, forces);
  } else {
    dead->add_gradient(world.rest_positions, {.time = 0, .load = 1}, forces);
    forces = -forces;
  }
  return forces;
}

/// Without the noise of sums that cancel.
double cleaned(double value, double scale) { return std::abs(value) < 1e-9 * scale ? 0 : value; }

Vector3 cleaned(const Vector3& vector, double scale) {
  return {cleaned(vector.x(), scale), cleaned(vector.y(), scale), cleaned(vector.z(), scale)};
}

void measure(const World& world, const Site& site, Resultant& result) {
  const int dim = world.dimension;
  const VectorX& X = world.rest_positions;
  result.num_nodes = static_cast<Index>(site.nodes.size());
  const Depth depth = depth_of(world);
  result.has_depth = depth.is_turned || depth.thickness != 1;
  if (site.facets != nullptr && site.facets->num_cells() > 0) {
    const CellBlock& facets = *site.facets;
    result.num_facets = facets.num_cells();
    for (Index facet = 0; facet < facets.num_cells(); ++facet) {
      const std::span<const Index> nodes = facets.cell(facet);
      for (const FacetPoint& point : facet_points(facets.kind, depth)) {
        Vector3 place = Vector3::Zero();
        for (std::size_t a = 0; a < nodes.size(); ++a)
          place += point.values[a] * node_position(dim, nodes[a], X);
        const double area = depth.at(place.x()) * point.weight * area_vector(dim, point, nodes, X).norm();
        result.area += area;
        result.center += area * place;
      }
    }
    result.center /= result.area;
  } else {
    for (const Index node : site.nodes)
      result.center += node_position(dim, node, X) / static_cast<double>(site.nodes.size());
  }
  result.center = cleaned(result.center, world.largest_extent());
}

void add_forces(const World& world, const VectorX& forces, Resultant& result) {
  result.force = Vector3::Zero();
  for (Index node = 0; node < world.num_nodes(); ++node) {
    const Vector3 on_node = node_position(world.dimension, node, forces);
    *result.force += on_node;
    result.moment +=
        (node_position(world.dimension, node, world.rest_positions) - result.center).cross(on_node);
  }
}

}  // namespace

std::vector<Resultant> load_resultants(const World& world) {
  std::vector<Resultant> results;
  for (std::size_t t = 0; t < world.origins.size(); ++t) {
    const TermOrigin& origin = world.origins[t];
    const bool is_load = origin.kind == TermOrigin::Kind::load;
    if (!is_load && origin.kind != TermOrigin::Kind::gravity) continue;
    const Energy& term = *world.terms[t];
    Resultant& result = results.emplace_back();
    result.name = term.name();
    result.kind = !is_load          ? "gravity"
                  : world.made_from ? world.made_from->loads[origin.number].kind
                                    : "load";
    Site site = site_of(term);
    if (!is_load) {
      site.nodes.resize(static_cast<std::size_t>(world.num_nodes()));
      for (Index node = 0; node < world.num_nodes(); ++node)
        site.nodes[static_cast<std::size_t>(node)] = node;
    }
    measure(world, site, result);
    const VectorX forces = full_forces(world, term);
    if (forces.size() > 0) {
      if (!is_load) {  // about the centre of mass, where it has no moment
        result.center.setZero();
        double weight = 0;
        for (Index node = 0; node < world.num_nodes(); ++node) {
          const double share = node_position(world.dimension, node, forces).norm();
          weight += share;
          result.center += share * node_position(world.dimension, node, world.rest_positions);
        }
        if (weight > 0) result.center /= weight;
      }
      add_forces(world, forces, result);
      const double size = forces.norm();
      result.force = cleaned(result.force.value_or(Vector3::Zero()), size);
      result.moment = is_axisymmetric(world) ? Vector3(Vector3::Zero())
                                             : cleaned(result.moment, size * world.largest_extent());
    }
    result.center += world.origin;
  }
  return results;
}

std::vector<Resultant> fixed_selections(const World& world) {
  std::vector<Resultant> results;
  for (const Support& support : world.supports) {
    Resultant& result = results.emplace_back();
    result.name = support.name;
    result.kind = "fix";
    Site site;
    site.nodes = support.nodes;
    CellBlock facets;
    if (!support.nodes.empty()) {
      const Body& body = world.body_of(support.nodes.front());
      std::vector<Index> local = support.nodes;
      for (Index& node : local) node -= body.first_node;
      facets = facets_between(local, body);
      if (facets.num_cells() > 0) site.facets = &facets;
    }
    measure(world, site, result);
    result.center += world.origin;
  }
  return results;
}

std::string describe(const Resultant& on, int dim) {
  std::string text = on.kind == "fix" ? "" : on.kind + " ";
  const std::string nodes = std::to_string(on.num_nodes) + (on.num_nodes == 1 ? " node" : " nodes");
  if (on.num_facets > 0) {
    text += "on " + std::to_string(on.num_facets) + (on.num_facets == 1 ? " facet (" : " facets (") + nodes +
            ", " + format_short(on.area) + (dim == 2 && !on.has_depth ? " m" : " m^2") + ")";
  } else {
    text += "on " + nodes;
  }
  text += " about " + format_point(on.center, dim) + " m";
  if (!on.force) return text;
  text += ": force " + format_point(*on.force, dim) + " N";
  const double moment = dim == 2 ? std::abs(on.moment.z()) : on.moment.norm();
  if (moment > 0)
    text += ", moment " + (dim == 2 ? format_short(on.moment.z()) : format_point(on.moment)) + " N m";
  return text;
}

std::vector<std::string> opposite_side_warnings(const World& world) {
  std::vector<std::string> lines;
  for (std::size_t t = 0; t < world.origins.size(); ++t) {
    const Energy& term = *world.terms[t];
    const Site site = site_of(term);
    const bool may_oppose = dynamic_cast<const Pressure*>(&term) != nullptr;
    if (may_oppose || site.facets == nullptr || site.facets->num_cells() == 0) continue;
    const OppositeSides found =
        opposite_sides(FacetFaces(world.dimension, *site.facets, world.rest_positions));
    if (found.area == 0) continue;
    lines.push_back(world.place + ": load " + one_line(term.name()) + ": where selects opposite sides, " +
                    format_short(found.area) + (world.dimension == 2 ? " m" : " m^2") +
                    " each way; `normal` beside it selects one of them (docs/boundary_conditions.md)");
  }
  return lines;
}

}  // namespace resilin
