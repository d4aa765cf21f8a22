// Mullins softening against closed forms (tests/reference/mullins.json), and what a material with internal
// variables must keep.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "every_integrator.hpp"
#include "reference_case.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/element/axisymmetric.hpp"
#include "resilin/fields/evaluator.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

MaterialDescription softening_rubber(const nlohmann::json& reference) {
  MaterialDescription material;
  material.law = "neo_hookean_isochoric";
  material.constants = {{"shear_modulus", reference["constants"]["mu"]},
                        {"bulk_modulus", reference["constants"]["kappa"]}};
  material.mullins = MullinsDescription{.place = "bar.toml: body[0].material.mullins",
                                        .r = reference["r"],
                                        .m = reference["m"],
                                        .beta = reference["beta"]};
  return material;
}

/// A function of time that is at the stretches less one of the rows, one each second.
TimeFunction stretches_of(const nlohmann::json& rows) {
  TimeFunction::Table table{{0}, {0}};
  for (const auto& row : rows) {
    table.times.push_back(table.times.back() + 1);
    table.values.push_back(row["stretch"].get<double>() - 1);
  }
  return {table};
}

/// A cube of 1 m that is stretched along x, or along x and y, as the rows say; one increment for each.
Description stretched_cube(const nlohmann::json& reference, const std::string& kind,
                           const std::string& element) {
  Description scene;
  scene.dimension = 3;
  scene.newton.tolerance = 1e-12;
  const auto count = static_cast<int>(reference[kind].size());
  scene.end_time = count;
  scene.load_steps = count;
  BodyDescription body;
  body.element = element;
  body.mesh = element[0] == 'Q' ? make_hexahedron_box({1, 1, 1}, {1, 1, 1}) : make_box({1, 1, 1}, {1, 1, 1});
  body.material = softening_rubber(reference);
  scene.bodies.push_back(std::move(body));
  for (int axis = 0; axis < 3; ++axis) {
    FixDescription roller = fix("roller " + std::to_string(axis), plane(axis, 0));
    roller.components = {axis == 0, axis == 1, axis == 2};
    scene.fixes.push_back(roller);
  }
  for (int axis = 0; axis < (kind == "uniaxial" ? 1 : 2); ++axis) {
    FixDescription face = fix("pulled " + std::to_string(axis), plane(axis, 1));
    face.components = {axis == 0, axis == 1, false};
    face.displacement[axis] = 1;
    face.time_function = stretches_of(reference[kind]);
    scene.fixes.push_back(face);
  }
  scene.probes.push_back(probe("corner", {1, 1, 1}));
  return scene;
}

double force_of(const Frame& frame, const std::string& name, int component) {
  for (const auto& [of, force] : frame.reactions)
    if (of == name) return force[component];
  ADD_FAILURE() << "no reaction " << name;
  return 0;
}

void go_to(Simulation& simulation, double time) {
  while (simulation.state().time < time - 1e-9) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
  }
}

TEST(Mullins, CyclesAreThoseOfTheClosedForm) {
  const nlohmann::json reference = read_reference("mullins");
  for (const std::string kind : {"uniaxial", "equibiaxial"})
    for (const std::string element : {"P1", "P2", "P2P0", "Q1", "Q1P0"}) {
      SCOPED_TRACE(kind + ", " + element);
      Simulation simulation(stretched_cube(reference, kind, element));
      double time = 0;
      for (const auto& row : reference[kind]) {
        go_to(simulation, ++time);
        const Frame frame = simulation.frame();
        EXPECT_NEAR(1 + frame.probes[0].displacement.z(), row["free_stretch"].get<double>(), 1e-9);
        EXPECT_NEAR(force_of(frame, "pulled 0", 0), row["P11"].get<double>(), 1e-9 * 1e6);
        const double most = row["W_max"];
        EXPECT_NEAR(simulation.state().history.maxCoeff(), most, 1e-9 * most);
      }
    }
}

/// A cylinder of 1 m that is pulled along its axis.
TEST(Mullins, OfAHalfSectionIsThatOfTheSolid) {
  const nlohmann::json reference = read_reference("mullins");
  for (const std::string element : {"P1", "P2P0", "Q1"}) {
    SCOPED_TRACE(element);
    Description scene = stretched_cube(reference, "uniaxial", "Q1");
    scene.dimension = 2;
    scene.bodies[0].mesh =
        element[0] == 'Q' ? make_quadrilateral_rectangle({1, 1}, {2, 2}) : make_rectangle({1, 1}, {2, 2});
    scene.bodies[0].element = axisymmetric_name(element);
    scene.fixes = {fix("held", plane(1, 0)), fix("pulled", plane(1, 1))};
    for (FixDescription& end : scene.fixes) end.components = {false, true, false};
    scene.fixes[1].displacement = {0, 1, 0};
    scene.fixes[1].time_function = stretches_of(reference["uniaxial"]);
    scene.probes = {probe("corner", {1, 1, 0})};
    Simulation simulation(scene);
    double time = 0;
    for (const auto& row : reference["uniaxial"]) {
      go_to(simulation, ++time);
      EXPECT_NEAR(1 + simulation.frame().probes[0].displacement.x(), row["free_stretch"].get<double>(), 1e-9);
      EXPECT_NEAR(force_of(simulation.frame(), "pulled", 1), std::numbers::pi * row["P11"].get<double>(),
                  1e-9 * 3e6);
    }
  }
}

