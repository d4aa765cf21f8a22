#include "resilin/simulation/distributed_loads.hpp"

#include <algorithm>
#include <span>

#include "resilin/energy/dead_load.hpp"
#include "resilin/energy/pressure.hpp"
#include "resilin/energy/spread_force.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

void add_facets(const CellBlock& block, const auto& force_of, DistributedLoads& loads) {
  const auto num_corners = static_cast<std::size_t>(resilin::num_corners(block.kind));
  for (Index facet = 0; facet < block.num_cells(); ++facet) {
    const std::span<const Index> corners = block.cell(facet).first(num_corners);
    loads.facets.push_back({{corners.begin(), corners.end()}, force_of(corners)});
  }
}

}  // namespace

DistributedLoads distributed_loads(const World& world, const VectorX& x, const Conditions& c) {
  DistributedLoads loads;
  loads.acceleration = world.gravity_function.factor(c.time, c.load) * world.gravity;
  loads.bodies.assign(world.bodies.size(), Vector3::Zero());
  for (const auto& term : world.terms) {
    if (const auto* pressure = dynamic_cast<const Pressure*>(term.get())) {
      const CellKind kind = first_order(pressure->facets().kind);
      add_facets(
          pressure->facets(),
          [&](std::span<const Index> corners) {
            return Vector3(-pressure->pressure(c) * area_vector(world.dimension, kind, corners, x));
          },
          loads);
      continue;
    }
    const auto* dead = dynamic_cast<const DeadLoad*>(term.get());
    if (dead == nullptr) continue;
    const Vector3 density = dead->density(c);
    if (const auto* on = dynamic_cast<const LoadedFacets*>(dead->region())) {
      const CellKind kind = first_order(on->facets().kind);
      add_facets(
          on->facets(),
          [&](std::span<const Index> corners) {
            return Vector3(area_vector(world.dimension, kind, corners, world.rest_positions).norm() *
                           density);
          },
          loads);
    } else if (const auto* spread = dynamic_cast<const SpreadForce*>(dead->region())) {
      const CellKind kind = first_order(spread->facets().kind);
      const SpreadForce::Traction traction = spread->traction(density, world.rest_positions);
      add_facets(
          spread->facets(),
          [&](std::span<const Index> corners) {
            Vector3 middle = Vector3::Zero();
            for (const Index corner : corners)
              middle += node_position(world.dimension, corner, world.rest_positions) /
                        static_cast<double>(corners.size());
            return Vector3(area_vector(world.dimension, kind, corners, world.rest_positions).norm() *
                           traction.at(middle));
          },
          loads);
    } else if (const auto* cells = dynamic_cast<const LoadedCells*>(dead->region())) {
      const auto whole = std::ranges::find_if(
          world.bodies, [&](const Body& body) { return std::ranges::equal(body.cells, cells->cells()); });
      if (whole != world.bodies.end()) {
        loads.bodies[static_cast<std::size_t>(whole - world.bodies.begin())] += density;
        continue;
      }
      const Body& body = world.body_of(cells->cells().front());
      const auto n = static_cast<std::size_t>(num_nodes(body.cell_kind));
      for (std::size_t i = 0; i < cells->cells().size(); i += n)
        loads.cells.try_emplace({cells->cells().begin() + i, cells->cells().begin() + i + n}, Vector3::Zero())
            .first->second += density;
    }
  }
  return loads;
}

}  // namespace resilin
