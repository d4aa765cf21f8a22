// Viscoelasticity at finite strain, against closed forms and another code (tests/reference/viscoelastic.json,
// visco_strip.json), and what every term with internal variables must keep.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "every_integrator.hpp"
#include "reference_case.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/element/axisymmetric.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/mesh/round_generators.hpp"
#include "resilin/simulation/potential.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

ViscoelasticDescription prony(std::vector<double> g, std::vector<double> tau) {
  return {.place = "bar.toml: body[0].material.viscoelastic", .g = std::move(g), .tau = std::move(tau)};
}

ViscoelasticDescription prony_of(const nlohmann::json& pairs) {
  std::vector<double> g, tau;
  for (const auto& pair : pairs) {
    g.push_back(pair[0]);
    tau.push_back(pair[1]);
  }
  return prony(g, tau);
}

MaterialDescription reference_rubber(const std::string& law, const nlohmann::json& constants) {
  MaterialDescription material;
  if (law == "mooney_rivlin") {
    material.law = law;
    material.constants = {
        {"c10", constants["c10"]}, {"c01", constants["c01"]}, {"bulk_modulus", constants["kappa"]}};
  } else {
    material.law = "neo_hookean_isochoric";
    material.constants = {{"shear_modulus", constants["mu"]}, {"bulk_modulus", constants["kappa"]}};
  }
  return material;
}

/// A cube of 1 m, one cell, on rollers at x = 0, y = 0 and z = 0.
Description reference_cube(const std::string& law, double end_time, int steps) {
  const nlohmann::json reference = read_reference("viscoelastic");
  Description scene;
  scene.dimension = 3;
  scene.newton.tolerance = 1e-12;
  scene.end_time = end_time;
  scene.load_steps = steps;
  BodyDescription body;
  body.element = "Q1";
  body.mesh = make_hexahedron_box({1, 1, 1}, {1, 1, 1});
  body.material = reference_rubber(law, reference["laws"][law]);
  body.material.viscoelastic = prony_of(reference["prony_g_tau"]);
  scene.bodies.push_back(std::move(body));
  for (int axis = 0; axis < 3; ++axis) {
    FixDescription roller = fix("roller " + std::to_string(axis), plane(axis, 0));
    roller.components = {axis == 0, axis == 1, axis == 2};
    scene.fixes.push_back(roller);
  }
  scene.probes.push_back(probe("corner", {1, 1, 1}));
  return scene;
}

/// Its face at x = 1 moves along x by `displacement` times a function of time.
void pull(Description& scene, double displacement, const TimeFunction& function) {
  FixDescription face = fix("pulled", plane(0, 1));
  face.components = {true, false, false};
  face.displacement = {displacement, 0, 0};
  face.time_function = function;
  scene.fixes.push_back(face);
}

TimeFunction table(std::vector<double> times, std::vector<double> values) {
  return {TimeFunction::Table{std::move(times), std::move(values)}};
}

/// It starts with the stretches of a row.
void start_stretched(Description& scene, const nlohmann::json& row) {
  for (const Vector3& X : scene.bodies[0].mesh.vertices) {
    scene.bodies[0].initial_positions.push_back(row["stretch"].get<double>() * X.x());
    for (const double x : {X.y(), X.z()})
      scene.bodies[0].initial_positions.push_back(row["lateral_stretch"].get<double>() * x);
  }
}

double reaction(const Frame& frame, const std::string& name, int component) {
  for (const auto& [of, force] : frame.reactions)
    if (of == name) return force[component];
  ADD_FAILURE() << "no reaction " << name;
  return 0;
}

/// Steps until the time of a row.
void step_to(Simulation& simulation, double time) {
  while (simulation.state().time < time - 1e-9) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
  }
}

void expect_stretches(const Simulation& simulation, const nlohmann::json& row, double tolerance) {
  const Vector3 displacement = simulation.frame().probes[0].displacement;
  EXPECT_NEAR(1 + displacement.x(), row["stretch"].get<double>(), tolerance);
  EXPECT_NEAR(1 + displacement.y(), row["lateral_stretch"].get<double>(), tolerance);
  EXPECT_NEAR(1 + displacement.z(), row["lateral_stretch"].get<double>(), tolerance);
}

