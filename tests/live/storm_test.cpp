#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "playground.hpp"
#include "resilin/io/mesh_file.hpp"
#include "shared_data.hpp"

namespace resilin::test {
namespace {

/// What came of a storm.
struct Aftermath {
  int grabs = 0;
  int frames = 0;
  int worst_inverted = 0;          ///< cells turned inside out at any time
  int inverted_after_release = 0;  ///< most of them 20 frames after a release
  double largest_distance = 0;     ///< to rest, over all nodes [m]
  bool all_finite = true;
};

/// Grabs by chance, pulls of up to ten body lengths, changes of stiffness, time step and Poisson's ratio, one
/// Newton step for each frame.
double env(const char* name, double fallback) {
  const char* v = std::getenv(name);
  return v ? std::atof(v) : fallback;
}
Aftermath storm(LiveScene& scene, int grabs, std::uint64_t seed) {
  Chance chance(seed);
  Aftermath after;
  const World& world = scene.world();
  const double length = world.largest_extent();
  const LiveControls calm = scene.controls();
  const int limit = static_cast<int>(env("LIMIT", 1));
  const double fmax = env("FMAX", 20), erange = env("ER", 100), dtmin = env("DTMIN", 1e-4);
  int bad = 0, bad_total = 0;
  const auto frame = [&] {
    const LiveReport& report = scene.step();
    ++after.frames;
    after.worst_inverted = std::max(after.worst_inverted, static_cast<int>(report.inverted_cells));
    after.all_finite &= scene.state().positions.allFinite() && scene.state().velocities.allFinite();
    after.largest_distance = std::max(after.largest_distance,
                                      (scene.state().positions - world.rest_positions).cwiseAbs().maxCoeff());
  };
  for (; after.grabs < grabs && after.all_finite; ++after.grabs) {
    LiveControls controls = scene.controls();
    controls.newton_limit = limit;
    if (chance.happens(0.3))
      controls.youngs_modulus = chance.between_in_ratio(1 / erange, erange) * calm.youngs_modulus;
    if (chance.happens(0.3)) controls.poissons_ratio = chance.between(0, 0.49);
    if (chance.happens(0.5)) controls.time_step = chance.between_in_ratio(dtmin, 0.1);
    controls.max_force = env("SCALE", 1) * controls.youngs_modulus / calm.youngs_modulus * calm.max_force *
                         chance.between_in_ratio(0.1, fmax);
    scene.set_controls(controls);
    const Index node = chance.below(world.num_nodes());
    const Vector3 start = at_node(node).position(3, scene.state().positions);
    const Vector3 pull = 10 * length * chance.between(0, 1) * chance.direction();
    const int pull_frames = 1 + chance.below(10);
    scene.grab(at_node(node), start);
    for (int i = 1; i <= pull_frames; ++i) {
      scene.drag(start + static_cast<double>(i) / pull_frames * pull);
      frame();
    }
    scene.release();
    const int before = static_cast<int>(scene.report().inverted_cells);
    for (int i = 0; i < 20; ++i) frame();
    bad_total += before > 0;
    if (scene.report().inverted_cells > 0) {
      ++bad;
      std::printf("dt %.2e E/E0 %.2e nu %.2f F %.2e frames %d inverted %d -> %d Jmin %g res %g\n",
                  controls.time_step, controls.youngs_modulus / calm.youngs_modulus, controls.poissons_ratio,
                  controls.max_force / calm.max_force, pull_frames, before,
                  (int)scene.report().inverted_cells, scene.report().min_volume_ratio,
                  scene.report().relative_residual);
    }
    after.inverted_after_release =
        std::max(after.inverted_after_release, static_cast<int>(scene.report().inverted_cells));
  }
  std::printf("bad %d of %d (of %d)\n", bad, bad_total, after.grabs);
  LiveControls controls = calm;
  controls.newton_limit = 1;
  controls.damping = 2;
  scene.set_controls(controls);
  for (int i = 0; i < 2000 && !scene.report().at_rest; ++i) frame();
  return after;
}

TEST(Storm, OfHardPullsLeavesTheBodyAtRest) {
  LiveScene scene(standing_block(3, 0));
  const Aftermath after = storm(scene, 2000, 1);
  std::printf("frames %d worst inverted %d after release %d farthest %g at rest %d words %s\n", after.frames,
              after.worst_inverted, after.inverted_after_release, after.largest_distance,
              scene.report().at_rest, scene.report().words.c_str());
  EXPECT_TRUE(after.all_finite);
  EXPECT_EQ(after.inverted_after_release, 0);
  EXPECT_TRUE(scene.report().at_rest) << scene.report().words;
  EXPECT_LT((scene.state().positions - scene.world().rest_positions).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace resilin::test
