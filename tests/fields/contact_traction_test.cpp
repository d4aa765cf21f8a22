#include "resilin/fields/contact_traction.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "resilin/fields/evaluator.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/topology.hpp"
#include "resting_block.hpp"

namespace resilin::testing {
namespace {

/// Even over the underside, and of the size of the weight.
TEST(ContactPressure, CarriesTheWeight) {
  for (const int dimension : {2, 3})
    for (const std::string element : {"P1", "P2"})
      for (const bool is_on_a_body : {false, true}) {
        SCOPED_TRACE(element + " " + std::to_string(dimension) +
                     (is_on_a_body ? " on a body" : " on the ground"));
        const Simulation simulation = converged_end_of(resting_block(dimension, element, is_on_a_body));
        const World& world = simulation.world();
        const VectorX pressure = contact_pressure(world, simulation.state());
        const double weight_over_area = 1000 * 9.81 * 0.3;
        double least = 1e300, most = 0;
        for (Index node = 0; node < world.bodies[0].num_nodes; ++node) {
          const double height = node_position(dimension, node, world.rest_positions)[dimension - 1];
          if (height > 0.01) {  // edges along each other fade out, which turns them a little
            EXPECT_NEAR(pressure[node], 0, 0.01 * weight_over_area);
            continue;
          }
          least = std::min(least, pressure[node]);
          most = std::max(most, pressure[node]);
        }
        EXPECT_GT(least, 0.94 * weight_over_area);
        EXPECT_LT(most, 1.06 * weight_over_area);
        const VectorX traction = contact_traction(world, simulation.state());
        EXPECT_NEAR(traction.segment(0, world.bodies[0].num_nodes * dimension).cwiseAbs().maxCoeff(), most,
                    0.02 * most);
      }
}

/// A block of rubber with a clamped top that is pushed on the ground by 0.15 of its height: it bulges, and
/// its underside grows.
Simulation bulging_block(int dimension, const std::string& element) {
  Description scene = resting_block(dimension, element, false);
  const int up = dimension - 1;
  scene.gravity.setZero();
  BodyDescription& body = scene.bodies[0];
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.45}};
  if (element == "Q1")
    body.mesh = dimension == 3 ? make_hexahedron_box({0.6, 0.6, 0.3}, {4, 4, 3})
                               : make_quadrilateral_rectangle({0.6, 0.3}, {6, 3});
  FixDescription top;
  top.name = "top";
  top.where.kind = Where::Kind::plane;
  top.where.axis = up;
  top.where.at = 0.3 + body.translate[up];
  top.displacement = -0.045 * Vector3::Unit(up);
  scene.fixes = {top};
  return converged_end_of(scene);
}

/// Integrals over the facets of the underside of the first body.
struct Underside {
  double pressure = 0;        ///< true pressure over the deformed area [N]
  double traction = 0;        ///< nominal traction upwards over the area at rest [N]
  double area = 0, rest = 0;  ///< [m^2]
};

Underside measure_underside(const Simulation& simulation) {
  const World& world = simulation.world();
  const VectorX& x = simulation.state().positions;
  const VectorX pressure = contact_pressure(world, simulation.state());
  const VectorX traction = contact_traction(world, simulation.state());
  const int dim = world.dimension;
  const Body& body = world.bodies[0];
  const CellBlock facets = boundary({.kind = body.cell_kind, .nodes = body.cells}).facets;
  Underside sums;
  for (Index facet = 0; facet < facets.num_cells(); ++facet) {
    const auto nodes = facets.cell(facet);
    if (std::ranges::any_of(
            nodes, [&](Index i) { return node_position(dim, i, world.rest_positions)[dim - 1] > 0.01; }))
      continue;
    for (const FacetPoint& point : facet_points(facets.kind)) {
      const double now = point.weight * area_vector(dim, point, nodes, x).norm();
      const double rest = point.weight * area_vector(dim, point, nodes, world.rest_positions).norm();
      sums.area += now;
      sums.rest += rest;
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        sums.pressure += now * point.values[a] * pressure[nodes[a]];
        sums.traction += rest * point.values[a] * node_position(dim, nodes[a], traction)[dim - 1];
      }
    }
  }
  return sums;
}

