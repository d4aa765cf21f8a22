// The thickness of plane scenes: forces, energies and masses are in proportion, displacements stay.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reference_case.hpp"
#include "resilin/fields/contact_traction.hpp"
#include "resilin/material/plane_stress.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

/// A bar under its weight and all loads per area or volume, on a ball and on another bar.
Description loaded_bar(double thickness, bool is_dynamic) {
  Description scene = small_bar(2, is_dynamic);
  scene.thickness = thickness;
  scene.newton.tolerance = 1e-10;
  BodyDescription other = scene.bodies[0];
  scene.bodies[0].name = "upper";
  other.name = "lower";
  other.translate = {0.5, -0.2525, 0};
  scene.bodies.push_back(other);
  scene.fixes[0].body = "upper";
  scene.probes[0].body = "upper";
  FixDescription ground = fix("ground", plane(1, -0.2525));
  ground.body = "lower";
  scene.fixes.push_back(ground);
  const auto add = [&](const char* kind, const Where& where, const Vector3& value, double pressure) {
    LoadDescription load;
    load.body = "upper";
    load.kind = kind;
    load.where = where;
    load.value = value;
    load.pressure = pressure;
    scene.loads.push_back(load);
  };
  add("traction", plane(1, 0.25), {10, -200, 0}, 0);
  add("pressure", plane(0, 1), {}, 300);
  add("body_force", {}, {0, -100, 0}, 0);
  add("force", plane(0, 1), Vector3(0, -20, 0) * thickness, 0);
  ColliderDescription ball;
  ball.name = "ball";
  ball.kind = "sphere";
  ball.shape.center = {0.3, -0.1 - 0.001, 0};
  ball.shape.radius = 0.1;
  scene.colliders.push_back(ball);
  scene.bodies[0].damping = {.mass = 0.1, .shear_viscosity = 10};
  scene.sections.push_back({.name = "cut", .body = "upper", .axis = 0, .at = 0.52});
  scene.end_time = 0.1;
  return scene;
}

TEST(Thickness, ForcesAndEnergiesAreInProportion) {
  constexpr double thickness = 0.003;
  for (const bool is_dynamic : {false, true})
    for (const bool is_plane_stress : {false, true}) {
      const auto run = [&](double of) {
        Description scene = loaded_bar(of, is_dynamic);
        if (is_plane_stress)
          for (BodyDescription& body : scene.bodies) {
            body.material.law = plane_stress_name("neo_hookean");
            body.damping.shear_viscosity = 0;
          }
        return converged_end_of(scene);
      };
      const Simulation unit = run(1), thin = run(thickness);
      const VectorX moved = unit.state().positions - unit.world().rest_positions;
      EXPECT_GT(moved.norm(), 0.01);
      EXPECT_LT((thin.state().positions - unit.state().positions).norm(), 1e-6 * moved.norm());
      const Frame a = unit.frame(), b = thin.frame();
      EXPECT_NEAR(b.elastic_energy, thickness * a.elastic_energy, 1e-6 * b.elastic_energy);
      EXPECT_NEAR(b.contact_energy, thickness * a.contact_energy, 1e-4 * b.contact_energy);
      EXPECT_NEAR(b.kinetic_energy, thickness * a.kinetic_energy, 1e-5 * b.kinetic_energy);
      ASSERT_EQ(a.reactions.size(), b.reactions.size());
      for (std::size_t i = 0; i < a.reactions.size(); ++i)
        EXPECT_LT((b.reactions[i].second - thickness * a.reactions[i].second).norm(),
                  1e-4 * thickness * a.reactions[i].second.norm())
            << a.reactions[i].first;
      ASSERT_EQ(a.contacts.size(), 1U);
      EXPECT_LT((b.contacts.at(0).force - thickness * a.contacts[0].force).norm(),
                1e-4 * b.contacts[0].force.norm());
      EXPECT_LT((b.sections[0].force - thickness * a.sections[0].force).norm(),
                1e-5 * b.sections[0].force.norm());
      const VectorX pressure = contact_pressure(unit.world(), unit.state());
      EXPECT_GT(pressure.norm(), 0);
      EXPECT_LT((contact_pressure(thin.world(), thin.state()) - pressure).norm(), 1e-4 * pressure.norm());
      EXPECT_NEAR(thin.world().mass->total(), thickness * unit.world().mass->total(), 1e-12);
    }
}

TEST(Thickness, RefusesWhatCannotBe) {
  const auto refusal = [](int dimension, double thickness) {
    Description scene = small_bar(dimension, false);
    scene.thickness = thickness;
    return refusal_of(scene);
  };
  EXPECT_EQ(refusal(2, 0.002), "");
  EXPECT_EQ(refusal(3, 1), "");
  EXPECT_THAT(refusal(2, 0), HasSubstr("simulation.thickness: expected a finite number > 0, got 0"));
  EXPECT_THAT(refusal(3, 0.1), HasSubstr("simulation.thickness: expected a scene in 2D"));
}

}  // namespace
}  // namespace resilin::testing
