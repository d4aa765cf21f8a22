#include "resilin/world/rigid_region.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/mesh/cell_kind.hpp"
#include "resilin/world/body_mesh.hpp"
#include "resilin/world/region_cells.hpp"

namespace resilin {
namespace {

/// Share of a given stiffness of the rigid body that its cells have besides.
constexpr double share_of_stiffness = 1e-5;

bool is_rigid(const RegionDescription& region) { return region.rigid.has_value(); }

/// Where there is one body, entries need not name it. Rigid regions make it several.
void name_only_body(Description& d) {
  const auto name = [&d](std::string& body) {
    if (body.empty()) body = d.bodies.front().name;
  };
  for (FixDescription& fix : d.fixes) name(fix.body);
  for (LoadDescription& load : d.loads) name(load.body);
  for (ProbeDescription& probe : d.probes) name(probe.body);
  for (SectionDescription& section : d.sections) name(section.body);
  for (ConstraintDescription& constraint : d.constraints) {
    name(constraint.body);
    for (ConstraintTerm& term : constraint.terms) name(term.body);
  }
}

/// The cells of a region by their corners, with the vertices that they use.
Mesh mesh_of(const BodyDescription& body, int dim, const std::vector<Index>& cells) {
  const CellBlock& all = solid_cells(body, dim);
  const auto width = static_cast<std::size_t>(num_corners(all.kind));
  std::vector<Index> used, nodes;
  for (const Index cell : cells)
    for (const Index corner : all.cell(cell).first(width)) nodes.push_back(corner);
  used = nodes;
  std::ranges::sort(used);
  used.erase(std::ranges::unique(used).begin(), used.end());
  Mesh mesh;
  for (const Index vertex : used)
    mesh.vertices.push_back(body.mesh.vertices[static_cast<std::size_t>(vertex)]);
  for (Index& node : nodes) node = static_cast<Index>(std::ranges::lower_bound(used, node) - used.begin());
  mesh.block(first_order(all.kind)).nodes = std::move(nodes);
  return mesh;
}

BodyDescription body_of(const BodyDescription& body, const RegionDescription& region, Mesh mesh) {
  BodyDescription made;
  made.place = region.place;
  made.name = name_of_rigid_region(body, region);
  made.mesh = std::move(mesh);
  made.mesh_name = region.place;
  made.scale = body.scale;
  made.rotate = body.rotate;
  made.translate = body.translate;
  made.velocity = body.velocity;
  made.velocity_gradient = body.velocity_gradient;
  made.damping.mass = body.damping.mass;
  made.rigid = region.rigid.value_or(RigidDescription{});
  made.rigid->region_of = body.name;
  return made;
}

}  // namespace

std::string name_of_rigid_region(const BodyDescription& body, const RegionDescription& region) {
  return body.name + "." + region.name;
}

std::string place_of_rigid_region(const Description& description) {
  for (const BodyDescription& body : description.bodies)
    for (const RegionDescription& region : body.regions)
      if (is_rigid(region)) return region.place;
  return "";
}

void add_rigid_regions(Description& description) {
  if (place_of_rigid_region(description).empty()) return;
  if (description.bodies.size() == 1) name_only_body(description);
  std::vector<BodyDescription> made;
  for (const BodyDescription& body : description.bodies) {
    if (body.rigid || std::ranges::none_of(body.regions, is_rigid)) continue;
    for (const auto& [values, key] : {std::pair(&body.initial_positions, ".initial_positions"),
                                      std::pair(&body.initial_velocities, ".initial_velocities"),
                                      std::pair(&body.contact_shape, ".contact_shape")})
      if (!values->empty())
        throw InputError(body.place + key, "none for a body with a rigid region", "one",
                         "place the body with rotate and translate, and give velocity and velocity_gradient");
    const std::vector<std::vector<Index>> cells = cells_of_domains(body, description.dimension, false);
    bool has_soft_cells = !cells[0].empty();
    for (std::size_t k = 0; k < body.regions.size(); ++k) {
      has_soft_cells = has_soft_cells || !is_rigid(body.regions[k]);
      if (is_rigid(body.regions[k]))
        made.push_back(body_of(body, body.regions[k], mesh_of(body, description.dimension, cells[k + 1])));
    }
    if (!has_soft_cells)
      throw InputError(body.place + ".region", "a deformable cell beside rigid regions", "none",
                       "make it a rigid body: rigid = { density = 7800 } in place of the regions");
  }
  for (BodyDescription& body : made) description.bodies.push_back(std::move(body));
}

void fill_rigid_regions(BodyDescription& body, double modulus) {
  for (RegionDescription& region : body.regions) {
    if (!region.rigid) continue;
    region.material = {};
    region.material.place = region.place + ".rigid";
    region.material.law = "neo_hookean";
    const std::optional<double>& given = region.rigid->stiffness;
    region.material.constants = {{"youngs_modulus", given ? share_of_stiffness * *given : modulus},
                                 {"poissons_ratio", 0}};
    region.material.density = 0;
  }
}

}  // namespace resilin
