// Derivatives of scenes whose bodies have regions, by every parameter: constants and densities of each
// domain.

#include <gmock/gmock.h>

#include "derivative_checks.hpp"
#include "resilin/sensitivity/measured_number.hpp"
#include "short_bar.hpp"

namespace resilin::testing {
namespace {

/// A short bar with a stiff far part of another law and constants of its own for each cell.
Description bar_of_two(int dimension, bool is_dynamic, const std::string& element) {
  Description scene = short_bar(dimension, is_dynamic, element);
  BodyDescription& body = scene.bodies[0];
  RegionDescription region;
  region.name = "stiff";
  region.where.kind = Where::Kind::box;
  region.where.min = {0.25, -1, -1};
  region.where.max = {1, 1, 1};
  region.material.law = "neo_hookean_simo";
  region.material.density = 1500;
  region.material.constants = {{"poissons_ratio", 0.35}};
  const auto count = static_cast<std::size_t>(body.mesh.find_solid(dimension)->num_cells());
  for (std::size_t cell = 0; cell < count; ++cell)
    region.material.cell_constants["youngs_modulus"].push_back(2e5 + 1e4 * static_cast<double>(cell));
  body.regions.push_back(region);
  return scene;
}

TEST(DerivativesByRegions, AreRightAtRest) {
  for (const int dimension : {2, 3})
    for (const std::string element : {"P1", "P2"}) {
      SCOPED_TRACE(element);
      expect_right_derivatives(bar_of_two(dimension, false, element));
    }
}

TEST(DerivativesByRegions, AreRightInMotion) {
  for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
    Description scene = bar_of_two(2, true, "P1");
    scene.integrator = "newmark";
    scene.bodies[0].mass = mass;
    scene.bodies[0].damping = {.mass = 2, .stiffness = 0.005, .shear_viscosity = 3, .bulk_viscosity = 5};
    scene.end_time = 0.03;
    expect_right_derivatives(scene);
  }
}

TEST(DerivativesByRegions, HaveNamesOfTheirOwn) {
  const Description scene = bar_of_two(2, false, "P1");
  const std::vector<std::string> names = parameter_names(World(scene));
  EXPECT_THAT(names, ::testing::IsSupersetOf({"body.body.material.youngs_modulus", "body.body.density",
                                              "body.body.region.stiff.material.youngs_modulus",
                                              "body.body.region.stiff.material.poissons_ratio",
                                              "body.body.region.stiff.density"}));
  const World world(scene);
  EXPECT_EQ(find_parameter(world, "body.body.region.stiff.material.density").value[0], 1500);
  EXPECT_EQ(find_parameter(world, "body.body.region.stiff.material.youngs_modulus").shape,
            std::vector<Eigen::Index>{world.bodies[0].num_cells()});
}

/// Section forces, energies and stresses on both sides, by the modulus of either.
TEST(DerivativesByRegions, AreRightForNumbersOfTheReport) {
  Description scene = bar_of_two(2, false, "P1");
  scene.bodies[0].regions[0].material.cell_constants.clear();
  scene.bodies[0].regions[0].material.constants["youngs_modulus"] = 2e5;
  SectionDescription cut;
  cut.name = "cut";
  cut.at = 0.2;
  scene.sections.push_back(cut);
  cut.name = "cut of the stiff part";
  cut.at = 0.35;
  scene.sections.push_back(cut);
  const std::vector<std::string> names = {"body.body.material.youngs_modulus",
                                          "body.body.region.stiff.material.youngs_modulus",
                                          "body.body.region.stiff.density"};
  const auto measure = [&](Derivatives& run) {
    const int last = run.num_frames() - 1;
    const Body& body = run.world().bodies[0];
    std::vector<MeasuredNumber> all = {energy_at(run, "elastic", nullptr, last)};
    for (const Vector3& at : {Vector3(0.1, 0.12, 0), Vector3(0.4, 0.12, 0)})
      all.push_back(stresses_at(run, body, {at}, "xx", last)[0]);
    for (const char* section : {"cut", "cut of the stiff part"})
      all.push_back(section_force_at(run, section, last)[1]);
    return all;
  };
  const auto run = Derivatives::run(scene, names);
  const int last = run->num_frames() - 1;
  const std::vector<MeasuredNumber> base = measure(*run);
  for (std::size_t i = 0; i < names.size(); ++i) {
    SCOPED_TRACE(names[i]);
    const Parameter parameter = find_parameter(run->world(), names[i]);
    std::vector<VectorX> changes(names.size(), VectorX::Zero(1));
    changes[i] = parameter.value;
    const std::vector<FrameChange> frames = run->forward(changes);
    const auto beside = [&](double t) {
      Description changed = scene;
      parameter.set((1 + t) * parameter.value, changed);
      return measure(*Derivatives::run(changed, {}));
    };
    constexpr double step = 1e-3;
    const auto after = beside(step), before = beside(-step), far = beside(2 * step), near = beside(-2 * step);
    for (std::size_t k = 0; k < base.size(); ++k) {
      const double quotient =
          (8 * (after[k].value - before[k].value) - (far[k].value - near[k].value)) / (12 * step);
      const double slope = base[k].change(frames[static_cast<std::size_t>(last)], changes);
      EXPECT_NEAR(slope, quotient, 1e-6 * (std::abs(quotient) + std::abs(base[k].value))) << k;
    }
  }
}

}  // namespace
}  // namespace resilin::testing
