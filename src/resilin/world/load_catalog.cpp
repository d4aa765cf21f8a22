#include "resilin/world/load_catalog.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/core/vocabulary.hpp"
#include "resilin/element/axisymmetric.hpp"
#include "resilin/energy/handle_spring.hpp"
#include "resilin/energy/pressure.hpp"
#include "resilin/energy/ring_loads.hpp"
#include "resilin/energy/spread_force.hpp"
#include "resilin/world/selection.hpp"

namespace resilin {
namespace {

std::shared_ptr<Energy> dead_load(std::shared_ptr<const LoadedRegion> region, const LoadDescription& load,
                                  const LoadSite& site, double factor = 1) {
  return std::make_shared<DeadLoad>(site.name, site.dimension, std::move(region), factor * load.value,
                                    site.rest_positions, site.active);
}

std::shared_ptr<Energy> make_body_force(const LoadDescription& load, const LoadSite& site) {
  std::vector<Index> cells = select_cells(site.vertices, site.body);
  if (cells.empty() && site.part == nullptr) {
    throw InputError(site.where, "a part of the volume (cells with all their vertices selected)",
                     std::to_string(site.vertices.size()) + " vertices that fill no cell");
  }
  const bool are_all = cells.size() == site.body.cells.size();
  return dead_load(std::make_shared<LoadedCells>(site.element,
                                                 are_all ? site.body.cells : SharedIndices(std::move(cells))),
                   load, site, site.thickness);
}

CellBlock facets_of(const LoadDescription& load, const LoadSite& site) {
  if (site.part == nullptr)
    return select_facets(load.where, site.vertices, site.body, site.rest_positions, site.dimension,
                         site.where);
  CellBlock facets{.kind = cell_sides(site.body.cell_kind)[0].kind, .nodes = site.part->facets};
  for (Index& node : facets.nodes) node += site.body.first_node;
  return facets;
}

std::shared_ptr<Energy> make_traction(const LoadDescription& load, const LoadSite& site) {
  if (is_axisymmetric(site.element))
    return dead_load(std::make_shared<RingTraction>(facets_of(load, site), false), load, site);
  return dead_load(std::make_shared<LoadedFacets>(site.dimension, facets_of(load, site)), load, site,
                   site.thickness);
}

/// Each process knows its own facets alone, not the whole area.
std::shared_ptr<Energy> spread(SpreadForce::Kind kind, const LoadDescription& load, const LoadSite& site) {
  if (site.part != nullptr)
    throw InputError(load.place, "a scene on one MPI process for a load of kind \"" + load.kind + "\"",
                     "several", "give a traction: the force over the area");
  const bool is_number = kind == SpreadForce::Kind::moment && site.dimension == 2;
  return std::make_shared<DeadLoad>(
      site.name, site.dimension,
      std::make_shared<SpreadForce>(kind, site.dimension, facets_of(load, site), load.point),
      is_number ? Vector3(0, 0, load.pressure) : load.value, site.rest_positions, site.active);
}

std::shared_ptr<Energy> make_force(const LoadDescription& load, const LoadSite& site) {
  if (is_axisymmetric(site.element))
    return dead_load(std::make_shared<RingTraction>(facets_of(load, site), true), load, site);
  return spread(SpreadForce::Kind::force, load, site);
}

std::shared_ptr<Energy> make_moment(const LoadDescription& load, const LoadSite& site) {
  return spread(SpreadForce::Kind::moment, load, site);
}

std::shared_ptr<Energy> make_pressure(const LoadDescription& load, const LoadSite& site) {
  if (is_axisymmetric(site.element))
    return std::make_shared<RingPressure>(site.name, facets_of(load, site), load.pressure,
                                          site.rest_positions, site.active);
  return std::make_shared<Pressure>(site.name, site.dimension, facets_of(load, site),
                                    site.thickness * load.pressure, site.rest_positions, site.active);
}

std::shared_ptr<Energy> make_nodal_force(const LoadDescription& load, const LoadSite& site) {
  return dead_load(std::make_shared<LoadedNodes>(site.dimension, site.nodes), load, site);
}

std::shared_ptr<Energy> make_spring(const LoadDescription& load, const LoadSite& site) {
  const HandleSpring::Motion motion{
      .displacement = load.displacement, .velocity = load.velocity, .start = load.from};
  return std::make_shared<HandleSpring>(site.name, site.dimension, site.nodes, load.stiffness, motion,
                                        site.rest_positions, site.active);
}

}  // namespace

const std::vector<LoadKind>& load_kinds() {
  using enum LoadKind::ValueIsNumber;
  static const std::vector<LoadKind> kinds = {
      {"body_force", "per reference volume", {"value"}, {"where"}, never, make_body_force},
      {"force", "in total, spread over the reference area", {"value", "where"}, {"point"}, never, make_force},
      {"moment",
       "in total, as a traction that is linear over the area",
       {"value", "where"},
       {},
       in_2D,
       make_moment},
      {"traction", "per reference area", {"value", "where"}, {}, never, make_traction},
      {"pressure", "follower load", {"value", "where"}, {}, always, make_pressure},
      {"nodal_force", "on each vertex", {"value", "where"}, {}, never, make_nodal_force, true},
      {"spring",
       "pulls each vertex to its reference position + displacement",
       {"stiffness", "where"},
       {"displacement", "velocity"},
       never,
       make_spring,
       true},
  };
  return kinds;
}

const LoadKind& require_load_kind(const std::string& name, const std::string& place) {
  const auto found = std::ranges::find(load_kinds(), name, &LoadKind::name);
  if (found != load_kinds().end()) return *found;
  std::vector<std::string> names;
  for (const LoadKind& kind : load_kinds()) names.push_back(kind.name);
  refuse_own_word(place, name, names);
}

}  // namespace resilin
