// The named materials: each makes a body of the modulus that its line states.

#include "resilin/scene/material_library.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "resilin/material/curve.hpp"
#include "resilin/material/law.hpp"
#include "resilin/simulation/simulation.hpp"
#include "scene_text.hpp"

namespace resilin::testing {
namespace {

std::string scene_of(const std::string& material) {
  return "[simulation]\nkind = \"static\"\n[[body]]\nname = \"cube\"\n"
         "mesh = { box = { size = [1, 1, 1], cells = [1, 1, 1] } }\nmaterial = " +
         material + "\n[[fix]]\nwhere = \"all\"\n";
}

TEST(MaterialLibrary, HasEntriesWithSourcesThatLoad) {
  ASSERT_GE(material_library().size(), 6U);
  std::set<std::string> names;
  for (const LibraryMaterial& material : material_library()) {
    SCOPED_TRACE(material.name);
    EXPECT_TRUE(names.insert(material.name).second);
    for (const std::string* text : {&material.range, &material.about, &material.source})
      EXPECT_GT(text->size(), 10U);
    EXPECT_EQ(material.g.size(), material.tau.size());
    const bool has_fibres = require_law(material.law, "here").max_fibres > 0;
    const std::string fibres = has_fibres ? ", fibres = [[1, 0, 0]]" : "";
    const Simulation simulation(
        read_text(scene_of("{ library = \"" + material.name + "\"" + fibres + " }")).description);
    EXPECT_EQ(simulation.world().bodies[0].domains.front().law, material.law);
    EXPECT_EQ(simulation.world().bodies[0].domains.front().density, material.density);
  }
}

/// The modulus of a thin bar, by a small stretch, is the one stated.
TEST(MaterialLibrary, StatesTheModulusAtSmallStrain) {
  for (const LibraryMaterial& material : material_library()) {
    const LawInfo& law = require_law(material.law, "here");
    const Material made{
        .law = &law, .constants = resolve_constants(law, material.constants, "here"), .fibres = {}};
    const double strain = 1e-5;
    const std::vector<double> stress =
        stretch_curve(made, LoadCase::uniaxial, std::vector<double>{1 - strain, 1 + strain}).nominal_stress;
    const double modulus = (stress[1] - stress[0]) / (2 * strain);
    EXPECT_NEAR(modulus, material.youngs_modulus, 2e-5 * modulus) << material.name;
  }
}

/// Silicones and the gel: nominal stresses of the tests, a curve that rises from compression to the end of
/// the range. Data: doi 10.5281/zenodo.3611329; the gel has only its modulus.
TEST(MaterialLibrary, SiliconesMeetTheirTests) {
  struct Datum {
    std::string name;
    double end, stretch, nominal_stress;  // [Pa]
  };
  const std::vector<Datum> data = {
      {"ecoflex_00_10", 5, 3.659, 0.0470767e6}, {"ecoflex_00_30", 5, 3.045, 0.05355e6},
      {"ecoflex_00_50", 5, 3.659, 0.109035e6},  {"dragon_skin_10", 3, 2.364, 0.167919e6},
      {"dragon_skin_20", 3, 2.364, 0.454703e6}, {"dragon_skin_30", 3, 2.364, 0.61832e6},
      {"pdms_rtv615", 2, 1.682, 0.517633e6},    {"pva_gel", 1, 0.999, -20.76}};
  for (const Datum& datum : data) {
    const LibraryMaterial& material = find_library_material(datum.name, "here");
    const LawInfo& law = require_law(material.law, "here");
    const Material made{
        .law = &law, .constants = resolve_constants(law, material.constants, "here"), .fibres = {}};
    std::vector<double> stretches = {datum.stretch};
    for (double stretch = 0.5; stretch <= datum.end; stretch += 0.05) stretches.push_back(stretch);
    const std::vector<double> stress = stretch_curve(made, LoadCase::uniaxial, stretches).nominal_stress;
    EXPECT_NEAR(stress[0], datum.nominal_stress, 0.03 * std::abs(datum.nominal_stress)) << datum.name;
    for (std::size_t i = 2; i < stress.size(); ++i)
      EXPECT_LT(stress[i - 1], stress[i]) << datum.name << " at " << stretches[i];
  }
}

TEST(MaterialLibrary, RefusesWhatItHasNotAndWhatItBrings) {
  const auto error_of = [](const std::string& material) {
    return input_error([&] { read_text(scene_of(material)); });
  };
  EXPECT_NE(error_of("{ library = \"natural_rubber_yoeh\" }").find("did you mean \"natural_rubber_yeoh\"?"),
            std::string::npos)
      << error_of("{ library = \"natural_rubber_yoeh\" }");
  for (const char* beside : {"law = \"gent\"", "c10 = 1e5", "youngs_modulus = 1e6"}) {
    const std::string message =
        error_of("{ library = \"natural_rubber_yeoh\", " + std::string(beside) + " }");
    EXPECT_NE(message.find("brings its law and constants"), message.npos) << message;
  }
  const Scene own = read_text(scene_of("{ library = \"brain_swine\", density = 1100 }"));
  EXPECT_EQ(own.description.bodies[0].material.density, 1100);
  EXPECT_EQ(own.description.bodies[0].material.viscoelastic->tau, (std::vector<double>{0.5, 50}));
}

}  // namespace
}  // namespace resilin::testing
