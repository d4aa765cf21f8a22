// Several materials in one mesh, which share its vertices: [[body.region]].

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reference_case.hpp"
#include "resilin/core/error.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/integrator/integrator.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

Where box(const Vector3& min, const Vector3& max) {
  Where where;
  where.kind = Where::Kind::box;
  where.min = min;
  where.max = max;
  return where;
}

RegionDescription region(const std::string& name, const Where& where, const MaterialDescription& material) {
  RegionDescription region;
  region.place = "bar.toml: body[0].region[0]";
  region.name = name;
  region.where = where;
  region.material = material;
  return region;
}

/// The half of a small bar beyond x = 0.5.
Where far_half() { return box({0.5, -1, -1}, {2, 1, 1}); }

/// A bar whose far half is stiff, heavy and of another law.
Description bar_of_two(int dimension, bool is_dynamic) {
  Description scene = small_bar(dimension, is_dynamic);
  MaterialDescription stiff;
  stiff.law = "neo_hookean";
  stiff.constants = {{"youngs_modulus", 5e5}, {"poissons_ratio", 0.3}};
  stiff.density = 2000;
  scene.bodies[0].regions.push_back(region("stiff", far_half(), stiff));
  scene.newton.tolerance = 1e-11;
  return scene;
}

TEST(RegionsOfABody, OfItsOwnMaterialChangeNothing) {
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true})
      for (const std::string element : {"P1", "P2", "P2P0"}) {
        Description scene = small_bar(dimension, is_dynamic);
        scene.newton.tolerance = 1e-11;
        BodyDescription& body = scene.bodies[0];
        body.element = element;
        body.damping = {.mass = is_dynamic ? 1.0 : 0, .stiffness = is_dynamic ? 0.01 : 0};
        if (element == "P2P0") body.material.law = "neo_hookean_simo";
        const Simulation whole = run_all(scene);
        body.regions.push_back(region("far", far_half(), body.material));
        const Simulation parts = run_all(scene);
        const VectorX displacement = whole.state().positions - whole.world().rest_positions;
        EXPECT_LT((parts.state().positions - whole.state().positions).norm(), 1e-9 * displacement.norm())
            << dimension << ", " << is_dynamic << ", " << element;
        EXPECT_NEAR(parts.frame().elastic_energy, whole.frame().elastic_energy,
                    1e-9 * whole.frame().elastic_energy);
        EXPECT_NEAR(parts.world().bodies[0].mass, whole.world().bodies[0].mass, 1e-10);
      }
}

/// Springs in series: F L = E A u for each half of a slender bar that is free to contract.
TEST(RegionsOfABody, AreSpringsInSeries) {
  Description scene = small_bar(3, false);
  BodyDescription& body = scene.bodies[0];
  body.material.law = "linear_elastic";
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0}};
  MaterialDescription stiff = body.material;
  stiff.constants["youngs_modulus"] = 4e5;
  body.regions.push_back(region("stiff", far_half(), stiff));
  scene.gravity.setZero();
  LoadDescription pull;
  pull.kind = "traction";
  pull.where = plane(0, 1);
  pull.value = {100, 0, 0};
  scene.loads.push_back(pull);
  const Simulation simulation = run_all(scene);
  EXPECT_NEAR(simulation.frame().probes[0].displacement.x(), 100 * (0.5 / 1e5 + 0.5 / 4e5), 1e-12);

  // One stress in both, and strains in proportion to the moduli: fields take the material of each cell.
  FieldEvaluator fields(simulation.world());
  const std::vector<std::string> names = {"von_mises", "green_strain"};
  const std::vector<FieldValues> values = fields.evaluate(simulation.state(), names);
  const Body& of = simulation.world().bodies[0];
  for (Index cell = 0; cell < of.num_cells(); ++cell) {
    const auto c = static_cast<std::size_t>(cell);
    EXPECT_NEAR(values[0].values[c], 100, 1e-6);
    EXPECT_NEAR(values[1].values[9 * c], of.domains.of_cell(cell).region < 0 ? 1e-3 : 0.25e-3, 1e-5);
  }
}

