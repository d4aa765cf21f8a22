#include "resilin/world/load_catalog.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/energy/handle_spring.hpp"
#include "resilin/energy/pressure.hpp"
#include "resilin/world/selection.hpp"

namespace resilin {
namespace {

VectorX no_forces(const LoadSite& site) { return VectorX::Zero(site.world.rest_positions.size()); }

std::shared_ptr<Energy> dead_load(VectorX forces, const LoadSite& site) {
  return std::make_shared<DeadLoad>(site.name, std::move(forces), site.world.rest_positions, site.active);
}

std::shared_ptr<Energy> make_body_force(const LoadDescription& load, const LoadSite& site) {
  const std::vector<Index> cells = select_cells(site.vertices, site.body);
  if (cells.empty()) {
    throw InputError(site.where, "a part of the volume (cells with all their vertices selected)",
                     std::to_string(site.vertices.size()) + " vertices that fill no cell");
  }
  VectorX forces = no_forces(site);
  add_body_force(site.body.elastic->element(), cells, site.world.rest_positions, load.value, forces);
  return dead_load(std::move(forces), site);
}

std::shared_ptr<Energy> make_traction(const LoadDescription& load, const LoadSite& site) {
  VectorX forces = no_forces(site);
  add_traction(site.world.dimension, select_facets(site.vertices, site.body, site.where),
               site.world.rest_positions, load.value, forces);
  return dead_load(std::move(forces), site);
}

std::shared_ptr<Energy> make_pressure(const LoadDescription& load, const LoadSite& site) {
  return std::make_shared<Pressure>(site.name, site.world.dimension,
                                    select_facets(site.vertices, site.body, site.where), load.pressure,
                                    site.world.rest_positions, site.active);
}

std::shared_ptr<Energy> make_nodal_force(const LoadDescription& load, const LoadSite& site) {
  const int dim = site.world.dimension;
  VectorX forces = no_forces(site);
  for (const Index node : site.nodes) forces.segment(Eigen::Index{node} * dim, dim) = load.value.head(dim);
  return dead_load(std::move(forces), site);
}

std::shared_ptr<Energy> make_spring(const LoadDescription& load, const LoadSite& site) {
  const HandleSpring::Motion motion{
      .displacement = load.displacement, .velocity = load.velocity, .start = load.from};
  return std::make_shared<HandleSpring>(site.name, site.world.dimension, site.nodes, load.stiffness, motion,
                                        site.world.rest_positions, site.active);
}

}  // namespace

const std::vector<LoadKind>& load_kinds() {
  static const std::vector<LoadKind> kinds = {
      {"body_force", "per rest volume", {"value"}, {"where"}, false, make_body_force},
      {"traction", "per rest area", {"value", "where"}, {}, false, make_traction},
      {"pressure", "follows the surface", {"value", "where"}, {}, true, make_pressure},
      {"nodal_force", "on each vertex", {"value", "where"}, {}, false, make_nodal_force},
      {"spring",
       "pulls each vertex to its rest position + displacement",
       {"stiffness", "where"},
       {"displacement", "velocity"},
       false,
       make_spring},
  };
  return kinds;
}

const LoadKind& require_load_kind(const std::string& name, const std::string& place) {
  const auto found = std::ranges::find(load_kinds(), name, &LoadKind::name);
  if (found != load_kinds().end()) return *found;
  std::vector<std::string> names;
  for (const LoadKind& kind : load_kinds()) names.push_back(kind.name);
  refuse_word(place, name, names);
}

}  // namespace resilin