/// The area of a loop is lost, whatever the number of increments.
TEST(Mullins, ALoopLosesItsArea) {
  const nlohmann::json reference = read_reference("mullins"), loop = reference["loop"];
  for (const int increments : {2, 20}) {
    Description scene = stretched_cube(reference, "uniaxial", "Q1P0");
    scene.fixes.back().displacement[0] = loop["stretch"].get<double>() - 1;
    scene.fixes.back().time_function = {TimeFunction::Table{{0, 1, 2}, {0, 1, 0}}};
    scene.end_time = 2;
    scene.load_steps = increments;
    Simulation simulation(scene);
    const double there = loop["work_load"], back = loop["work_back"];
    go_to(simulation, 1);
    EXPECT_NEAR(simulation.frame().elastic_energy, there, 1e-9 * there);
    EXPECT_NEAR(simulation.frame().dissipated_energy, 0, 1e-9 * there);
    go_to(simulation, 2);
    EXPECT_NEAR(simulation.frame().elastic_energy, 0, 1e-9 * there);
    EXPECT_NEAR(simulation.frame().dissipated_energy, there - back, 1e-9 * there);
  }
}

TEST(Mullins, StressesAreTheSoftenedOnes) {
  const nlohmann::json reference = read_reference("mullins");
  Simulation simulation(stretched_cube(reference, "uniaxial", "Q1"));
  const std::vector<std::string> names = {"cauchy_stress"};
  for (int i = 0; i < 7; ++i) {
    go_to(simulation, i + 1);
    const auto& row = reference["uniaxial"][static_cast<std::size_t>(i)];
    const std::vector<double> stress =
        FieldEvaluator(simulation.world()).evaluate(simulation.state(), names).front().values;
    const double b = row["free_stretch"], expected = row["P11"].get<double>() / (b * b);
    EXPECT_NEAR(stress[0], expected, 1e-9 * expected);
    EXPECT_NEAR(stress[4], 0, 1e-9 * expected);
  }
}

/// A bar that swings in its weight: it softens where it has been strained most.
Description softening_bar(int dimension, bool is_dynamic, const std::string& element) {
  Description scene = small_bar(dimension, is_dynamic);
  scene.bodies[0].element = element;
  scene.bodies[0].material.law = "neo_hookean_simo";
  scene.bodies[0].material.mullins = MullinsDescription{.r = 1.5, .beta = 0.2};
  scene.load_steps = 8;
  return scene;
}

TEST(Mullins, GoesOnFromACheckpointInTheSameBits) {
  for (const std::string& integrator : integrator_names()) {
    Description scene = softening_bar(2, true, "P2P0");
    scene.integrator = integrator;
    expect_same_bits_after_a_checkpoint(scene, 4);
  }
  expect_same_bits_after_a_checkpoint(softening_bar(3, false, "P1"), 4);
}

TEST(Mullins, GivesTheSameBitsForAnyNumberOfThreads) {
  const int threads_before = num_threads();
  std::string state;
  for (const int threads : {1, 2, 5}) {
    set_num_threads(threads);
    const std::string found = serialize(run_all(softening_bar(3, true, "P1")).state());
    if (state.empty()) state = found;
    EXPECT_EQ(found, state);
  }
  set_num_threads(threads_before);
}

TEST(Mullins, LetsASwingingBarLoseEnergy) {
  Description scene = softening_bar(2, true, "P1");
  scene.integrator = "midpoint";
  scene.newton.tolerance = 1e-11;
  scene.time_step = 0.001;
  const Simulation start(scene);
  const Simulation end = converged_end_of(scene);
  const double lost = start.frame().total_energy() - end.frame().total_energy();
  EXPECT_NEAR(end.frame().dissipated_energy, lost, 1e-3 * std::abs(lost) + 1e-6 * end.frame().elastic_energy);
}

TEST(Mullins, OfBadInputIsRefusedInOneLine) {
  const auto with = [](const MullinsDescription& mullins) {
    Description scene = softening_bar(2, false, "P1");
    scene.bodies[0].material.mullins = mullins;
    return scene;
  };
  EXPECT_THAT(refusal_of(with({.r = 1, .m = 1})), HasSubstr("mullins.r: expected a number > 1"));
  EXPECT_THAT(refusal_of(with({.r = 2, .m = -1})), HasSubstr("mullins.m: expected a number >= 0"));
  EXPECT_THAT(refusal_of(with({.r = 2, .m = 1, .beta = -1})), HasSubstr("mullins.beta: expected"));
  EXPECT_THAT(refusal_of(with({.r = 2})), HasSubstr("mullins: expected m > 0 or beta > 0"));
  Description scene = with({.r = 2, .m = 1});
  scene.bodies[0].material.viscoelastic = {.g = {0.3}, .tau = {1}};
  EXPECT_THAT(refusal_of(scene), HasSubstr("mullins: expected either viscoelastic or mullins"));
  scene = with({.r = 2, .m = 1});
  scene.bodies[0].material.law = "neo_hookean";
  EXPECT_THAT(refusal_of(scene), HasSubstr("expected a law with an isochoric-volumetric split"));
  scene = with({.r = 2, .m = 1});
  scene.load_control = LoadControlKind::arc_length;
  EXPECT_THAT(refusal_of(scene), HasSubstr("got one with Mullins softening"));
  scene = with({.r = 2, .m = 1});
  scene.modes.emplace();
  EXPECT_THAT(refusal_of(scene), HasSubstr("leave mullins out: modes are"));
  scene = with({.r = 2, .m = 1});
  scene.sections.emplace_back();
  EXPECT_THAT(refusal_of(scene), HasSubstr("whose material is one with Mullins softening"));
}

}  // namespace
}  // namespace resilin::testing
