#include "resilin/results/moment.hpp"

#include <gtest/gtest.h>

#include "resilin/results/result_film.hpp"
#include "resilin/results/results.hpp"
#include "resilin/results/run.hpp"
#include "small_scenes.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

std::vector<std::string> words_of(const std::vector<double>& times, const std::vector<double>& loads) {
  const MomentsOfFrames moments(times, loads);
  std::vector<std::string> words;
  for (std::size_t i = 0; i < times.size(); ++i) words.push_back(moments.words(i));
  return words;
}

using Words = std::vector<std::string>;

TEST(MomentsOfFrames, HaveAsFewDigitsAsTellThemApart) {
  EXPECT_EQ(words_of({0, 0.1, 0.2}, {1, 1, 1}), (Words{"0.0 s", "0.1 s", "0.2 s"}));
  std::vector<double> sixtieths;
  for (int i = 0; i <= 60; ++i) sixtieths.push_back(i / 60.0);
  EXPECT_EQ(words_of(sixtieths, sixtieths)[1], "0.017 s");
  EXPECT_EQ(words_of(sixtieths, sixtieths)[60], "1.000 s");
  EXPECT_EQ(words_of({0, 1.0 / 60, 2.0 / 60, 0.05}, {1, 1, 1, 1}),
            (Words{"0 ms", "17 ms", "33 ms", "50 ms"}));
  EXPECT_EQ(words_of({0, 60, 120}, {1, 1, 1}), (Words{"0 s", "60 s", "120 s"}));
  EXPECT_EQ(words_of({0, 0.0005, 0.001}, {1, 1, 1}), (Words{"0.0 ms", "0.5 ms", "1.0 ms"}));
  EXPECT_EQ(words_of({0, 2e-6}, {1, 1}), (Words{"0 \xC2\xB5s", "2 \xC2\xB5s"}));
}

TEST(MomentsOfFrames, AreLoadFactorsWhereNoTimePasses) {
  EXPECT_EQ(words_of({0, 0, 0}, {0, 0.5, -1.0 / 3}), (Words{"load 0.000", "load 0.500",
                                                            "load \xE2\x88\x92"
                                                            "0.333"}));
  EXPECT_EQ(MomentsOfFrames({}, {}).words(0), "") << "a folder without a report";
}

TEST(WordsOfAMoment, AreThoseOfTheState) {
  const World moving(small_bar(3, true)), still(small_bar(3, false));
  State state;
  state.time = 1.25;
  EXPECT_EQ(words_of_moment(moving, state), "1.25 s");
  state.load = 0.5;
  EXPECT_EQ(words_of_moment(still, state), "load 0.5");
  state.load = 1;
  EXPECT_EQ(words_of_moment(still, state), "") << "where a run usually ends";
}

/// How many pixels of the corner are not those of the ground.
int ink_in_corner(const Image& image) {
  int count = 0;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 60; ++x) count += image.at(x, y) == Color{255, 255, 255} ? 0 : 1;
  return count;
}

TEST(AFilm, SaysItsTimeInTheCornerUnlessAskedNotTo) {
  const TemporaryFolder folder;
  Description scene = small_bar(3, true);
  scene.end_time = 0.1;
  Simulation simulation(scene);
  {
    ResultFolder results(folder / "out");
    results.record(simulation, false);
    const RunOutcome outcome = run_to_end(simulation, {});
    results.record(simulation, true);
    results.finish(simulation, outcome);
  }
  FilmOptions options;
  options.picture.width = 200;
  options.picture.height = 150;
  options.picture.field = "displacement";
  const FilmPlan plan = plan_film(folder / "out", options);
  ASSERT_EQ(plan.shots.size(), 2u);
  EXPECT_EQ(plan.shots[0].moment, "0.0 s");
  EXPECT_EQ(plan.shots[1].moment, "0.1 s");
  FilmPlan bare = plan;
  bare.picture.shows_caption = false;
  FilmPlan named = plan;
  named.picture.caption = "0.1 s";
  EXPECT_GT(ink_in_corner(draw_shot(plan, 1)), 40);
  EXPECT_EQ(ink_in_corner(draw_shot(bare, 1)), 0);
  EXPECT_EQ(draw_shot(named, 1).pixels, draw_shot(plan, 1).pixels);
  EXPECT_NE(draw_shot(named, 0).pixels, draw_shot(plan, 0).pixels) << "the words are those of the shot";
}

}  // namespace
}  // namespace resilin::testing
