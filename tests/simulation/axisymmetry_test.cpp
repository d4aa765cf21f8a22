// Axisymmetric solids against two codes that are not ours (tests/reference).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "reference_case.hpp"
#include "resilin/element/axisymmetric.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

FixDescription held(const std::string& group_name, std::array<bool, 3> components,
                    const Vector3& to = {0, 0, 0}) {
  FixDescription description = fix(group_name, group(group_name));
  description.components = components;
  description.displacement = to;
  return description;
}

MaterialDescription ring_material(const nlohmann::json& part) {
  const nlohmann::json& constants = part["constants"];
  MaterialDescription material;
  if (part["law"] == "nh_log") {
    material.law = "neo_hookean";
    material.constants = {{"shear_modulus", constants["mu"]}, {"lame_lambda", constants["lam"]}};
  } else {
    material.law = "neo_hookean_isochoric";
    material.constants = {{"shear_modulus", constants["mu"]}, {"bulk_modulus", constants["kappa"]}};
  }
  return material;
}

/// Whether a row is of a rule that the element has.
bool has_rule(const nlohmann::json& row) { return row["element"] != "P1" || row["quadrature"] == "1pt"; }

/// Runs the scene of a row and compares probes, energy, reactions and, at the centroid of linear elements,
/// stresses.
void compare(const nlohmann::json& test_case, const nlohmann::json& part, const nlohmann::json& row,
             const std::vector<FixDescription>& fixes, const std::vector<LoadDescription>& loads) {
  SCOPED_TRACE(part["law"].dump() + " " + row["element"].dump() + " " + row["quadrature"].dump());
  Description description = one_body(2, reference_mesh(test_case["mesh"]), {});
  description.bodies[0].material = ring_material(part);
  use_element(description, row);
  description.bodies[0].element = axisymmetric_name(description.bodies[0].element);
  description.fixes = fixes;
  description.loads = loads;
  const nlohmann::json& values = row["values"];
  for (const auto& [place, at] : test_case["probes"].items())
    description.probes.push_back(probe(place, {at[0], at[1], 0}));
  Simulation simulation(description);
  const Frame frame = run_to_end(simulation);
  const double tolerance = row["quadrature"] == "exact" ? 1e-6 : 1e-9;
  for (const auto& found : frame.probes)
    EXPECT_LT(relative_error(found.displacement, values["u_" + found.name]), tolerance) << found.name;
  EXPECT_NEAR(frame.elastic_energy, values["energy"], tolerance * values["energy"].get<double>());
  for (const auto& [name, force] : frame.reactions)
    if (values["reactions"].contains(name)) {
      const nlohmann::json& expected = values["reactions"][name];
      const double size = std::hypot(expected[0].get<double>(), expected[1].get<double>());
      EXPECT_NEAR(force.y(), expected[1], 10 * tolerance * size) << name;
      // The radial force at a node on the axis counts for one group here, for each group there.
      if (test_case["mesh"] != "meshes/axi_disc.msh") {
        EXPECT_NEAR(force.x(), expected[0], 10 * tolerance * size) << name;
      }
    }
  if (row["element"] != "P1") return;
  const ElasticEnergy& elastic = *simulation.world().bodies[0].domains.front().energy;
  const auto stresses = elastic.cauchy_stresses(simulation.state().positions);
  for (std::size_t i = 0; i < test_case["stress_cells"].size(); ++i) {
    const Matrix<3>& stress = stresses[test_case["stress_cells"][i].get<std::size_t>()];
    const nlohmann::json& expected = values["stress"][i];
    EXPECT_NEAR(stress(0, 0), expected[0], 1e-8 * stress.norm());
    EXPECT_NEAR(stress(1, 1), expected[1], 1e-8 * stress.norm());
    EXPECT_NEAR(stress(2, 2), expected[2], 1e-8 * stress.norm());
    EXPECT_NEAR(stress(0, 1), expected[3], 1e-8 * stress.norm());
  }
}

constexpr std::array<bool, 3> both = {true, true, false}, r_alone = {true, false, false},
                              z_alone = {false, true, false};

