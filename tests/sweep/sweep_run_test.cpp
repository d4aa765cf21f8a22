#include "resilin/sweep/sweep_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "resilin/core/parallel.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/results/saved_run.hpp"
#include "sweep_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

/// A sweep of so many stiffnesses, 1e5, 2e5 ...
std::string stiffnesses(int count) {
  std::string text = "quantities = [\"reaction.pulled.x\"]\n[parameters]\nbody.0.material.youngs_modulus = [";
  for (int i = 1; i <= count; ++i) text += std::to_string(i) + "e5, ";
  return text + "]\n";
}
const std::string twelve = stiffnesses(12);

struct SweepRunTest : ::testing::Test {
  SheetFolder folder;

  SweepProgress run(const std::string& text, SweepRunOptions options = {}, const std::string& out = "out") {
    const Sweep sweep = folder.sweep(text);
    SweepFolder made(folder / out, sweep);
    return run_sweep(made, options);
  }
  /// Rows of the table without the seconds, by their number.
  std::vector<nlohmann::json> rows(const std::string& out = "out") const {
    std::vector<nlohmann::json> rows;
    for (const auto& file : std::filesystem::directory_iterator(folder / out / "rows")) {
      std::ifstream stream(file.path());
      for (std::string line; std::getline(stream, line);) {
        rows.push_back(nlohmann::json::parse(line));
        rows.back().erase("seconds");
      }
    }
    std::ranges::sort(rows, {}, [](const nlohmann::json& row) { return row["scene"].get<int>(); });
    return rows;
  }
};

TEST_F(SweepRunTest, GivesWhatRunsOfTheScenesGive) {
  const SweepProgress end = run(twelve);
  EXPECT_EQ(end.count.done, 12u);
  EXPECT_EQ(end.run, 12u);
  const std::vector<nlohmann::json> all = rows();
  ASSERT_EQ(all.size(), 12u);
  for (int i = 0; i < 12; ++i) {
    const double modulus = 1e5 * (i + 1);
    EXPECT_NEAR(
        all[static_cast<std::size_t>(i)]["parameters"]["body.0.material.youngs_modulus"].get<double>(),
        modulus, 1e-12 * modulus);
    Description description = read_scene(folder / "sheet.toml").description;
    description.bodies[0].material.constants["youngs_modulus"] =
        all[static_cast<std::size_t>(i)]["parameters"]["body.0.material.youngs_modulus"].get<double>();
    Simulation simulation(std::move(description));
    while (!simulation.is_finished()) simulation.step();
    EXPECT_EQ(all[static_cast<std::size_t>(i)]["quantities"]["reaction.pulled.x"].get<double>(),
              simulation.frame().reactions[1].second[0]);
  }
}

TEST_F(SweepRunTest, GivesTheSameBitsHoweverManyAtOnce) {
  run(twelve, {.jobs = 1, .threads = 1}, "one");
  run(twelve, {.jobs = 4, .threads = 4}, "four");
  run(twelve, {.jobs = 2, .threads = 6}, "two");
  EXPECT_EQ(rows("one"), rows("four"));
  EXPECT_EQ(rows("one"), rows("two"));
}

TEST_F(SweepRunTest, LeavesTheNumberOfThreadsAsItWas) {
  const int before = num_threads();
  run(twelve, {.jobs = 3, .threads = 3});
  EXPECT_EQ(num_threads(), before);
}

TEST_F(SweepRunTest, NeverRunsASceneAgain) {
  run(twelve);
  EXPECT_EQ(run(twelve).run, 0u);
  EXPECT_EQ(rows().size(), 12u);
  // A changed sweep runs what is new.
  const Sweep more = folder.sweep(stiffnesses(13));
  SweepFolder made(folder / "out", more, true);
  const SweepProgress end = run_sweep(made, {});
  EXPECT_EQ(end.count.done, 13u);
  EXPECT_EQ(end.run, 1u);
}

TEST_F(SweepRunTest, RunsEqualScenesOnce) {
  const SweepProgress end = run("[parameters]\nbody.0.scale = [1, 2, 1, 1, 2]\n", {.jobs = 3});
  EXPECT_EQ(end.run, 2u);
  EXPECT_EQ(end.count.done, 5u);
  EXPECT_EQ(end.others, 0u);
}

