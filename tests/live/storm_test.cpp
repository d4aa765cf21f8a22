#include <gtest/gtest.h>

#include <algorithm>

#include "playground.hpp"
#include "shared_data.hpp"

namespace resilin::testing {
namespace {

/// Outcome of a storm.
struct Aftermath {
  int frames = 0;
  Index most_inverted = 0;  ///< cells turned inside out at any time
  bool is_finite = true;
};

class Storm {
 public:
  Storm(LiveScene& scene, std::uint64_t seed) : scene_(scene), chance_(seed), calm_(scene.controls()) {}

  /// Grabs by chance, pulls of up to ten body lengths, changes of stiffness, Poisson's ratio and time step,
  /// one Newton iteration for each frame; each grab is let go and left alone for 20 frames.
  Aftermath blow(int grabs) {
    for (int i = 0; i < grabs && after_.is_finite; ++i) {
      change_controls();
      pull();
      scene_.release();
      for (int frame = 0; frame < 20; ++frame) step();
    }
    return after_;
  }

  /// All controls as before, with air that damps; still one Newton iteration for each frame.
  void subside() {
    LiveControls controls = calm_;
    controls.newton_limit = 1;
    controls.damping = 2;
    scene_.set_controls(controls);
    for (int frame = 0; frame < 2000 && !scene_.report().at_rest; ++frame) step();
  }

 private:
  void change_controls() {
    LiveControls controls = scene_.controls();
    controls.newton_limit = 1;
    if (chance_.happens(0.3))
      controls.youngs_modulus = chance_.between_in_ratio(0.01, 100) * calm_.youngs_modulus;
    if (chance_.happens(0.3)) controls.poissons_ratio = chance_.between(0, 0.49);
    if (chance_.happens(0.5)) controls.time_step = chance_.between_in_ratio(1e-4, 0.1);
    const double strength = chance_.between_in_ratio(0.1, 5);
    controls.max_force = strength * controls.youngs_modulus / calm_.youngs_modulus * calm_.max_force;
    scene_.set_controls(controls);
  }

  void pull() {
    const World& world = scene_.world();
    const MaterialPoint place = at_node(chance_.below(world.num_nodes()));
    const Vector3 start = place.position(3, scene_.state().positions);
    const Vector3 way = 10 * world.largest_extent() * chance_.between(0, 1) * chance_.direction();
    const int frames = 1 + chance_.below(10);
    scene_.grab(place, start);
    for (int i = 1; i <= frames; ++i) {
      scene_.drag(start + static_cast<double>(i) / frames * way);
      step();
    }
  }

  void step() {
    const LiveReport& report = scene_.step(unhurried);
    ++after_.frames;
    after_.most_inverted = std::max(after_.most_inverted, report.inverted_cells);
    after_.is_finite &= scene_.state().positions.allFinite() && scene_.state().velocities.allFinite();
  }

  LiveScene& scene_;
  Chance chance_;
  LiveControls calm_;
  Aftermath after_;
};

void comes_back_from_a_storm(LiveScene& scene, int grabs, std::uint64_t seed) {
  const double extent = scene.world().largest_extent();
  Storm storm(scene, seed);
  const Aftermath after = storm.blow(grabs);
  EXPECT_TRUE(after.is_finite);
  EXPECT_EQ(after.most_inverted, 0);
  storm.subside();
  EXPECT_TRUE(scene.report().at_rest) << scene.report().words;
  EXPECT_LT((scene.state().positions - scene.world().rest_positions).cwiseAbs().maxCoeff(), 1e-6 * extent);
}

/// Ten storms of a thousand grabs.
class StormOfGrabs : public ::testing::TestWithParam<int> {};

TEST_P(StormOfGrabs, LeavesABlockAtRest) {
  LiveScene scene(standing_block(2, 0));
  comes_back_from_a_storm(scene, 1000, static_cast<std::uint64_t>(GetParam()));
}
INSTANTIATE_TEST_SUITE_P(Seeds, StormOfGrabs, ::testing::Range(1, 11), ::testing::PrintToStringParamName());

TEST(Storm, LeavesTheArmadilloAtRest) {
  RESILIN_NEEDS_SHARED_DATA();
  LiveScene scene(armadillo(*shared_folder() / "meshes" / "armadillo_coarse.node"));
  comes_back_from_a_storm(scene, 300, 7);
}

}  // namespace
}  // namespace resilin::testing