TEST(AxisymmetricReference, BushingIsMovedAlongAndAcross) {
  const nlohmann::json cases = read_reference("axisymmetric")["cases"];
  int num_rows = 0;
  for (const char* name : {"bushing_axial", "bushing_radial"})
    for (const char* kind : {"compressible", "nearly_incompressible"}) {
      if (!cases[name].contains(kind)) continue;
      const nlohmann::json& to = cases[name]["displacement_of_inner"];
      const Vector3 by(to.value("u_r", 0.0), to.value("u_z", 0.0), 0);
      for (const auto& row : cases[name][kind]["rows"]) {
        if (!has_rule(row)) continue;
        SCOPED_TRACE(name);
        compare(cases[name], cases[name][kind], row, {held("inner", both, by), held("outer", both)}, {});
        ++num_rows;
      }
    }
  EXPECT_EQ(num_rows, 9);
}

TEST(AxisymmetricReference, DiscIsPressedBetweenBondedPlates) {
  const nlohmann::json disc = read_reference("axisymmetric")["cases"]["disc_pressed"];
  int num_rows = 0;
  for (const char* kind : {"compressible", "nearly_incompressible"})
    for (const auto& row : disc[kind]["rows"]) {
      if (!has_rule(row)) continue;
      compare(disc, disc[kind], row,
              {held("mid", z_alone), held("axis", r_alone), held("plate", both, {0, -0.0008, 0})}, {});
      ++num_rows;
    }
  EXPECT_EQ(num_rows, 6);
}

TEST(AxisymmetricReference, PressureInflatesATubeAndASphere) {
  const nlohmann::json cases = read_reference("axisymmetric")["cases"];
  int num_rows = 0;
  for (const char* name : {"tube", "sphere"}) {
    const nlohmann::json& test_case = cases[name];
    LoadDescription pressure;
    pressure.kind = "pressure";
    pressure.where = group("inner");
    pressure.pressure = test_case["pressure"];
    const bool is_tube = std::string(name) == "tube";
    const std::vector<FixDescription> fixes =
        is_tube ? std::vector{held("bottom", z_alone), held("top", z_alone)}
                : std::vector{held("equator", z_alone)};  // the axis holds itself
    for (const auto& row : test_case["exact_mesh_values"]) {
      if (!has_rule(row)) continue;
      SCOPED_TRACE(name);
      compare(test_case, test_case, row, fixes, {pressure});
      ++num_rows;
    }
  }
  EXPECT_GE(num_rows, 4);
}

/// A ring of rectangular section, r from 1 to 2 m.
Description ring(const std::string& element = "P2") {
  Description scene = small_bar(2, false);
  scene.bodies[0].mesh = make_rectangle({1, 0.25}, {4, 2});
  scene.bodies[0].translate = {1, 0, 0};
  scene.bodies[0].element = axisymmetric_name(element);
  scene.fixes[0].where = plane(1, 0);
  scene.probes.clear();
  return scene;
}

TEST(Axisymmetry, VolumeMassAndWeightAreThoseOfTheRing) {
  Description scene = ring();
  scene.gravity = {0, -10, 0};
  Simulation simulation(scene);
  const double volume = std::numbers::pi * (4 - 1) * 0.25;
  EXPECT_NEAR(simulation.world().bodies[0].domains.total_rest_volume(), volume, 1e-12 * volume);
  EXPECT_NEAR(simulation.world().mass->total(), 1000 * volume, 1e-9 * volume);
  const Frame frame = run_to_end(simulation);
  EXPECT_NEAR(frame.reactions[0].second.y(), 10 * 1000 * volume, 1e-6 * volume);
}

TEST(Axisymmetry, ForceAndTractionAreTotalsOfTheTurn) {
  for (const char* kind : {"force", "traction"}) {
    Description scene = ring("P1");
    scene.gravity.setZero();
    LoadDescription load;
    load.kind = kind;
    load.where = plane(1, 0.25);
    load.value = {0, 7, 0};
    scene.loads.push_back(load);
    Simulation simulation(scene);
    const double area = std::numbers::pi * (4 - 1);
    EXPECT_NEAR(run_to_end(simulation).reactions[0].second.y(), std::string(kind) == "force" ? -7 : -7 * area,
                1e-6)
        << kind;
  }
}

