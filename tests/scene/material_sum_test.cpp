// Sums of laws in scenes.
#include <gtest/gtest.h>

#include "resilin/energy/elastic.hpp"
#include "resilin/simulation/simulation.hpp"
#include "resilin/world/world.hpp"
#include "scene_text.hpp"

namespace resilin::testing {
namespace {

std::string with_sum(const std::string& parts) {
  return "body.0.material={ density = 1000, sum = [" + parts + "] }";
}

const char* const ground = "{ law = \"mooney_rivlin\", c10 = 2e5, c01 = 1e4, bulk_modulus = 1e6 }";
const char* const fibre =
    "{ law = \"exponential_fibre\", fibre_modulus = 1e5, fibre_stiffening = 0.5, fibres = [[2, 0, 0]] }";

TEST(MaterialOfASum, HasTheConstantsOfItsParts) {
  const Scene scene = read_good_scene_with({with_sum(std::string(ground) + ", " + fibre)});
  const World world(scene.description);
  const Domain& domain = world.bodies[0].domains.front();
  EXPECT_EQ(domain.law, "mooney_rivlin + exponential_fibre");
  const Material material = domain.energy->material(0);
  EXPECT_EQ(material.constants, (std::vector<double>{2e5, 1e4, 1e6, 0, 0, 1e5, 0.5, 2}));
  EXPECT_EQ(domain.constants[5].first, "sum[1].fibre_modulus");
  ASSERT_EQ(material.fibres.size(), 2U);
  EXPECT_EQ(material.fibres[0], Vector3(Vector3::UnitX()));
  EXPECT_EQ(material.fibres[1], Vector3(Vector3::Zero()));
}

TEST(MaterialOfASum, MayVaryFromCellToCell) {
  const Scene scene = read_good_scene_with(
      {"body.0.mesh={ box = { size = [2, 1, 1], cells = [2, 1, 1], kind = \"hexahedra\" } }",
       with_sum("{ law = \"yeoh\", youngs_modulus = [1e5, 2e5], poissons_ratio = 0.3 }, "
                "{ law = \"neo_hookean_isochoric_log\", bulk_modulus = 5e5 }")});
  const World world(scene.description);
  const ElasticEnergy& energy = *world.bodies[0].domains.front().energy;
  EXPECT_NEAR(energy.material(0).constants[0], 1e5 / (4 * 1.3), 1e-9);
  EXPECT_NEAR(energy.material(1).constants[0], 2e5 / (4 * 1.3), 1e-9);
  EXPECT_EQ(energy.material(1).constants[5], 5e5);
}

TEST(MaterialOfASum, RefusesWhatIsNoSum) {
  const auto expect_words = [](const std::string& error, const std::vector<std::string>& words) {
    for (const std::string& word : words) EXPECT_NE(error.find(word), error.npos) << word << " in " << error;
    EXPECT_EQ(error.find('\n'), error.npos);
  };
  expect_words(error_with({with_sum(ground)}), {"material.sum", "2 to 9 tables"});
  expect_words(error_with({with_sum("{ c10 = 1 }, { law = \"yeoh\" }")}), {"sum[0]", "law"});
  expect_words(error_with({with_sum(std::string(ground) + ", { law = \"linear_elastic\" }")}),
               {"sum[1].law", "large strain"});
  expect_words(error_with({with_sum(std::string(ground) + ", { law = \"gent\", limt = 3 }")}),
               {"sum[1].limt", "limit"});
  expect_words(error_with({"body.0.material.law=\"yeoh\"",
                           "body.0.material.sum=[" + std::string(ground) + ", " + fibre + "]"}),
               {"material.law", "sum"});
  expect_words(
      error_with({with_sum(std::string(ground) +
                           ", { law = \"exponential_fibre\", fibre_modulus = 1, fibre_stiffening = 1 }")}),
      {"sum[1].fibres", "1 to 2 families"});
  expect_words(error_with({with_sum(std::string(ground) + ", { law = \"gent\", fibres = [[1, 0, 0]] }")}),
               {"sum[1].fibres", "has no fibres"});
  expect_words(error_with({"simulation={ kind = \"static\", dimension = \"plane_stress\" }",
                           "load.0.value=[0, 0]", "probe.0.at=[2, 0.5]", "simulation.gravity=[0, 0]",
                           "body.0.mesh={ box = { size = [2, 1], cells = [2, 1] } }",
                           with_sum(std::string(ground) + ", " + ground)}),
               {"material.sum", "plane stress"});
}

Vector3 tip_of(const std::vector<std::string>& overrides) {
  std::vector<std::string> all = overrides;
  all.emplace_back("newton.tolerance=1e-11");
  Simulation simulation(World(read_good_scene_with(all).description));
  while (!simulation.is_finished()) simulation.step();
  return simulation.frame().probes[0].displacement;
}

/// Two halves of a law are that law, on displacement and on mixed elements, in 3D.
TEST(MaterialOfASum, IsTheLawOfWhichItHasTheHalves) {
  const std::string half = "{ law = \"neo_hookean_simo\", shear_modulus = 1e5, bulk_modulus = 1e6 }";
  const std::string whole =
      "body.0.material={ law = \"neo_hookean_simo\", shear_modulus = 2e5, bulk_modulus = 2e6, density = 1000 "
      "}";
  const std::string series = "body.0.material.viscoelastic={ g = [0.3], k = [0.2], tau = [0.5] }";
  for (const char* element : {"P1", "P2", "P2P0"}) {
    const std::string chosen = "body.0.element=\"" + std::string(element) + "\"";
    Vector3 elastic = Vector3::Zero();
    for (const bool relaxes : {false, true}) {
      std::vector<std::string> one = {chosen, whole}, two = {chosen, with_sum(half + ", " + half)};
      if (relaxes) one.push_back(series), two.push_back(series);
      const Vector3 expected = tip_of(one), tip = tip_of(two);
      EXPECT_LT((tip - expected).norm(), 1e-9 * expected.norm()) << element << relaxes;
      if (relaxes) {
        EXPECT_GT((tip - elastic).norm(), 0.01 * elastic.norm());
      }
      elastic = tip;
    }
  }
}

}  // namespace
}  // namespace resilin::testing
