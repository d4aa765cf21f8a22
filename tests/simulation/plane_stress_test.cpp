// A membrane with a hole in plane stress, against two codes that are not ours (tests/reference).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reference_case.hpp"
#include "resilin/material/plane_stress.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

FixDescription roller(const std::string& group_name, int axis) {
  FixDescription description = fix(group_name, group(group_name));
  description.components = {axis == 0, axis == 1, false};
  return description;
}

MaterialDescription sheet_material(const nlohmann::json& result) {
  const nlohmann::json& constants = result["constants"];
  MaterialDescription material;
  if (result["law"] == "nh_log") {
    material.law = plane_stress_name("neo_hookean");
    material.constants = {{"shear_modulus", constants["mu"]}, {"lame_lambda", constants["lam"]}};
  } else {
    material.law = plane_stress_name("mooney_rivlin");
    material.constants = {
        {"c10", constants["c10"]}, {"c01", constants["c01"]}, {"bulk_modulus", constants["kappa"]}};
  }
  return material;
}

TEST(PlaneStressReference, StretchesAMembraneWithAHole) {
  const nlohmann::json membrane = read_reference("plane_stress")["cases"]["membrane_hole"];
  int num_rows = 0;
  for (const auto& result : membrane["results"])
    for (const auto& row : result["rows"]) {
      SCOPED_TRACE(result["law"].dump() + " " + row["element"].dump() + " " + row["quadrature"].dump());
      Description description = one_body(2, reference_mesh(membrane["mesh"]), {});
      description.bodies[0].material = sheet_material(result);
      use_element(description, row);
      description.fixes = {roller("x0", 0), roller("y0", 1)};
      LoadDescription traction;
      traction.kind = "traction";
      traction.where = group("top");
      traction.value = {membrane["traction"][0], membrane["traction"][1], 0};
      description.loads.push_back(traction);
      const auto& values = row["values"];
      const std::vector<std::string> places = {"hole_x", "hole_y", "corner"};
      for (const std::string& place : places)
        description.probes.push_back(
            probe(place, {membrane["probes"][place][0], membrane["probes"][place][1], 0}));
      Simulation simulation(description);
      const Frame frame = run_to_end(simulation);
      for (std::size_t i = 0; i < places.size(); ++i)
        EXPECT_LT(relative_error(frame.probes[i].displacement, values["u_" + places[i]]), 1e-9) << places[i];
      EXPECT_NEAR(frame.elastic_energy, values["energy"], 1e-9 * values["energy"].get<double>());
      EXPECT_NEAR(frame.reactions[1].second.y(), values["reactions"]["y0"][1],
                  1e-8 * std::abs(values["reactions"]["y0"][1].get<double>()));
      ++num_rows;
      if (row["element"] != "P1") continue;
      const ElasticEnergy& elastic = *simulation.world().bodies[0].domains.front().energy;
      const auto gradients = elastic.deformation_gradients(simulation.state().positions);
      const auto stresses = elastic.cauchy_stresses(simulation.state().positions);
      for (std::size_t i = 0; i < membrane["stress_cells"].size(); ++i) {
        const auto cell = membrane["stress_cells"][i].get<std::size_t>();
        EXPECT_NEAR(gradients[cell](2, 2), values["thickness"][i], 1e-9);
        const Matrix<3>& stress = stresses[cell];
        const double size = stress.norm();
        EXPECT_NEAR(stress(0, 0), values["stress"][i][0], 1e-8 * size);
        EXPECT_NEAR(stress(1, 1), values["stress"][i][1], 1e-8 * size);
        EXPECT_NEAR(stress(2, 2), 0, 1e-10 * size);
        EXPECT_NEAR(stress(0, 1), values["stress"][i][3], 1e-8 * size);
      }
      const auto volume_ratio = elastic.volume_ratios(simulation.state().positions);
      EXPECT_NEAR(volume_ratio[0], gradients[0].determinant(), 1e-12);
    }
  EXPECT_EQ(num_rows, 6);
}

TEST(PlaneStress, RefusesWhatItHasNot) {
  const auto refusal = [](const auto& change) -> std::string {
    Description scene = small_bar(2, false);
    scene.bodies[0].material.law = plane_stress_name("neo_hookean");
    change(scene);
    return refusal_of(scene);
  };
  EXPECT_EQ(refusal([](Description&) {}), "");
  EXPECT_THAT(refusal([](Description& d) { d.bodies[0].element = "P2P0"; }),
              HasSubstr("since plane stress has no volumetric locking, got \"P2P0\"; use P2"));
  EXPECT_THAT(refusal([](Description& d) {
                d.bodies[0].material.law = plane_stress_name("holzapfel_gasser_ogden");
                d.bodies[0].material.constants["fibre_modulus"] = 1e4;
                d.bodies[0].material.constants["fibre_stiffening"] = 1;
                d.bodies[0].material.fibres = {{{0.6, 0, 0.8}}};
              }),
              HasSubstr("expected a direction in the plane, in plane stress"));
}

}  // namespace
}  // namespace resilin::testing