TEST(Axisymmetry, ForcesAndHessiansAreDerivatives) {
  for (const char* element : {"P1", "P2", "P2P0", "Q1", "Q1P0"}) {
    Description scene = ring(element);
    scene.bodies[0].material.law = "neo_hookean_isochoric";
    if (element[0] == 'Q') {
      scene.bodies[0].mesh = make_quadrilateral_rectangle({1, 0.25}, {4, 2});
    }
    LoadDescription pressure;
    pressure.kind = "pressure";
    pressure.where = plane(0, 1);
    pressure.pressure = 1e4;
    scene.loads.push_back(pressure);
    const World world(scene);
    VectorX x = world.rest_positions;
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] += 0.01 * std::sin(3.0 * static_cast<double>(i));
    const Conditions conditions{.time = 0, .load = 1};
    VectorX w(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) w[i] = std::cos(2.0 * static_cast<double>(i));
    for (const auto& term : world.terms) {
      const double h = 1e-5;
      VectorX gradient = VectorX::Zero(x.size()), ahead = gradient, behind = gradient;
      term->add_gradient(x, conditions, gradient);
      term->add_gradient(x + h * w, conditions, ahead);
      term->add_gradient(x - h * w, conditions, behind);
      const double slope = term->difference(x - h * w, x + h * w, conditions) / (2 * h);
      EXPECT_NEAR(slope, gradient.dot(w), 1e-6 * gradient.norm() * w.norm())
          << element << " " << term->name();
      if (!term->properties().has_potential) continue;
      BlockMatrix hessian(2, world.pattern);
      term->add_hessian(x, conditions, Projection::none, hessian);
      VectorX product;
      multiply(hessian, w, product);
      EXPECT_LT((product - (ahead - behind) / (2 * h)).norm(), 1e-6 * product.norm() + 1e-9)
          << element << " " << term->name();
    }
  }
}

/// Without lateral contraction the speed of waves is sqrt(E / rho) = 10 m/s.
TEST(Axisymmetry, ARodVibratesAlongItsAxis) {
  for (const bool is_held : {true, false}) {
    Description scene = ring();
    scene.bodies[0].mesh = make_rectangle({0.05, 1}, {1, 10});
    scene.bodies[0].translate.setZero();
    scene.bodies[0].material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0}};
    scene.gravity.setZero();
    scene.modes = {.count = 2};
    if (!is_held) scene.fixes.clear();
    Simulation simulation(scene);
    run_to_end(simulation);
    ASSERT_EQ(simulation.modes().size(), 2U);
    if (is_held) {
      EXPECT_NEAR(simulation.modes()[0].frequency(), 10 / 4.0, 1e-2);
    } else {  // along the axis it moves as a whole
      EXPECT_TRUE(simulation.modes()[0].is_rigid);
      EXPECT_NEAR(simulation.modes()[1].frequency(), 10 / 2.0, 1e-2);
    }
  }
}

TEST(Axisymmetry, RefusesWhatItHasNot) {
  const auto refusal = [](const auto& change) -> std::string {
    Description scene = ring();
    change(scene);
    return refusal_of(scene);
  };
  EXPECT_EQ(refusal([](Description&) {}), "");
  EXPECT_THAT(refusal([](Description& d) { d.bodies[0].translate.x() = -0.5; }),
              HasSubstr("vertex 0: expected a radius r >= 0: the mesh crosses the axis, got -0.5"));
  EXPECT_THAT(refusal([](Description& d) { d.gravity = {1, 0, 0}; }), HasSubstr("gravity along the axis"));
  EXPECT_THAT(refusal([](Description& d) { d.fixes.clear(); }),
              HasSubstr("1 of 1 rigid-body motions are free in a static analysis: translation along y"));
  EXPECT_THAT(refusal([](Description& d) { d.sections.emplace_back(); }), HasSubstr("a section"));
}

}  // namespace
}  // namespace resilin::testing