struct ViscoelasticReference : ::testing::TestWithParam<std::tuple<std::string, ViscoelasticForm>> {
  const nlohmann::json reference = read_reference("viscoelastic");
  const std::string law = std::get<0>(GetParam());
  const ViscoelasticForm formulation = std::get<1>(GetParam());
  const std::string name = law + "_" + std::string(spelling(formulation));

  Description cube(double end_time, int steps) const {
    Description scene = reference_cube(law, end_time, steps);
    scene.bodies[0].material.viscoelastic->formulation = formulation;
    return scene;
  }
  nlohmann::json rows(const std::string& kind) const { return reference["results"][name][kind]; }
};

TEST_P(ViscoelasticReference, StepsAreThoseOfTheUpdateRule) {
  Description scene = cube(2, 20);
  pull(scene, 0.8, table({0, 1, 2}, {0, 1, 1}));
  Simulation simulation(scene);
  for (const auto& row : rows("time_discrete")["linear"]) {
    step_to(simulation, row["t"]);
    expect_stretches(simulation, row, 1e-9);
    const double P = row["P11"];
    EXPECT_NEAR(reaction(simulation.frame(), "pulled", 0), P, 1e-9 * P);
  }
}

/// A cylinder of 1 m, pulled along its axis, has the stretches of the cube and pi times its force.
TEST_P(ViscoelasticReference, StepsOfACylinderAreThoseOfTheUpdateRule) {
  for (const char* element : {"P1", "P2", "P2P0", "Q1", "Q1P0"}) {
    SCOPED_TRACE(element);
    Description scene = cube(2, 20);
    scene.dimension = 2;
    scene.bodies[0].mesh =
        element[0] == 'Q' ? make_quadrilateral_rectangle({1, 1}, {2, 2}) : make_rectangle({1, 1}, {2, 2});
    scene.bodies[0].element = axisymmetric_name(element);
    scene.fixes = {fix("held", plane(1, 0)), fix("pulled", plane(1, 1))};
    for (FixDescription& end : scene.fixes) end.components = {false, true, false};
    scene.fixes[1].displacement = {0, 0.8, 0};
    scene.fixes[1].time_function = table({0, 1, 2}, {0, 1, 1});
    scene.probes = {probe("corner", {1, 1, 0})};
    Simulation simulation(scene);
    for (const auto& row : rows("time_discrete")["linear"]) {
      step_to(simulation, row["t"]);
      const Vector3 displacement = simulation.frame().probes[0].displacement;
      EXPECT_NEAR(1 + displacement.y(), row["stretch"].get<double>(), 1e-9);
      EXPECT_NEAR(1 + displacement.x(), row["lateral_stretch"].get<double>(), 1e-9);
      const double force = std::numbers::pi * row["P11"].get<double>();
      EXPECT_NEAR(reaction(simulation.frame(), "pulled", 1), force, 1e-9 * force);
    }
  }
}

TEST_P(ViscoelasticReference, StressRelaxesAfterAJump) {
  Description scene = cube(1, 200);
  start_stretched(scene, rows("relaxation_jump_finite")[0]);
  pull(scene, 0.8, table({0}, {1}));
  Simulation simulation(scene);
  for (const auto& row : rows("relaxation_jump_finite")) {
    if (row["t"] > 1) break;
    step_to(simulation, row["t"]);
    const double tolerance = row["t"] == 0.0 ? 1e-9 : 1e-6;  // the lateral stretch does not move evenly
    expect_stretches(simulation, row, tolerance);
    const double P = row["P11"];
    EXPECT_NEAR(reaction(simulation.frame(), "pulled", 0), P, tolerance * P);
  }
}

TEST_P(ViscoelasticReference, CreepsUnderALoadThatStays) {
  Description scene = cube(1, 200);
  const nlohmann::json creep = rows("creep_jump");
  start_stretched(scene, creep["rows"][0]);
  LoadDescription load;
  load.name = "load";
  load.kind = "traction";
  load.where = plane(0, 1);
  load.value = {creep["P11"], 0, 0};
  load.time_function = table({0}, {1});
  scene.loads.push_back(load);
  Simulation simulation(scene);
  for (const auto& row : creep["rows"]) {
    if (row["t"] > 1) break;
    step_to(simulation, row["t"]);
    expect_stretches(simulation, row, 1e-5);  // second order in steps of 5 ms
  }
}