TEST(RegionsOfABody, HaveTheirOwnMassWeightAndEnergy) {
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true}) {
      const Simulation simulation = run_all(bar_of_two(dimension, is_dynamic));
      const World& world = simulation.world();
      const double half = dimension == 3 ? 0.5 * 0.0625 : 0.5 * 0.25;
      EXPECT_NEAR(world.bodies[0].mass, half * (1000 + 2000), 1e-9);
      const Frame& frame = simulation.frame();
      ASSERT_EQ(frame.regions.size(), 2U);
      EXPECT_EQ(frame.regions[0].region, "");
      EXPECT_EQ(frame.regions[1].region, "stiff");
      EXPECT_NEAR(frame.regions[0].elastic_energy + frame.regions[1].elastic_energy, frame.elastic_energy,
                  1e-12 * frame.elastic_energy);
      if (is_dynamic) continue;
      const Vector3 reaction = frame.reactions[0].second;
      EXPECT_NEAR(reaction.norm(), 9.81 * half * 3000, 1e-6 * reaction.norm());
    }
}

/// Cells of a group of a mesh belong to it, not those that merely touch its vertices.
TEST(RegionsOfABody, AreGroupsOfCellsOrListsOfVertices) {
  Description scene = small_bar(2, false);
  BodyDescription& body = scene.bodies[0];
  Group middle{.name = "middle", .cells = {{8, 9, 10}}, .vertices = {}};
  for (const Index cell : middle.cells[0])
    for (const Index vertex : body.mesh.find_solid(2)->cell(cell)) middle.vertices.push_back(vertex);
  body.mesh.groups.push_back(middle);
  Where where;
  where.kind = Where::Kind::group;
  where.group = "middle";
  body.regions.push_back(region("by group", where, body.material));
  where.kind = Where::Kind::vertices;
  for (const Index vertex : body.mesh.find_solid(2)->cell(20)) where.vertices.push_back(vertex);
  body.regions.push_back(region("by vertices", where, body.material));
  const World world(scene);
  const Domains& domains = world.bodies[0].domains;
  ASSERT_EQ(domains.size(), 3U);
  EXPECT_EQ(*domains[1].numbers, (std::vector<Index>{8, 9, 10}));
  EXPECT_EQ(*domains[2].numbers, (std::vector<Index>{20}));
}

TEST(RegionsOfABody, GiveACellToTheFirstThatMeansIt) {
  Description scene = bar_of_two(2, false);
  Where all;
  scene.bodies[0].regions.push_back(region("rest", all, scene.bodies[0].material));
  const World world(scene);
  ASSERT_EQ(world.bodies[0].domains.size(), 2U) << "no cell is left for the body's own material";
  EXPECT_EQ(world.bodies[0].domains[0].name, "stiff");
  EXPECT_EQ(world.bodies[0].domains[1].name, "rest");
  EXPECT_EQ(world.bodies[0].domains[0].energy->num_cells(), world.bodies[0].domains[1].energy->num_cells());
}

TEST(RegionsOfABody, AreRefusedInOneLine) {
  const auto refusal = [](const auto& spoil) {
    Description scene = bar_of_two(2, false);
    spoil(scene.bodies[0]);
    return refusal_of(scene);
  };
  EXPECT_EQ(refusal([](BodyDescription& body) { body.regions[0].where = box({5, 5, 5}, {6, 6, 6}); }),
            "bar.toml: body[0].region[0].where: expected a region with at least one cell, got none; a cell "
            "belongs to it if its centroid does");
  EXPECT_EQ(
      refusal([](BodyDescription& body) {
        body.regions.push_back(region("again", far_half(), body.material));
        body.regions.back().place = "bar.toml: body[0].region[1]";
      }),
      "bar.toml: body[0].region[1].where: expected a region with at least one cell of its own, got cells "
      "that regions before it have, such as \"stiff\"; a cell belongs to the first region that contains it: "
      "put this one first");
  EXPECT_THAT(refusal([](BodyDescription& body) {
                body.regions.push_back(region("stiff", box({0, 0, 0}, {0.4, 1, 1}), body.material));
              }),
              HasSubstr("region[0].name: expected a name of its own for each region of a body, got \"stiff\" "
                        "twice"));
  EXPECT_THAT(refusal([](BodyDescription& body) {
                body.regions[0].where.kind = Where::Kind::group;
                body.regions[0].where.group = "boody";
              }),
              HasSubstr("region[0].where: expected a group of the mesh"));
  EXPECT_THAT(
      refusal([](BodyDescription& body) {
        body.regions[0].where.kind = Where::Kind::group;
        body.regions[0].where.group = "x_max";
      }),
      HasSubstr("region[0].where: expected a group of the body's cells, got \"x_max\", which has none of "
                "them"));
  EXPECT_THAT(refusal([](BodyDescription& body) {
                body.element = "P2P0";
                body.material.law = "neo_hookean_simo";
                body.regions[0].material.law = "saint_venant_kirchhoff";
              }),
              HasSubstr("the volumetric energy of saint_venant_kirchhoff is not separate"));
}

