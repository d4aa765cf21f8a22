// Words for a search that ends without an equilibrium.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// The words for a bar, one of whose nodes in the middle of an edge has moved far along it.
std::string words_for(const std::string& element) {
  Description scene = small_bar(2, false);
  scene.bodies[0].element = element;
  scene.bodies[0].material.law = "neo_hookean_isochoric";
  scene.bodies[0].material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.49}};
  const World world(scene);
  const Body& body = world.bodies[0];
  VectorX positions = world.rest_positions;
  const Index middle = body.first_node + body.num_vertices;  // the first node that the element has added
  const std::array<Index, 2> ends = body.ends_of_added.front();
  const auto place = [&](Index node) { return world.rest_positions.segment<2>(2 * Eigen::Index{node}); };
  positions.segment<2>(2 * Eigen::Index{middle}) +=
      0.3 * (place(body.first_node + ends[1]) - place(body.first_node + ends[0]));
  NewtonReport report;
  report.reason = "the search ended";
  report.worst_unknown = 2 * middle;
  return describe_failure(world, report, positions);
}

/// Elements with one pressure keep the volume of a cell, which says little of its points.
TEST(Failure, NamesTheElementWhoseVolumeIsLostAtAPoint) {
  const std::string mixed = words_for("P2P0");
  EXPECT_THAT(mixed, HasSubstr("the search ended"));
  EXPECT_THAT(mixed, HasSubstr("smallest volume ratio"));
  EXPECT_THAT(mixed, HasSubstr("take element = \"P2\", or \"Q1P0\""));
  EXPECT_THAT(words_for("P2"), Not(HasSubstr("Q1P0")));
}

}  // namespace
}  // namespace resilin::testing