TEST_P(ViscoelasticReference, CyclesLoseTheAreaOfTheirLoops) {
  Description scene = cube(2, 400);
  const nlohmann::json cyclic = rows("cyclic");
  pull(scene, 0.5 * cyclic["A"].get<double>(),
       {TimeFunction::Sine{.frequency = 1, .amplitude = 1, .phase = -90, .offset = 1}});
  Simulation simulation(scene);
  double before = 0;
  for (const auto& row : cyclic["rows"]) {
    const int cycle = row["cycle"];
    if (cycle > 2) break;
    step_to(simulation, cycle - 0.5);
    EXPECT_NEAR(reaction(simulation.frame(), "pulled", 0), row["P11_at_peak_stretch"].get<double>(), 10);
    step_to(simulation, cycle);
    EXPECT_NEAR(reaction(simulation.frame(), "pulled", 0), row["P11_at_end"].get<double>(), 10);
    const double work = simulation.frame().elastic_energy + simulation.frame().dissipated_energy;
    const double area = row["loop_area_per_volume"];
    EXPECT_NEAR(work - before, area, 4e-4 * area);  // second order in steps of 5 ms
    before = work;
  }
}

TEST_P(ViscoelasticReference, ForcesFollowARampToTheIntegral) {
  if (formulation == ViscoelasticForm::whole) return;  // without rows of this kind
  const nlohmann::json ramp = rows("ramp_finite_rate1.0");
  Description scene = cube(0.8, 400);
  pull(scene, 0.8, table({0, 0.8}, {0, 1}));
  Simulation simulation(scene);
  int count = 0;
  for (const auto& row : ramp["rows"]) {
    if (row["t"] > 0.8 + 1e-9 || row["t"] == 0.0) continue;
    step_to(simulation, row["t"]);
    const double P = row["P11"];
    EXPECT_NEAR(reaction(simulation.frame(), "pulled", 0), P, 1e-5 * P);
    ++count;
  }
  EXPECT_GT(count, 0);
}