/// One element suits all materials: that of the one that is most nearly incompressible.
TEST(RegionsOfABody, ChooseOneElement) {
  Description scene = bar_of_two(2, false);
  BodyDescription& body = scene.bodies[0];
  body.element = "auto";
  body.material.law = "neo_hookean_simo";
  EXPECT_EQ(World(scene).bodies[0].element, "P2");
  body.regions[0].material.law = "neo_hookean_simo";
  body.regions[0].material.constants["poissons_ratio"] = 0.49;
  EXPECT_EQ(World(scene).bodies[0].element, "P2P0");
}

/// Lists by cell have an entry for each cell of the body.
TEST(RegionsOfABody, TakeTheirEntriesOfListsByCell) {
  Description scene = bar_of_two(2, false);
  BodyDescription& body = scene.bodies[0];
  const auto count = static_cast<std::size_t>(body.mesh.find_solid(2)->num_cells());
  MaterialDescription& material = body.regions[0].material;
  material.law = "stable_neo_hookean";
  material.constants = {{"poissons_ratio", 0.3}};
  for (std::size_t cell = 0; cell < count; ++cell)
    material.cell_constants["youngs_modulus"].push_back(1e5 + 1e3 * static_cast<double>(cell));
  const World world(scene);
  const Domain& domain = world.bodies[0].domains[1];
  for (Index cell = 0; cell < domain.energy->num_cells(); ++cell)
    EXPECT_NEAR(domain.energy->material(cell).constants[0], (1e5 + 1e3 * domain.number_of(cell)) / 2.6, 1e-6);
}

TEST(RegionsOfABody, AreTheSameInAnotherPlace) {
  Description scene = bar_of_two(3, false);
  const Simulation here = run_all(scene);
  const Vector3 by(1e5, 2e5, -3e5);
  scene.bodies[0].translate = by;
  scene.bodies[0].regions[0].where.min += by;
  scene.bodies[0].regions[0].where.max += by;
  scene.fixes[0].where.at += by.x();
  scene.probes[0].at += by;
  const Simulation there = run_all(scene);
  EXPECT_EQ(*there.world().bodies[0].domains[1].numbers, *here.world().bodies[0].domains[1].numbers);
  EXPECT_NEAR(there.frame().elastic_energy, here.frame().elastic_energy, 1e-6 * here.frame().elastic_energy);
}

// ---- against other codes (tests/reference/regions.json)

MaterialDescription reference_material(const nlohmann::json& region, double& rest_energy_density) {
  const std::string law = region["law"];
  const auto& constants = region["constants"];
  MaterialDescription material;
  material.density = region["density"];
  rest_energy_density = 0;
  if (law == "mooney_rivlin") {
    material.law = law;
    material.constants = {
        {"c10", constants["c10"]}, {"c01", constants["c01"]}, {"bulk_modulus", constants["kappa"]}};
    return material;
  }
  if (law == "hgo") {
    material.law = "holzapfel_gasser_ogden";
    material.constants = {{"shear_modulus", constants["mu"]},
                          {"bulk_modulus", constants["kappa"]},
                          {"fibre_modulus", constants["k1"]},
                          {"fibre_stiffening", constants["k2"]},
                          {"dispersion", constants["kd"]}};
    for (const auto& f : constants["fibres"]) material.fibres.push_back({Vector3(f[0], f[1], f[2])});
    return material;
  }
  const double mu = constants["mu"];
  const double lambda = constants.contains("lam") ? constants["lam"].get<double>()
                                                  : constants["kappa"].get<double>() - 2 * mu / 3;
  const ReferenceLaw known = reference_law(law, mu, lambda);
  material.law = known.law;
  material.constants = known.constants;
  rest_energy_density = known.rest_energy_density;
  return material;
}

