#include "resilin/fields/contact_traction.hpp"

#include <gtest/gtest.h>

#include "resilin/fields/evaluator.hpp"
#include "resilin/mesh/edit.hpp"
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
        // Corners of quadratic facets bear little, as they do under an even pressure.
        const bool has_idle_corners = element == "P2" && dimension == 3;
        EXPECT_GT(least, has_idle_corners ? 0 : 0.94 * weight_over_area);
        EXPECT_LT(most, (has_idle_corners ? 1.2 : 1.06) * weight_over_area);
        const VectorX traction = contact_traction(world, simulation.state());
        EXPECT_NEAR(traction.segment(0, world.bodies[0].num_nodes * dimension).cwiseAbs().maxCoeff(), most,
                    0.02 * most);
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
