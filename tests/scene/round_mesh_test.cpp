// Round bodies that a scene describes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "resilin/mesh/round_generators.hpp"
#include "resilin/world/resultants.hpp"
#include "scene_text.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

struct RoundCase {
  std::string mesh;
  int dim;
  double volume;                   ///< volume of the true body; in 2D its area
  std::vector<std::string> sides;  ///< groups, and the areas of these
  std::vector<double> areas;
};

const double pi = std::numbers::pi;

std::vector<RoundCase> round_cases() {
  return {
      {"disc = { radius = 2, cells = 4 }", 2, 4 * pi, {"outer"}, {4 * pi}},
      {"ring = { radii = [1, 2], cells = [2, 24] }", 2, 3 * pi, {"inner", "outer"}, {2 * pi, 4 * pi}},
      {"ring = { radii = [1, 2], cells = [3, 8], degrees = 90, grading = 3 }",
       2,
       0.75 * pi,
       {"outer", "start", "end"},
       {pi, 1, 1}},
      {"cylinder = { radius = 1, height = 3, cells = [3, 2] }",
       3,
       3 * pi,
       {"outer", "bottom", "top"},
       {6 * pi, pi, pi}},
      {"tube = { radii = [1, 2], height = 0.5, cells = [2, 24, 1] }",
       3,
       1.5 * pi,
       {"inner", "outer", "top"},
       {pi, 2 * pi, 3 * pi}},
      {"ball = { radius = 1, cells = 4 }", 3, 4 * pi / 3, {"outer"}, {4 * pi}},
      {"spherical_shell = { radii = [1, 1.1], cells = [1, 24] }",
       3,
       4 * pi / 3 * 0.331,
       {"inner", "outer"},
       {4 * pi, 4.84 * pi}},
  };
}

Description scene_of(const RoundCase& round, const std::string& element) {
  std::string text = "[simulation]\nkind = \"static\"\ndimension = " + std::to_string(round.dim) +
                     "\n[[body]]\nname = \"b\"\nelement = \"" + element + "\"\nmesh = { " + round.mesh +
                     " }\nmaterial = { law = \"neo_hookean\", youngs_modulus = 1e5, poissons_ratio = 0.3, "
                     "density = 1 }\n[[fix]]\nwhere = \"all\"\n";
  for (const std::string& side : round.sides)
    text += "[[load]]\nkind = \"pressure\"\nvalue = 1\nwhere = { group = \"" + side + "\" }\n";
  return read_text(text).description;
}

TEST(RoundBodies, HaveTheirVolumeAndTheAreasOfTheirSides) {
  for (const RoundCase& round : round_cases())
    for (const std::string element : {"P1", "P2", "Q1"}) {
      SCOPED_TRACE(round.mesh + ", " + element);
      const World world(scene_of(round, element));
      const double tolerance = element == "P2" ? 2e-3 : 0.12;
      EXPECT_NEAR(world.bodies[0].mass / round.volume, 1, tolerance);
      const std::vector<Resultant> loads = load_resultants(world);
      ASSERT_EQ(loads.size(), round.sides.size());
      for (std::size_t i = 0; i < loads.size(); ++i)
        EXPECT_NEAR(loads[i].area / round.areas[i], 1, tolerance) << round.sides[i];
    }
}

TEST(RoundBodies, AreRefusedInWords) {
  const auto refusal = [](const std::string& mesh, int dim) {
    return input_error([&] { scene_of({mesh, dim, 0, {}, {}}, "auto"); });
  };
  EXPECT_THAT(refusal("disc = { radius = 1, cells = 2 }", 3),
              HasSubstr("a disc belongs to a scene of dimension 2"));
  EXPECT_THAT(refusal("disc = { radii = [1, 2], cells = 2 }", 2), HasSubstr("a disc"));
  EXPECT_THAT(refusal("tube = { radii = [1, 2], height = 1, cells = 2 }", 3),
              HasSubstr("a tube needs 3 numbers of cells: cells = [2, 32, 8]"));
  EXPECT_THAT(refusal("ring = { radii = [2, 1], cells = [2, 8] }", 2), HasSubstr("inner < outer"));
  EXPECT_THAT(refusal("ball = { radius = 1, cells = 10000 }", 3), HasSubstr("use fewer cells"));
  EXPECT_THAT(refusal("disk = { radius = 1, cells = 2 }", 2), HasSubstr("it is called \"disc\" here"));
}

}  // namespace
}  // namespace resilin::testing