Vector3 vector_of(const nlohmann::json& numbers) {
  Vector3 vector = Vector3::Zero();
  for (std::size_t k = 0; k < numbers.size(); ++k) vector[static_cast<Eigen::Index>(k)] = numbers[k];
  return vector;
}

struct RegionsReference : ::testing::TestWithParam<std::string> {};

TEST_P(RegionsReference, IsMet) {
  const nlohmann::json reference = read_reference("regions")["cases"][GetParam()];
  const int dimension = GetParam() == "2d" ? 2 : 3;
  for (const bool by_group : {false, true})
    for (const auto& row : reference["exact_mesh_values"]) {
      if (by_group && row["element"] != "P1") continue;
      // Codes differ by more where fibres are stretched in a part of a cell alone.
      if (row["second_code"]["worst_relative_difference"] > exact_mesh_tolerance) continue;
      SCOPED_TRACE(row.dump());
      Description scene = one_body(dimension, reference_mesh(reference["geometry"]["mesh"]), {});
      scene.load_steps = 4;
      BodyDescription& body = scene.bodies[0];
      use_element(scene, row);
      body.material = MaterialDescription();  // material of no cell
      std::vector<double> rest_energy_densities;
      for (const auto& of : reference["regions"]) {
        const MaterialDescription material = reference_material(of, rest_energy_densities.emplace_back());
        Where where = box(vector_of(of["where"]["box"][0]), vector_of(of["where"]["box"][1]));
        if (by_group) where = group(of["name"]);
        body.regions.push_back(region(of["name"], where, material));
      }
      scene.fixes.push_back(fix("fix", group("fix")));
      const auto& loads = reference["loads"][row["load_case"].get<std::string>()];
      scene.gravity = vector_of(loads["acceleration_of_gravity"]);
      LoadDescription pull;
      pull.kind = "traction";
      pull.where = group("pull");
      pull.value = vector_of(loads["traction_on_pull_per_reference_area"]);
      if (pull.value.norm() > 0) scene.loads.push_back(pull);
      std::vector<std::string> names;
      for (const auto& [name, at] : reference["probes"].items()) {
        names.push_back(name);
        scene.probes.push_back(probe(name, vector_of(at)));
      }
      Simulation simulation(scene);
      const Frame frame = run_to_end(simulation);
      const auto& values = row["values"];
      for (std::size_t i = 0; i < names.size(); ++i)
        EXPECT_LT(relative_error(frame.probes[i].displacement, values["u_" + names[i]]),
                  exact_mesh_tolerance);
      EXPECT_LT(relative_error(frame.reactions[0].second, values["reaction"]), exact_mesh_tolerance);
      const Domains& domains = simulation.world().bodies[0].domains;
      ASSERT_EQ(domains.size(), rest_energy_densities.size());
      double total = frame.total_energy();
      for (std::size_t d = 0; d < domains.size(); ++d) {
        const double at_rest = rest_energy_densities[d] * domains[d].energy->total_rest_volume();
        const double expected = values["energy_" + domains[d].name];
        EXPECT_NEAR(frame.regions[d].elastic_energy + at_rest, expected, exact_mesh_tolerance * expected);
        total += at_rest;
      }
      const double expected = values["total_potential"];
      EXPECT_NEAR(total, expected, exact_mesh_tolerance * std::abs(expected));
    }
}

INSTANTIATE_TEST_SUITE_P(All, RegionsReference, ::testing::Values("2d", "mixed", "fibre"),
                         [](const auto& entry) { return entry.param; });

}  // namespace
}  // namespace resilin::testing