TEST_F(SweepRunTest, KeepsFailedScenesWithTheirReasonAndRetriesThemWhenAsked) {
  const std::string text = "[parameters]\nbody.0.material.poissons_ratio = [0.3, 0.7, 0.4]\n";
  const SweepProgress end = run(text);
  EXPECT_EQ(end.count.done, 2u);
  EXPECT_EQ(end.count.failed, 1u);
  EXPECT_THAT(end.first_failure, HasSubstr("scene 1 (body.0.material.poissons_ratio = 0.7): refused: "));
  const std::vector<nlohmann::json> all = rows();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[1]["status"], "refused");
  EXPECT_THAT(all[1]["reason"].get<std::string>(), HasSubstr("poissons_ratio"));
  EXPECT_EQ(run(text).run, 0u);
  EXPECT_EQ(run(text, {.queue = {.retries_failed = true}}).run, 1u);
  EXPECT_EQ(rows().size(), 4u);
}

TEST_F(SweepRunTest, TellsWhatDidNotConverge) {
  // A load that has no equilibrium: the sheet is pushed through itself.
  const SweepProgress end = run("[parameters]\nfix.pulled.displacement = [[0.1, 0], [-1.5, 0]]\n");
  EXPECT_EQ(end.count.failed, 1u);
  EXPECT_THAT(end.first_failure, HasSubstr("not_converged: "));
}

TEST_F(SweepRunTest, ShardsDoTheirPartAndTogetherTheWhole) {
  for (std::uint64_t i = 1; i <= 3; ++i) {
    const SweepProgress end = run(twelve, {.queue = {.shard = {i, 3}}});
    EXPECT_EQ(end.count.scenes, 4u);
    EXPECT_EQ(end.run, 4u);
  }
  EXPECT_EQ(rows().size(), 12u);
  EXPECT_EQ(run(twelve).run, 0u);
}

TEST_F(SweepRunTest, TwoInOneFolderShareTheWork) {
  folder.write_sweep(twelve);
  std::array<SweepProgress, 2> ends;
  std::vector<std::thread> threads;
  for (SweepProgress& end : ends)
    threads.emplace_back([&, this] {
      const Sweep sweep = read_sweep(folder / "sweep.toml");
      SweepFolder made(folder / "out", sweep);
      end = run_sweep(made, {.jobs = 2, .threads = 2});
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(ends[0].run + ends[1].run, 12u);
  EXPECT_EQ(rows().size(), 12u);
}

TEST_F(SweepRunTest, StopsAndGoesOn) {
  int rows_before = 0;
  for (int i = 0; i < 100; ++i) {
    bool stops = false;
    const SweepProgress end =
        run(twelve, {.jobs = 1,
                     .is_stopped = [&] { return stops; },
                     .progress = [&](const SweepProgress& now) { stops = now.run > 0; }});
    rows_before += static_cast<int>(end.run);
    if (!end.is_stopped && end.count.left() == 0) break;
  }
  EXPECT_EQ(rows_before, 12);
  EXPECT_EQ(rows().size(), 12u);
}

TEST_F(SweepRunTest, KeepsTheResultsThatAreAskedFor) {
  folder.write("sheet.toml", pulled_sheet + "[output]\nformats = [\"vtu\"]\n");
  const std::string parameters = "[parameters]\nbody.0.material.poissons_ratio = [0.3, 0.7, 0.4]\n";
  run("keep = [2]\n" + parameters);
  const Sweep sweep = folder.sweep(parameters);
  const auto is_kept = [&](std::uint64_t i) {
    return saved_world(kept_path(folder / "out", sweep.hash(i))) != nullptr;
  };
  EXPECT_FALSE(is_kept(0));
  EXPECT_TRUE(is_kept(2));
  EXPECT_EQ(run("keep = \"all\"\n" + parameters).run, 1u);  // one of the others is refused and stays so
  EXPECT_TRUE(is_kept(0));
  for (const auto& entry : std::filesystem::directory_iterator(folder / "out" / "kept"))
    EXPECT_EQ(entry.path().extension(), "") << entry.path();
}

TEST_F(SweepRunTest, TellsWhenItsFilesChangeWhileItRuns) {
  folder.write("ratio.csv", "0.3\n0.3\n");
  const Sweep sweep = folder.sweep(
      "[parameters]\nbody.0.material.poissons_ratio = [{ file = \"ratio.csv\" }]\nbody.0.scale = [1, 2]\n");
  const std::string error = error_of([&] {
    run_scene(sweep, 0, {}, [&] {
      folder.write("ratio.csv", "0.25\n0.3\n");
      return false;
    });
  });
  EXPECT_THAT(error, HasSubstr("one that has changed during scene 0"));
}

}  // namespace
}  // namespace resilin::testing
