#include <gtest/gtest.h>

#include <mutex>
#include <random>

#include "resilin/simulation/frame.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/simulation/step.hpp"
#include "small_scenes.hpp"
#include "thread_exchange.hpp"

namespace resilin::testing {
namespace {

constexpr int num_ranks = 3;

LoadDescription load_of(const std::string& kind) {
  LoadDescription load;
  load.name = load.kind = kind;
  load.body = "body";
  load.value = {0, 20, 10};
  load.pressure = 40;
  load.stiffness = 30;
  load.where.kind = Where::Kind::plane;
  load.where.axis = 1;
  load.where.at = 0.25;
  if (kind == "body_force") load.where.kind = Where::Kind::all;
  return load;
}

/// A bar with a block behind it that never meets it, under every kind of load, above a collider.
Description crowded_scene(const std::string& element, MassKind mass) {
  Description scene = small_bar(3, /*is_dynamic=*/true);
  scene.bodies[0].element = element;
  scene.bodies[0].mass = mass;
  scene.bodies[0].damping.stiffness = 1e-3;
  BodyDescription block = scene.bodies[0];
  block.name = "block";
  block.mesh = make_box({0.3, 0.25, 0.25}, {2, 2, 2});
  block.translate = {0, 3, 0};
  RegionDescription core;
  core.name = "core";
  core.where.kind = Where::Kind::box;
  core.where.min = {0.1, 3.05, 0};
  core.where.max = {0.3, 3.25, 0.2};
  core.material.constants["youngs_modulus"] = 3e5;
  core.material.density = 2000;
  block.regions.push_back(core);
  scene.bodies.push_back(block);
  scene.fixes[0].body = "body";
  scene.probes[0].body = "body";
  scene.contact.is_enabled = false;
  for (const char* kind : {"body_force", "traction", "pressure", "nodal_force", "spring"})
    scene.loads.push_back(load_of(kind));
  ColliderDescription floor;
  floor.name = "floor";
  floor.shape.point = {0, 0, -0.02};
  floor.shape.normal = {0, 0, 1};
  floor.activation_distance = 0.05;
  scene.colliders.push_back(floor);
  return scene;
}

std::vector<std::vector<std::int32_t>> cells_at_random(const World& world) {
  std::mt19937 random(7);
  std::vector<std::vector<std::int32_t>> ranks;
  for (const Body& body : world.bodies) {
    std::vector<std::int32_t>& own = ranks.emplace_back();
    for (Index cell = 0; cell < body.num_cells(); ++cell)
      own.push_back(static_cast<std::int32_t>(random() % num_ranks));
  }
  return ranks;
}

/// A place near rest, known by the node's number in the whole scene.
VectorX bent(const World& world, double size) {
  VectorX x = world.rest_positions;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const auto number =
        world.share.number_of(static_cast<Index>(i / world.dimension)) * world.dimension + i % 3;
    x[i] += size * std::sin(12.9898 * static_cast<double>(number));
  }
  return x;
}

struct EveryElementInParts : ::testing::TestWithParam<const char*> {};

/// Relative: what sums in another order leave.
constexpr double summing_error = 1e-12;

TEST_P(EveryElementInParts, HasTheEnergiesForcesAndVerdictsOfTheWhole) {
  for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
    const World whole(crowded_scene(GetParam(), mass));
    State state;
    state.positions = bent(whole, 1e-3);
    state.velocities = bent(whole, 1.0) - whole.rest_positions;
    state.load = 1;
    const Conditions conditions{.time = 0.1, .load = 1};
    const auto stage_of_state = [](const World& world, const State& at) {
      return Stage{.base_positions = world.rest_positions,
                   .base_velocities = at.velocities,
                   .duration = 0.01,
                   .shape = world.rest_positions};
    };
    const Potential potential = Potential::in_stage(whole, state, conditions, stage_of_state(whole, state));
    VectorX gradient, magnitude;
    potential.gradient(state.positions, gradient);
    potential.gradient_magnitude(state.positions, magnitude);
    const ConnectedComponents parts(*whole.pattern);
    ASSERT_EQ(parts.count(), 2);
    const VectorX scales = potential.force_scales(state.positions, gradient, parts);
    const Frame frame = measure_frame(whole, state, &gradient);
    const double size = gradient.cwiseAbs().maxCoeff();

    std::mutex mutex;
    on_parts(whole, cells_at_random(whole), num_ranks, [&](const World& world) {
      State own;
      own.positions = bent(world, 1e-3);
      own.velocities = bent(world, 1.0) - world.rest_positions;
      own.load = 1;
      const Potential share = Potential::in_stage(world, own, conditions, stage_of_state(world, own));
      VectorX forces, sizes;
      share.gradient(own.positions, forces);
      share.gradient_magnitude(own.positions, sizes);
      const ConnectedComponents own_parts(*world.pattern, world.share);
      const VectorX own_scales = share.force_scales(own.positions, forces, own_parts);
      const double energy = share.difference(world.rest_positions, own.positions);
      const double norm = world.share.norm(forces);
      const bool has_potential = share.has_potential(own.positions);
      const double extent = world.largest_extent();
      const Frame measured = measure_frame(world, own, &forces);

      const std::lock_guard lock(mutex);
      for (Eigen::Index i = 0; i < forces.size(); ++i) {
        const Eigen::Index of_whole =
            Eigen::Index{world.share.number_of(static_cast<Index>(i / 3))} * 3 + i % 3;
        ASSERT_NEAR(forces[i], gradient[of_whole], summing_error * size);
        ASSERT_NEAR(sizes[i], magnitude[of_whole], summing_error * magnitude.maxCoeff());
        ASSERT_EQ(world.is_fixed[static_cast<std::size_t>(i)],
                  whole.is_fixed[static_cast<std::size_t>(of_whole)]);
      }
      EXPECT_NEAR(energy, potential.difference(whole.rest_positions, state.positions),
                  summing_error * std::abs(energy));
      EXPECT_NEAR(norm, gradient.norm(), summing_error * norm);
      EXPECT_EQ(has_potential, potential.has_potential(state.positions));
      EXPECT_EQ(extent, whole.largest_extent());
      ASSERT_EQ(own_parts.count(), 2);
      for (Index part = 0; part < 2; ++part)
        EXPECT_NEAR(own_scales[part], scales[part], summing_error * scales[part]);
      EXPECT_NEAR(measured.kinetic_energy, frame.kinetic_energy, summing_error * frame.kinetic_energy);
      EXPECT_NEAR(measured.elastic_energy, frame.elastic_energy, summing_error * frame.elastic_energy);
      ASSERT_EQ(measured.regions.size(), 2U);
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_GT(frame.regions[i].elastic_energy, 0);
        EXPECT_NEAR(measured.regions[i].elastic_energy, frame.regions[i].elastic_energy,
                    summing_error * frame.elastic_energy);
      }
      EXPECT_NEAR(measured.contact_energy, frame.contact_energy,
                  summing_error * std::abs(frame.contact_energy));
      EXPECT_GT(frame.contact_energy, 0);
      EXPECT_NEAR(measured.min_volume_ratio, frame.min_volume_ratio, summing_error);
      EXPECT_EQ(measured.worst_cell, frame.worst_cell);
      EXPECT_EQ(measured.worst_body, frame.worst_body);
      EXPECT_EQ(measured.probes.at(0).displacement, frame.probes.at(0).displacement);
      for (std::size_t i = 0; i < frame.reactions.size(); ++i)
        EXPECT_LT((measured.reactions[i].second - frame.reactions[i].second).norm(), 1e-10 * size) << i;
    });
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryElementInParts, ::testing::Values("P1", "P2", "P2P0"),
                         [](const auto& element) { return std::string(element.param); });

TEST(ASceneInParts, OwnsEveryNodeOnce) {
  const World whole(crowded_scene("P2", MassKind::lumped));
  std::mutex mutex;
  std::vector<int> owners(static_cast<std::size_t>(whole.num_nodes()), 0);
  on_parts(whole, cells_at_random(whole), num_ranks, [&](const World& world) {
    const std::lock_guard lock(mutex);
    for (Index node = 0; node < world.num_nodes(); ++node)
      if (world.share.owns(node)) ++owners[static_cast<std::size_t>(world.share.number_of(node))];
  });
  EXPECT_EQ(owners, std::vector<int>(owners.size(), 1));
}

TEST(ASceneInParts, IsRefusedWhereOneProcessAloneCanRunIt) {
  Description scene = crowded_scene("P1", MassKind::lumped);
  scene.contact.is_enabled = true;
  const World whole(scene);
  EXPECT_THROW(require_distributable(whole), InputError);
}

}  // namespace
}  // namespace resilin::testing
