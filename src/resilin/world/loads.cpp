#include "resilin/world/loads.hpp"

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/energy/handle_spring.hpp"
#include "resilin/energy/pressure.hpp"
#include "resilin/world/selection.hpp"

namespace resilin {
namespace {

ActiveTime active_time(const LoadDescription& load, bool is_dynamic) {
  if (!is_dynamic) return {};
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {.from = load.from > 0 ? load.from : -infinity,
          .until = load.until.value_or(infinity),
          .function = load.time_function};
}

}  // namespace

std::shared_ptr<Energy> make_load(const LoadDescription& load, const World& world, const Body& body,
                                  const Mesh& mesh) {
  using Kind = LoadDescription::Kind;
  const int dim = world.dimension;
  const std::string where = load.place + ".where";
  const std::string name = load.name.empty() ? load.place : load.name;
  const ActiveTime active = active_time(load, world.is_dynamic);
  const std::vector<Index> vertices =
      select_vertices(load.where, mesh, body, world.rest_positions, dim, where);
  std::vector<Index> nodes = vertices;
  for (Index& node : nodes) node += body.first_node;
  if (load.kind == Kind::spring) {
    const HandleSpring::Motion motion{
        .displacement = load.displacement, .velocity = load.velocity, .start = load.from};
    return std::make_shared<HandleSpring>(name, dim, std::move(nodes), load.stiffness, motion,
                                          world.rest_positions, active);
  }
  if (load.kind == Kind::pressure) {
    return std::make_shared<Pressure>(name, dim, select_facets(vertices, body, where), load.pressure,
                                      world.rest_positions, active);
  }
  VectorX forces = VectorX::Zero(world.rest_positions.size());
  if (load.kind == Kind::body_force) {
    const std::vector<Index> cells = select_cells(vertices, body);
    if (cells.empty()) {
      throw InputError(where, "a part of the volume (cells with all their vertices selected)",
                       std::to_string(vertices.size()) + " vertices that fill no cell");
    }
    add_body_force(body.elastic->element(), cells, world.rest_positions, load.value, forces);
  }
  if (load.kind == Kind::traction) {
    add_traction(dim, select_facets(vertices, body, where), world.rest_positions, load.value, forces);
  }
  if (load.kind == Kind::nodal_force) {
    for (const Index node : nodes) forces.segment(Eigen::Index{node} * dim, dim) = load.value.head(dim);
  }
  return std::make_shared<DeadLoad>(name, std::move(forces), world.rest_positions, active);
}

std::shared_ptr<Energy> make_gravity(const Vector3& gravity, const World& world) {
  VectorX forces = VectorX::Zero(world.rest_positions.size());
  for (const Body& body : world.bodies) {
    add_body_force(body.elastic->element(), body.cells, world.rest_positions, body.density * gravity, forces);
  }
  return std::make_shared<DeadLoad>("gravity", std::move(forces), world.rest_positions);
}

}  // namespace resilin
