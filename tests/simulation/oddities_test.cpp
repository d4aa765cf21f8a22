// Remarks at the end of a run that converged and yet shows what no body does.
#include "resilin/simulation/oddities.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string oddities_at_the_end(const Description& scene) {
  const Simulation simulation = run_all(scene);
  EXPECT_TRUE(simulation.is_finished());
  std::string all;
  for (const std::string& line : oddities(simulation.world(), simulation.state())) all += line + "\n";
  return all;
}

/// A bar whose vertices are moved to 1 + `strain` of its length along it.
Description pressed_bar(int dimension, const std::string& law, double strain) {
  Description scene = small_bar(dimension, false);
  scene.gravity.setZero();
  scene.bodies[0].material = material_of(*find_law(law));
  scene.fixes[0].where.kind = Where::Kind::all;
  scene.fixes[0].gradient(0, 0) = strain;
  scene.load_steps = 10;
  return scene;
}

TEST(Oddities, NameCellsThatAreInsideOut) {
  for (const int dimension : {2, 3})
    for (const std::string law : {"linear_elastic", "corotated", "stable_neo_hookean"}) {
      EXPECT_THAT(oddities_at_the_end(pressed_bar(dimension, law, -0.2)), IsEmpty()) << law;
      EXPECT_THAT(oddities_at_the_end(pressed_bar(dimension, law, -1.5)),
                  AllOf(HasSubstr("inverted, cell "), HasSubstr("volume ratio -"), HasSubstr(law)))
          << law << " " << dimension;
    }
}

/// One node in the middle of an edge is pushed until the cell folds beside it; the points do not see it.
TEST(Oddities, NameCellsThatFoldBetweenTheirPoints) {
  for (const int dimension : {2, 3}) {
    Description scene = small_bar(dimension, true);
    scene.bodies[0].element = "P2";
    const World world(scene);
    State state = Simulation(scene).state();
    EXPECT_EQ(folded_cells(world.bodies[0], world, state.positions).count, 0);
    const Body& body = world.bodies[0];
    const Index corner = body.cells[0], middle = body.cells[static_cast<std::size_t>(dimension + 1)];
    const auto place = [&](Index node) {
      return state.positions.segment(Eigen::Index{node} * dimension, dimension);
    };
    place(middle) += 0.6 * (place(corner) - place(middle));  // beyond a quarter of the edge
    ASSERT_EQ(inverted_cells(body, state.positions).count, 0);
    EXPECT_GT(folded_cells(body, world, state.positions).count, 0);
    const std::string words = ::testing::PrintToString(oddities(world, state));
    EXPECT_THAT(words, AllOf(HasSubstr("inverted between quadrature points"), HasSubstr("inversion_bound")));
  }
}

/// A node in the middle of an edge goes into its cell: no point is inverted, two lose most of their volume.
TEST(Oddities, NameCellsThatLoseTheirVolumeAtAPoint) {
  for (const char* element : {"P2", "P2P0"}) {
    Description scene = small_bar(2, true);
    scene.bodies[0].element = element;
    const World world(scene);
    State state = Simulation(scene).state();
    EXPECT_THAT(oddities(world, state), IsEmpty());
    const Body& body = world.bodies[0];
    const auto place = [&](int node) {
      return state.positions.segment(Eigen::Index{body.cells[static_cast<std::size_t>(node)]} * 2, 2);
    };
    // Along the two edges of corner 0, so that the cell keeps its volume.
    for (const int middle : {3, 5}) place(middle) += 0.45 * (place(0) - place(middle));
    std::string all;
    for (const std::string& line : oddities(world, state)) all += line;
    if (std::string(element) == "P2")
      EXPECT_THAT(all, ::testing::Not(HasSubstr("at a point")));
    else
      EXPECT_THAT(all, AllOf(HasSubstr("1 of 32 cells of \"body\""), HasSubstr("at a point, cell 0 most"),
                             HasSubstr("compare with element = \"P2\"")));
  }
}

TEST(Oddities, CountThemAsTheyAre) {
  Description scene = small_bar(3, false);
  scene.fixes[0].where.kind = Where::Kind::all;
  const World world(scene);
  VectorX x = world.rest_positions;
  EXPECT_EQ(inverted_cells(world.bodies[0], x).count, 0);
  for (Eigen::Index i = 0; i < x.size(); i += 3) x[i] *= -0.5;
  const InvertedCells all = inverted_cells(world.bodies[0], x);
  EXPECT_EQ(all.count, world.bodies[0].num_cells());
  EXPECT_NEAR(all.ratio, -0.5, 1e-12);
  x = world.rest_positions;
  x[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_GT(inverted_cells(world.bodies[0], x).count, 0);
}

/// Bars at rest, and those whose vertices are off by more than Newton's method would leave them.
TEST(Oddities, TellWhatIsLeftOutOfBalance) {
  for (const int dimension : {2, 3})
    for (const double error : {0.0, 1e-12, 1e-5, 1e-3}) {
      const Simulation simulation = run_all(small_bar(dimension, false));
      State state = simulation.state();
      std::mt19937 random(7);
      std::uniform_real_distribution<double> component(-error, error);
      for (double& value : state.positions) value += component(random);
      std::string all;
      for (const std::string& line : oddities(simulation.world(), state)) all += line;
      if (error < 1e-6)
        EXPECT_THAT(all, IsEmpty()) << error;
      else
        EXPECT_THAT(all,
                    AllOf(HasSubstr("do not balance"), HasSubstr("a smaller newton.tolerance leaves less")))
            << error;
    }
}

/// A scene in which nothing acts has nothing to balance, whatever rounding leaves.
TEST(Oddities, AskNoBalanceWhereNothingActs) {
  for (const int dimension : {2, 3}) {
    Description scene = small_bar(dimension, false);
    scene.gravity.setZero();
    EXPECT_THAT(oddities_at_the_end(scene), IsEmpty());
    scene.fixes[0].where.kind = Where::Kind::all;
    scene.fixes[0].displacement = {0.1, 0.3, 0};
    EXPECT_THAT(oddities_at_the_end(scene), IsEmpty());
  }
}

/// A body that is thrown at another one and has reached it, or has not.
TEST(Oddities, NameBodiesThatWentThroughEachOther) {
  for (const int dimension : {2, 3})
    for (const double speed : {1.0, 3.0}) {
      Description scene = small_bar(dimension, true);
      scene.gravity.setZero();
      scene.contact.is_enabled = false;
      scene.bodies.push_back(scene.bodies[0]);
      scene.bodies[1].name = "thrown";
      scene.bodies[1].translate = {1.4, 0, 0};
      scene.bodies[1].velocity = {-speed, 0, 0};
      scene.fixes[0].body = scene.probes[0].body = "body";
      if (speed * scene.end_time < 0.4) {
        EXPECT_THAT(oddities_at_the_end(scene), IsEmpty());
      } else {
        EXPECT_THAT(oddities_at_the_end(scene),
                    AllOf(HasSubstr("\"body\" and \"thrown\" overlap"), HasSubstr("penetrate each other")));
      }
    }
}

TEST(Oddities, LeaveToTheStartWhatIsSaidThere) {
  Description scene = small_bar(3, true);
  scene.contact.is_enabled = false;
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[1].name = "other";
  scene.bodies[1].translate = {0.5, 0, 0};
  scene.fixes[0].body = scene.probes[0].body = "body";
  EXPECT_THAT(oddities_at_the_end(scene), IsEmpty());
}

}  // namespace
}  // namespace resilin::testing
