#include "resilin/world/section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

SectionDescription cut(int axis, double at) {
  SectionDescription section;
  section.name = "at " + std::to_string(at);
  section.axis = axis;
  section.at = at;
  return section;
}

/// The bar with its vertices inside moved along x, so that planes cut through cells.
Description uneven_bar(int dimension) {
  Description scene = small_bar(dimension, false);
  for (Vector3& X : scene.bodies[0].mesh.vertices)
    if (X.x() > 0.01 && X.x() < 0.99) X.x() += 0.03 * std::sin(9 * X.x() + 30 * X.y() + 50 * X.z());
  return scene;
}

TEST(SectionForce, OfAHangingBarIsTheWeightBelow) {
  for (const int dim : {2, 3}) {
    Description scene = small_bar(dim, false);
    scene.gravity = {9.81, 0, 0};  // it hangs along x
    for (const double at : {0.25, 0.5, 0.875}) scene.sections.push_back(cut(0, at));
    const Simulation simulation = run_all(scene);
    const double weight = simulation.world().bodies[0].mass * 9.81;
    for (std::size_t i = 0; i < 3; ++i) {
      const SectionForce& section = simulation.frame().sections[i];
      // Planes between layers of cells; seen from x = 0, which is above: the other side pulls down.
      EXPECT_NEAR(section.force.x(), weight * (1 - scene.sections[i].at), 1e-6 * weight);  // Newton: 1e-8
      EXPECT_NEAR(section.force.y(), 0, 1e-6 * weight);
    }
  }
}

TEST(SectionForce, AndMomentBalanceTheSupportThroughAnyMesh) {
  for (const int dim : {2, 3}) {
    Description scene = uneven_bar(dim);
    scene.gravity = Vector3::Zero();
    FixDescription far = scene.fixes[0];
    far.name = "far";
    far.where.at = 1;
    far.rotate = Rotation{.axis = {0.4, 0, 1}, .center = {0.8, 0, 0}, .degrees = 40};
    if (dim == 2) far.rotate->axis = Vector3::UnitZ();
    scene.fixes.push_back(far);
    scene.newton.tolerance = 1e-11;
    for (const double at : {0.3, 0.55, 0.8}) scene.sections.push_back(cut(0, at));
    const Simulation simulation = run_all(scene);
    const Frame& frame = simulation.frame();
    const Vector3 reaction = frame.reactions[0].second;  // at x = 0, below every section
    for (const SectionForce& section : frame.sections) {
      EXPECT_LT((section.force + reaction).norm(), 1e-8 * reaction.norm());
      const Vector3 about_origin = section.moment + section.center.cross(section.force);
      EXPECT_LT((about_origin + frame.reaction_torques[0]).norm(), 1e-8 * frame.reaction_torques[0].norm());
    }
  }
}

TEST(SectionForce, CountsTheShareOfTheWeightThatBelongsToTheLowerCells) {
  Description scene = uneven_bar(3);
  scene.gravity = {9.81, 0, 0};
  scene.sections.push_back(cut(0, 0.5));
  scene.sections.push_back(cut(0, 0.5));
  scene.newton.tolerance = 1e-11;
  const Simulation simulation = run_all(scene);
  const Body& body = simulation.world().bodies[0];
  const std::vector<double> volumes = body.domains.front().energy->rest_volumes();
  double upper_mass = 0;
  for (std::size_t cell = 0; cell < volumes.size(); ++cell) {
    double x = 0;
    for (std::size_t a = 0; a < 4; ++a)
      x += 0.25 * simulation.world().rest_positions[3 * Eigen::Index{body.cells[4 * cell + a]}];
    if (x >= 0.5) upper_mass += body.domains.front().density * volumes[cell];
  }
  EXPECT_NEAR(simulation.frame().sections[0].force.x(), 9.81 * upper_mass, 1e-8 * 9.81 * upper_mass);
}

TEST(SectionForce, NeedsAPlaneThroughTheBody) {
  Description scene = small_bar(2, false);
  scene.sections.push_back(cut(1, 3));
  scene.sections[0].place = "beam.toml: section[0]";
  EXPECT_EQ(refusal_of(scene),
            "beam.toml: section[0].plane: expected a plane with cells on both sides, got y = 3; the body "
            "reaches from y = 0 to 0.25");
}

}  // namespace
}  // namespace resilin::testing
