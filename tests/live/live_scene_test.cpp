#include "resilin/live/live_scene.hpp"

#include <gtest/gtest.h>

#include "playground.hpp"

namespace resilin::test {
namespace {

TEST(LiveScene, GoesOnToTheExactEquilibriumAndSaysSo) {
  LiveScene scene(standing_block(2));
  int steps = 0;
  while (!scene.report().at_rest && steps < 2000) {
    scene.step();
    ++steps;
  }
  EXPECT_TRUE(scene.report().at_rest) << scene.report().words;
  EXPECT_LT(scene.report().relative_residual, 1e-8);
  EXPECT_NE(scene.report().words.find("exact equilibrium"), std::string::npos);
  std::printf("steps %d %s\n", steps, scene.report().words.c_str());
}

}  // namespace
}  // namespace resilin::test