TEST(ContactPressure, IntegratesToTheForceOverTheDeformedAreaAndTheTractionOverTheAreaAtRest) {
  for (const int dimension : {2, 3})
    for (const std::string element : {"P1", "P2", "Q1"}) {
      SCOPED_TRACE(element + " " + std::to_string(dimension));
      const Simulation simulation = bulging_block(dimension, element);
      const Underside sums = measure_underside(simulation);
      EXPECT_GT(sums.area, 1.05 * sums.rest);
      double force = 0;
      for (const auto& [name, reaction] : simulation.frame().reactions)
        if (name == "ground") force = reaction[dimension - 1];
      ASSERT_GT(force, 0);
      EXPECT_NEAR(sums.pressure, force, 0.01 * force);
      EXPECT_NEAR(sums.traction, force, 0.01 * force);
      const std::vector<ContactPatch> patches = contact_patches(simulation.world(), simulation.state());
      ASSERT_EQ(patches.size(), 1U);
      EXPECT_NEAR(patches[0].force, force, 0.01 * force);
      EXPECT_NEAR(patches[0].area, sums.area, 0.01 * sums.area);
      EXPECT_NEAR(patches[0].reference_area, sums.rest, 0.01 * sums.rest);
      EXPECT_NEAR(patches[0].width, dimension == 2 ? sums.area : 0, 0.01 * sums.area);
    }
}

/// On a skin, too, at all nodes that carry it; its facets may be wound either way.
TEST(ContactPressure, OfASkinIsThatOfItsFacets) {
  for (const std::string element : {"P1", "P2"})
    for (const bool is_wound_inwards : {false, true}) {
      Description scene = resting_block(3, element, false);
      BodyDescription& body = scene.bodies[0];
      body.skin = SkinDescription{.place = "skin",
                                  .surface = extract_surface(make_box({0.6, 0.6, 0.3}, {7, 7, 4})).mesh,
                                  .surface_name = "fine.obj"};
      std::vector<Index>& corners = body.skin->surface.block(CellKind::triangle).nodes;
      for (std::size_t t = 0; is_wound_inwards && t < corners.size(); t += 3)
        std::swap(corners[t], corners[t + 1]);
      body.contact_surface = MeetingSurface::skin;
      const Simulation simulation = converged_end_of(scene);
      const World& world = simulation.world();
      const VectorX pressure = contact_pressure(world, simulation.state());
      const double weight_over_area = 1000 * 9.81 * 0.3;
      for (Index node = 0; node < world.num_nodes(); ++node) {
        const double height = node_position(3, node, world.rest_positions)[2];
        // The vertices of the skin sample shape functions that bend between them.
        if (height > 0.01) continue;
        EXPECT_NEAR(pressure[node], weight_over_area, 0.2 * weight_over_area) << element;
      }
    }
}

/// The whole underside, with the weight in its middle.
TEST(ContactPatches, OfABlockAtRestAreItsUnderside) {
  for (const int dimension : {2, 3})
    for (const bool is_on_a_body : {false, true}) {
      SCOPED_TRACE(std::to_string(dimension) + (is_on_a_body ? " on a body" : " on the ground"));
      const Simulation simulation = converged_end_of(resting_block(dimension, "P1", is_on_a_body));
      const std::vector<ContactPatch> patches = contact_patches(simulation.world(), simulation.state());
      ASSERT_EQ(patches.size(), 1U);
      const ContactPatch& patch = patches[0];
      EXPECT_EQ(patch.collider, is_on_a_body ? "" : "ground");
      const double area = dimension == 2 ? 0.6 : 0.36, weight = 1000 * 9.81 * 0.3 * area;
      EXPECT_NEAR(patch.area, area, 0.01 * area);
      EXPECT_NEAR(patch.force, weight, 0.01 * weight);
      EXPECT_NEAR(patch.mean_pressure(), weight / area, 0.02 * weight / area);
      EXPECT_LT(patch.largest_pressure, 1.06 * weight / area);
      for (int k = 0; k < dimension - 1; ++k) {
        EXPECT_NEAR(patch.center[k], 0.3, 4e-3);  // its sides bear a moment
        EXPECT_NEAR(patch.extent[k], 0.6, 1e-3);
      }
      const double sunk = is_on_a_body ? weight / area * 0.3 / 1e5 : 0;  // the base is compressed
      EXPECT_NEAR(patch.center[dimension - 1], -sunk, 1e-3);
      EXPECT_NEAR(patch.extent[dimension - 1], 0, 1e-3);
    }
}

}  // namespace
}  // namespace resilin::testing