TEST_P(ViscoelasticReference, StressesInSimpleShearAreThoseOfTheIntegral) {
  if (formulation == ViscoelasticForm::whole) return;  // without rows of this kind
  Description scene = cube(0.2, 200);
  scene.fixes.clear();
  FixDescription all = fix("all", Where());
  all.gradient(0, 1) = 1.2;
  all.time_function = table({0, 0.2}, {0, 1});
  scene.fixes.push_back(all);
  Simulation simulation(scene);
  const std::vector<std::string> names = {"cauchy_stress"};
  for (const auto& row : reference["results"]["shear_" + name]["ramp_finite"]["rows"]) {
    if (row["t"] > 0.2) break;
    step_to(simulation, row["t"]);
    const std::vector<double> stress =
        FieldEvaluator(simulation.world()).evaluate(simulation.state(), names).front().values;
    const double scale = row["cauchy12"];
    EXPECT_NEAR(stress[1], row["cauchy12"].get<double>(), 1e-5 * scale);
    EXPECT_NEAR(stress[0], row["cauchy11"].get<double>(), 1e-5 * scale);
    EXPECT_NEAR(stress[4], row["cauchy22"].get<double>(), 1e-5 * scale);
    EXPECT_NEAR(stress[8], row["cauchy33"].get<double>(), 1e-5 * scale);
    const double work = simulation.frame().elastic_energy + simulation.frame().dissipated_energy;
    EXPECT_NEAR(work, row["work_per_volume"].get<double>(), 1e-4 * work);
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, ViscoelasticReference,
                         ::testing::Combine(::testing::Values("nh_iso_j1", "mooney_rivlin"),
                                            ::testing::Values(ViscoelasticForm::simo, ViscoelasticForm::iso,
                                                              ViscoelasticForm::whole)),
                         [](const auto& of) {
                           return std::get<0>(of.param) + "_" + std::string(spelling(std::get<1>(of.param)));
                         });

struct BulkRelaxation : ::testing::TestWithParam<ViscoelasticForm> {
  /// The cube, or a cylinder of radius and length 1 m.
  static Description body(const std::string& element, bool is_ring) {
    const nlohmann::json reference = read_reference("viscoelastic_bulk");
    Description scene = reference_cube("nh_iso_j1", 2, 20);
    BodyDescription& cube = scene.bodies[0];
    cube.material = reference_rubber("nh_iso_j1", reference["constants"]);
    cube.material.viscoelastic = prony(reference["g"], reference["tau"]);
    cube.material.viscoelastic->k = reference["k"].get<std::vector<double>>();
    cube.material.viscoelastic->formulation = GetParam();
    cube.element = is_ring ? axisymmetric_name(element) : element;
    if (is_ring) {
      scene.dimension = 2;
      cube.mesh =
          element[0] == 'Q' ? make_quadrilateral_rectangle({1, 1}, {2, 2}) : make_rectangle({1, 1}, {2, 2});
      scene.fixes = {fix("held", plane(1, 0))};
      scene.fixes[0].components = {false, true, false};
      scene.probes = {probe("corner", {1, 1, 0})};
    } else if (element[0] == 'P') {
      cube.mesh = make_box({1, 1, 1}, {1, 1, 1});
    }
    return scene;
  }
};

TEST_P(BulkRelaxation, StepsAreThoseOfTheUpdateRule) {
  const nlohmann::json rows =
      read_reference("viscoelastic_bulk")["results"][std::string(spelling(GetParam()))];
  for (const std::string element : {"P1", "P2", "P2P0", "Q1", "Q1P0"})
    for (const bool is_ring : {false, true}) {
      SCOPED_TRACE(element + (is_ring ? ", axisymmetric" : ""));
      Description scene = body(element, is_ring);
      const int along = is_ring ? 1 : 0, across = 1 - along;
      FixDescription face = fix("pulled", plane(along, 1));
      face.components = {!is_ring, is_ring, false};
      face.displacement[along] = 0.8;
      face.time_function = table({0, 1, 2}, {0, 1, 1});
      scene.fixes.push_back(face);
      Simulation simulation(scene);
      for (const auto& row : rows) {
        step_to(simulation, row["t"]);
        const Vector3 displacement = simulation.frame().probes[0].displacement;
        EXPECT_NEAR(1 + displacement[across], row["lateral_stretch"].get<double>(), 1e-9);
        const double force = (is_ring ? std::numbers::pi : 1) * row["P11"].get<double>();
        EXPECT_NEAR(reaction(simulation.frame(), "pulled", along), force, 1e-9 * force);
      }
    }
}

/// A cube that has grown at once by a tenth in all directions and stays so: its Cauchy pressure falls as
/// k(t).
TEST_P(BulkRelaxation, PressureOfAHeldVolumeFollowsTheSeries) {
  Description scene = body("Q1", false);
  scene.fixes = {fix("all", Where())};
  scene.fixes[0].gradient = 0.1 * Matrix<3>::Identity();
  scene.fixes[0].time_function = table({0}, {1});
  for (const Vector3& X : scene.bodies[0].mesh.vertices)
    for (const double x : {X.x(), X.y(), X.z()}) scene.bodies[0].initial_positions.push_back(1.1 * x);
  Simulation simulation(scene);
  const std::vector<std::string> names = {"cauchy_stress"};
  for (const double time : {0.1, 0.5, 2.0}) {
    step_to(simulation, time);
    const std::vector<double> stress =
        FieldEvaluator(simulation.world()).evaluate(simulation.state(), names).front().values;
    const double k = 0.7 + 0.2 * std::exp(-time / 0.1) + 0.1 * std::exp(-time / 2);
    const double pressure = k * 2e6 * (std::pow(1.1, 3) - 1);
    for (const std::size_t i : {0U, 4U, 8U}) EXPECT_NEAR(stress[i], pressure, 1e-12 * pressure);
    EXPECT_NEAR(stress[1], 0, 1e-12 * pressure);
  }
}

/// Where both moduli relax alike, small strains are those of the formulation in which all of the stress does.
TEST_P(BulkRelaxation, OfEqualSharesIsThatOfTheWholeStressAtSmallStrain) {
  const auto force = [](ViscoelasticForm form) {
    Description scene = body("Q1", false);
    ViscoelasticDescription& viscoelastic = *scene.bodies[0].material.viscoelastic;
    viscoelastic.formulation = form;
    if (form == ViscoelasticForm::whole)
      viscoelastic.k.clear();
    else
      viscoelastic.k = viscoelastic.g;
    pull(scene, 1e-6, table({0, 1, 2}, {0, 1, 1}));
    return reaction(converged_end_of(scene).frame(), "pulled", 0);
  };
  const double whole = force(ViscoelasticForm::whole);
  EXPECT_NEAR(force(GetParam()), whole, 1e-5 * whole);
}

/// Work against the pressure of the branches joins the heat: a slow cycle of volume loses none, one as fast
/// as the branches does, and the sum of the energies is the work of the reaction.
TEST_P(BulkRelaxation, WorkIsStoredOrLost) {
  Description scene = body("Q1P0", false);
  scene.fixes.clear();
  FixDescription all = fix("all", Where());
  all.gradient = 0.03 * Matrix<3>::Identity();
  all.time_function = {TimeFunction::Sine{.frequency = 1, .amplitude = 1, .phase = -90, .offset = 1}};
  scene.fixes.push_back(all);
  scene.end_time = 1;
  scene.load_steps = 400;
  const Frame frame = converged_end_of(scene).frame();
  // One cycle of J from 1 to 1.06^3 and back, by the update rule at 400 points.
  double work = 0, J_n = 1, q_n = 0;
  std::vector<double> y(2, 0.0);
  double Y_n = 0;
  const std::vector<double> k = {0.2, 0.1}, tau = {0.1, 2};
  for (int i = 1; i <= 400; ++i) {
    const double stretch = 1 + 0.03 * (1 - std::cos(2 * std::numbers::pi * i / 400)),
                 J = std::pow(stretch, 3), Y = J * 2e6 * (J - 1);
    double q = 0.7 * Y;
    for (std::size_t b = 0; b < 2; ++b) {
      const double r = 1.0 / 400 / tau[b];
      y[b] = std::exp(-r) * y[b] - std::expm1(-r) / r * (Y - Y_n);
      q += k[b] * y[b];
    }
    work += 0.5 * (q / J + q_n / J_n) * (J - J_n);
    J_n = J;
    q_n = q;
    Y_n = Y;
  }
  EXPECT_GT(frame.dissipated_energy, 0);
  EXPECT_NEAR(frame.dissipated_energy + frame.elastic_energy, work, 1e-4 * work);
}

INSTANTIATE_TEST_SUITE_P(Formulations, BulkRelaxation,
                         ::testing::Values(ViscoelasticForm::simo, ViscoelasticForm::iso),
                         [](const auto& of) { return std::string(spelling(of.param)); });

TEST(ViscoelasticStrip, CreepsAndComesBackAsInAnotherCode) {
  const nlohmann::json reference = read_reference("visco_strip");
  for (const auto& row : reference["rows"]) {
    SCOPED_TRACE(row["element"].get<std::string>());
    Description scene = one_body(2, reference_mesh(reference["mesh"]), {});
    use_element(scene, row);
    scene.bodies[0].material = reference_rubber("nh_iso_j1", reference["constants"]);
    scene.bodies[0].material.viscoelastic = prony_of(reference["prony_g_tau"]);
    scene.end_time = 2;
    scene.load_steps = 20;
    scene.fixes.push_back(fix("fix", group("fix")));
    LoadDescription load;
    load.name = "load";
    load.kind = "traction";
    load.where = group("pull");
    load.value = {reference["traction_on_pull"][0], reference["traction_on_pull"][1], 0};
    load.time_function = table({0, 0.5, 1, 1.1}, {0, 1, 1, 0});
    scene.loads.push_back(load);
    Vector3 corner = Vector3::Zero();
    for (const Vector3& X : scene.bodies[0].mesh.vertices) corner = corner.cwiseMax(X);
    scene.probes.push_back(probe("corner", corner));
    Simulation simulation(scene);
    double time = 0;
    for (const auto& u : row["u_per_step"]) {
      step_to(simulation, time += 0.1);
      EXPECT_LT(relative_error(simulation.frame().probes[0].displacement, u), 1e-8);
    }
  }
}

/// A bushing between sleeves, a quarter of it in 3D and its half section: the inner sleeve moves along the
/// axis at once and stays.
Description relaxing_bushing(bool is_section, ViscoelasticForm formulation) {
  Description scene;
  scene.dimension = is_section ? 2 : 3;
  scene.end_time = 2;
  scene.load_steps = 8;
  BodyDescription body;
  body.element = is_section ? axisymmetric_name("Q1P0") : "Q1P0";
  body.mesh = is_section ? make_quadrilateral_rectangle({1, 1.5}, {4, 4})
                         : make_round({.kind = RoundKind::tube,
                                       .radius = 2,
                                       .inner_radius = 1,
                                       .height = 1.5,
                                       .degrees = 90,
                                       .radial_cells = 4,
                                       .around_cells = 16,
                                       .axial_cells = 4,
                                       .is_cut = false});
  if (is_section) body.translate = {1, 0, 0};
  body.material.law = "neo_hookean_isochoric";
  body.material.constants = {{"shear_modulus", 1e5}, {"bulk_modulus", 2e6}};
  body.material.viscoelastic = prony({0.3, 0.2}, {0.1, 1});
  body.material.viscoelastic->formulation = formulation;
  scene.bodies.push_back(std::move(body));
  scene.fixes = {fix("outer", is_section ? plane(0, 2) : group("outer")),
                 fix("inner", is_section ? plane(0, 1) : group("inner"))};
  scene.fixes[1].displacement[is_section ? 1 : 2] = 0.4;
  scene.fixes[1].time_function = table({0, 0.25}, {0, 1});
  if (!is_section) {
    for (const bool is_start : {true, false}) {
      FixDescription side = fix(is_start ? "start" : "end", plane(is_start ? 1 : 0, 0));
      side.components = {!is_start, is_start, false};
      scene.fixes.push_back(side);
    }
  }
  return scene;
}

TEST(Viscoelasticity, OfAHalfSectionIsThatOfTheSolid) {
  for (const ViscoelasticForm formulation :
       {ViscoelasticForm::simo, ViscoelasticForm::iso, ViscoelasticForm::whole}) {
    SCOPED_TRACE(spelling(formulation));
    Simulation solid(relaxing_bushing(false, formulation)), section(relaxing_bushing(true, formulation));
    double first = 0;
    for (const double time : {0.25, 2.0}) {
      step_to(solid, time);
      step_to(section, time);
      const double of_solid = 4 * reaction(solid.frame(), "inner", 2);
      const double force = reaction(section.frame(), "inner", 1);
      EXPECT_NEAR(force, of_solid, 5e-3 * force) << "a polygon of 64 sides is not the ring";
      const double heat = section.frame().dissipated_energy;
      EXPECT_NEAR(heat, 4 * solid.frame().dissipated_energy, 5e-3 * heat);
      if (first == 0)
        first = force;
      else
        EXPECT_LT(force, 0.8 * first);
    }
  }
}

// ---- any term with internal variables

/// A viscoelastic bar that falls into its weight.
Description creeping_bar(int dimension, bool is_dynamic, const std::string& element = "P1") {
  Description scene = small_bar(dimension, is_dynamic);
  scene.bodies[0].element = element;
  scene.bodies[0].material.law = "neo_hookean_simo";
  scene.bodies[0].material.viscoelastic = prony({0.3, 0.2, 0.1}, {0.01, 0.1, 1});
  scene.load_steps = 10;
  return scene;
}

TEST(Viscoelasticity, GoesOnFromACheckpointInTheSameBits) {
  expect_same_bits_after_a_checkpoint(creeping_bar(2, false), 4);
  Description bulk = creeping_bar(2, false, "P2P0");
  bulk.bodies[0].material.viscoelastic->k = {0, 0.2, 0.1};
  expect_same_bits_after_a_checkpoint(bulk, 4);
  expect_same_bits_after_a_checkpoint(relaxing_bushing(true, ViscoelasticForm::simo), 4);
  for (const std::string& integrator : integrator_names()) {
    Description scene = creeping_bar(3, true);
    scene.integrator = integrator;
    expect_same_bits_after_a_checkpoint(scene, 4);
    scene.adaptive.emplace();
    expect_same_bits_after_a_checkpoint(scene, 2);
  }
}

TEST(Viscoelasticity, GivesTheSameBitsForAnyNumberOfThreads) {
  const int threads_before = num_threads();
  std::string state;
  for (const int threads : {1, 2, 5}) {
    set_num_threads(threads);
    const std::string found = serialize(run_all(creeping_bar(3, true)).state());
    if (state.empty()) state = found;
    EXPECT_EQ(found, state);
  }
  set_num_threads(threads_before);
}

/// An undone step leaves no trace: a step that is cut in two by its observer begins with the same history.
TEST(Viscoelasticity, DoesNotAdvanceInAStepThatIsInterrupted) {
  for (const bool is_dynamic : {false, true}) {
    Simulation simulation(creeping_bar(2, is_dynamic));
    simulation.step();
    const VectorX history = simulation.state().history;
    EXPECT_GT(history.norm(), 0);
    EXPECT_EQ(simulation.step([](const NewtonReport&) { return false; }).status,
              StepReport::Status::interrupted);
    EXPECT_EQ(simulation.state().history, history);
  }
}

TEST(Viscoelasticity, ConvergesWithTheOrderOfEachIntegrator) {
  for (const std::string& integrator : integrator_names()) {
    SCOPED_TRACE(integrator);
    const auto tip = [&](double time_step) {
      Description scene = creeping_bar(2, true);
      scene.bodies[0].material.viscoelastic = prony({0.3, 0.2}, {0.05, 0.5});
      scene.integrator = integrator;
      scene.time_step = time_step;
      scene.newton.tolerance = 1e-11;
      return converged_end_of(scene).frame().probes[0].displacement.y();
    };
    const double coarse = tip(0.005), middle = tip(0.0025), fine = tip(0.00125);
    const double rate = std::log2(std::abs((coarse - middle) / (middle - fine)));
    EXPECT_GT(rate, make_integrator(integrator, "test")->order() == 1 ? 0.8 : 1.6);
  }
}

TEST(Viscoelasticity, KeepsTheEnergyThatItsBranchesTakeInTheBalance) {
  Description scene = creeping_bar(2, true);
  scene.integrator = "midpoint";
  scene.time_step = 0.001;
  scene.newton.tolerance = 1e-11;
  const Simulation start(scene);
  const Simulation end = converged_end_of(scene);
  const double lost = start.frame().total_energy() - end.frame().total_energy();
  EXPECT_GT(end.frame().dissipated_energy, 0);
  EXPECT_NEAR(end.frame().dissipated_energy, lost, 1e-3 * lost);
  EXPECT_EQ(end.state().guarded_steps, 0);
}

TEST(Viscoelasticity, OfLongTermModuliIsTheSameMaterial) {
  Description scene = creeping_bar(2, false, "P2P0");
  scene.bodies[0].material.constants = {{"shear_modulus", 4e4}, {"bulk_modulus", 2e6}};
  scene.bodies[0].material.viscoelastic = prony({0.3, 0.3}, {0.01, 1});
  scene.bodies[0].material.viscoelastic->k = {0, 0.2};
  const Simulation instantaneous = converged_end_of(scene);
  scene.bodies[0].material.constants["shear_modulus"] = 0.4 * 4e4;
  scene.bodies[0].material.constants["bulk_modulus"] = 0.8 * 2e6;
  scene.bodies[0].material.viscoelastic = prony({0.75, 0.75}, {0.01, 1});
  scene.bodies[0].material.viscoelastic->k = {0, 0.25};
  scene.bodies[0].material.viscoelastic->moduli = Moduli::long_term;
  const Simulation long_term = converged_end_of(scene);
  EXPECT_NEAR(long_term.frame().probes[0].displacement.y(), instantaneous.frame().probes[0].displacement.y(),
              1e-9);
}

TEST(Viscoelasticity, CreepsToTheEquilibriumOfItsLongTermModuli) {
  Description scene = creeping_bar(2, false);
  scene.bodies[0].material.constants = {{"shear_modulus", 4e4}, {"bulk_modulus", 2e5}};
  scene.bodies[0].material.viscoelastic = prony({0.5}, {0.01});
  scene.end_time = 100;
  const Vector3 crept = converged_end_of(scene).frame().probes[0].displacement;
  scene.bodies[0].material.viscoelastic.reset();
  scene.bodies[0].material.constants["shear_modulus"] = 2e4;
  const Vector3 elastic = converged_end_of(scene).frame().probes[0].displacement;
  EXPECT_LT((crept - elastic).norm(), 1e-3 * elastic.norm());
}

/// A long time after the load, a body whose whole stress relaxes is one with all moduli scaled.
TEST(Viscoelasticity, OfTheWholeStressTakesAnyLaw) {
  for (const std::string law : {"neo_hookean", "stable_neo_hookean", "corotated"}) {
    SCOPED_TRACE(law);
    Description scene = creeping_bar(2, false);
    scene.bodies[0].material.law = law;
    scene.bodies[0].material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.3}};
    scene.bodies[0].material.viscoelastic = prony({0.5}, {0.01});
    scene.bodies[0].material.viscoelastic->formulation = ViscoelasticForm::whole;
    scene.end_time = 100;
    const Vector3 crept = converged_end_of(scene).frame().probes[0].displacement;
    scene.bodies[0].material.viscoelastic.reset();
    scene.bodies[0].material.constants["youngs_modulus"] = 5e4;
    const Vector3 elastic = converged_end_of(scene).frame().probes[0].displacement;
    EXPECT_LT((crept - elastic).norm(), 1e-3 * elastic.norm());
  }
}

