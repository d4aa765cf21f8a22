#include "resilin/fields/contact_gap.hpp"

#include <gtest/gtest.h>

#include "resilin/mesh/facet.hpp"
#include "resting_block.hpp"

namespace resilin::testing {
namespace {

TEST(ContactGap, IsTheDistanceOfWhatTouchesAndTheActivationDistanceElsewhere) {
  for (const int dimension : {2, 3})
    for (const bool is_on_a_body : {false, true}) {
      SCOPED_TRACE(std::to_string(dimension) + (is_on_a_body ? "D on a body" : "D on the ground"));
      const Simulation simulation = converged_end_of(resting_block(dimension, "P1", is_on_a_body));
      const World& world = simulation.world();
      const VectorX& x = simulation.state().positions;
      const VectorX gap = contact_gap(world, simulation.state());
      const double reach = 1e-3;
      if (world.contact) {
        EXPECT_NEAR(gap.minCoeff(), world.contact->smallest_gap(x).distance, 1e-9 * reach);
      }
      for (Index node = 0; node < world.bodies[0].num_nodes; ++node) {
        const double height = node_position(dimension, node, x)[dimension - 1];
        if (height > 0.01) {
          EXPECT_EQ(gap[node], reach);
        } else if (!is_on_a_body) {
          EXPECT_NEAR(gap[node], height, 1e-15);
        }
        EXPECT_GT(gap[node], 0);
      }
    }
}

TEST(ContactGap, IsZeroWhereNothingCanTouch) {
  const Simulation simulation(small_bar(3, true));
  EXPECT_TRUE(contact_gap(simulation.world(), simulation.state()).isZero(0));
}

}  // namespace
}  // namespace resilin::testing
