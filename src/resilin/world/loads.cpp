#include "resilin/world/loads.hpp"

#include "resilin/world/load_catalog.hpp"
#include "resilin/world/rigid_shape.hpp"
#include "resilin/world/selection.hpp"

namespace resilin {
namespace {

ActiveTime active_time(const LoadDescription& load) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {.from = load.from > 0 ? load.from : -infinity,
          .until = load.until.value_or(infinity),
          .function = load.time_function};
}

}  // namespace

std::shared_ptr<Energy> make_load(const LoadDescription& load, const World& world, const Body& body,
                                  const Mesh& mesh, const SelectionPart* part) {
  const LoadKind& kind = require_load_kind(load.kind, load.place + ".kind");
  const std::string where = load.place + ".where";
  const RigidShape* rigid = body.rigid.get();
  const Body& loaded = rigid != nullptr ? rigid->body : body;
  const VectorX& rest_positions = rigid != nullptr ? rigid->rest_positions : world.rest_positions;
  LoadSite site{.dimension = world.dimension,
                .rest_positions = rest_positions,
                .body = loaded,
                .element = rigid != nullptr ? *rigid->element : body.domains.element(),
                .name = load.name.empty() ? load.place : load.name,
                .where = where,
                .nodes = {},
                .vertices = part != nullptr
                                ? part->nodes
                                : select_vertices(load.where, rigid != nullptr ? rigid->mesh : mesh, loaded,
                                                  rest_positions, world.dimension, where),
                .active = active_time(load),
                .thickness = world.thickness,
                .part = part};
  for (const Index vertex : site.vertices) site.nodes.push_back(loaded.first_node + vertex);
  std::shared_ptr<Energy> made = kind.make(load, site);
  return rigid != nullptr ? carried_term(std::move(made), *rigid, body.first_node, site.vertices) : made;
}

std::shared_ptr<Energy> make_gravity(const Vector3& gravity, const TimeFunction& function, const World& world,
                                     bool is_in_motion) {
  VectorX forces = VectorX::Zero(world.rest_positions.size());
  if (is_in_motion) {
    const int dim = world.dimension;
    world.mass->multiply(gravity.head(dim).replicate(world.num_nodes(), 1), forces);
  } else {
    for (const Body& body : world.bodies) {
      if (body.rigid) {
        for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node)
          forces.segment(Eigen::Index{node} * world.dimension, world.dimension) +=
              world.mass->nodal[node] * gravity.head(world.dimension);
        continue;
      }
      for (const Domain& domain : body.domains)
        add_body_force(body.domains.element(), domain.cells, world.rest_positions,
                       world.thickness * domain.density * gravity, forces);
    }
  }
  return std::make_shared<DeadLoad>("gravity", std::move(forces), world.rest_positions,
                                    ActiveTime{.function = function});
}

}  // namespace resilin