TEST(Viscoelasticity, DoesNotGoOnFromAStateOfOtherMaterials) {
  Description scene = creeping_bar(2, false);
  Simulation simulation(scene);
  scene.bodies[0].material.viscoelastic.reset();
  const Simulation elastic(scene);
  try {
    simulation.resume_from(elastic.state(), "checkpoint.bin");
    ADD_FAILURE() << "resumed";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("checkpoint.bin: expected a checkpoint with history of 768 internal "
                                        "variables, got 0, as of other materials"));
  }
}

TEST(Viscoelasticity, OfBadInputIsRefusedInOneLine) {
  const auto with = [](const ViscoelasticDescription& viscoelastic) {
    Description scene = creeping_bar(2, false);
    scene.bodies[0].material.viscoelastic = viscoelastic;
    return scene;
  };
  EXPECT_THAT(refusal_of(with(prony({0.5, 0.5}, {1, 2}))),
              HasSubstr("viscoelastic.g: expected shares that sum"));
  EXPECT_THAT(refusal_of(with(prony({0.5}, {0}))),
              HasSubstr("viscoelastic.tau[0]: expected a relaxation time"));
  EXPECT_THAT(refusal_of(with(prony({0.5, -0.1}, {1, 1}))),
              HasSubstr("viscoelastic.g[1]: expected a number"));
  EXPECT_THAT(refusal_of(with(prony({0.5}, {1, 2}))),
              HasSubstr("viscoelastic.tau: expected 1 relaxation time"));
  EXPECT_THAT(refusal_of(with(prony({}, {}))), HasSubstr("viscoelastic.g: expected a share"));
  ViscoelasticDescription both = prony({0.5}, {1});
  both.k = {0.5, 0.2};
  EXPECT_THAT(refusal_of(with(both)), HasSubstr("viscoelastic.g: expected 2 shares, one for each branch"));
  both.k = {1};
  EXPECT_THAT(refusal_of(with(both)), HasSubstr("viscoelastic.k: expected shares that sum"));
  both.k = {-0.1};
  EXPECT_THAT(refusal_of(with(both)), HasSubstr("viscoelastic.k[0]: expected a number >= 0"));
  both.k = {0.1};
  both.formulation = ViscoelasticForm::whole;
  EXPECT_THAT(refusal_of(with(both)), HasSubstr("viscoelastic.k: expected none"));
  Description scene = creeping_bar(2, false);
  scene.bodies[0].material.law = "neo_hookean";
  EXPECT_THAT(refusal_of(scene), HasSubstr("expected a law with an isochoric-volumetric split"));
  scene.bodies[0].material.law = "linear_elastic";
  scene.bodies[0].material.viscoelastic->formulation = ViscoelasticForm::whole;
  EXPECT_THAT(refusal_of(scene), HasSubstr("expected a law of finite strain"));
  scene = creeping_bar(2, false);
  scene.load_control = LoadControlKind::arc_length;
  EXPECT_THAT(refusal_of(scene), HasSubstr("arc_length"));
  scene = creeping_bar(2, false);
  scene.modes.emplace();
  EXPECT_THAT(refusal_of(scene), HasSubstr("modal analysis"));
  scene = creeping_bar(2, false);
  scene.sections.emplace_back();
  EXPECT_THAT(refusal_of(scene), HasSubstr("section of an elastic body"));
}

}  // namespace
}  // namespace resilin::testing
