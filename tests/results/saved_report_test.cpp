// Reports that were damaged: an answer in one line, never an exception of the JSON library.

#include "resilin/results/saved_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "resilin/core/error.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/results/results.hpp"
#include "resilin/results/run.hpp"
#include "small_scenes.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

std::string refusal(const std::filesystem::path& path) {
  try {
    read_report(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SavedReport, OfARunThatAnErrorEndedSaysSo) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "report.json";
  const auto text_with = [](RunStatus status, std::string_view reason) {
    return report_text({{"status", name(status)},
                        {"reason", reason},
                        {"frames", Json::array({{{"step", 0}, {"load", 1}}})}});
  };
  write_text(path, text_with(RunStatus::running, running_reason));
  mark_as_failed(path);
  const Json report = Json::parse(read_file(path));
  EXPECT_EQ(report["status"], "failed");
  EXPECT_THAT(report["reason"].get<std::string>(), HasSubstr("an error ended the run"));
  EXPECT_EQ(report["frames"].size(), 1U);
  const std::string done = text_with(RunStatus::done, "reached the end");
  write_text(path, done);
  mark_as_failed(path);
  EXPECT_EQ(read_file(path), done);
  mark_as_failed(folder.path() / "none.json");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "none.json"));
}

TEST(SavedReport, ThatIsNoneIsRefusedInOneLine) {
  const TemporaryFolder folder;
  const std::string frames = R"({"frames": )";
  const std::vector<std::string> texts = {
      "",
      "{",
      "[]",
      "17",
      "null",
      "\"frames\"",
      "{}",
      "\xff\xfe",
      "{\"frames\": 1}",
      "{\"frames\": {}}",
      frames + "[1]}",
      frames + "[{}]}",
      frames + "[null]}",
      frames + R"([{"step": "0", "time": 0, "load": 1}]})",
      frames + R"([{"step": 0, "time": null, "load": 1}]})",
      frames + R"([{"step": 0, "time": 0}]})",
      frames + R"([{"step": 0.5, "time": 0, "load": 1}]})",
      frames + R"([{"step": -1, "time": 0, "load": 1}]})",
      frames + R"([{"step": 1e300, "time": 0, "load": 1}]})",
      frames + R"([{"step": 99999999999999999999, "time": 0, "load": 1}]})",
      frames + R"([{"step": 3, "time": 0, "load": 1}, {"step": 3, "time": 0, "load": 1}]})",
      frames + R"([{"step": 0, "time": 1e999, "load": 1}]})",
      frames + R"([{"step": 0, "time": 0, "load": 1, "mode": 7}]})",
      frames + std::string(100000, '[') + std::string(100000, ']') + "}",
      frames + std::string(1000000, '['),
      frames + R"([{"step": 0, "time": 0, "load": 1, "probes": )" + std::string(5000, '[') +
          std::string(5000, ']') + "}]}"};
  for (const std::string& text : texts) {
    const std::string message = refusal(folder.write("report.json", text));
    EXPECT_THAT(message, HasSubstr("report.json: expected")) << text.substr(0, 80);
    EXPECT_EQ(message.find('\n'), message.npos) << message;
  }
  EXPECT_THAT(refusal(folder / "missing.json"), HasSubstr("missing.json"));
}

/// A whole report with bytes changed, cut out or doubled: read, or refused in one line, and a run goes on
/// from it.
TEST(SavedReport, WithRandomDamageIsReadOrRefused) {
  const TemporaryFolder folder;
  const Description scene = small_bar(2, true);
  {
    Simulation simulation(scene);
    ResultFolder results(folder.path());
    const RunOutcome outcome = run_to_end(
        simulation,
        {.after_step = [&](const StepReport&) { results.record(simulation, false); }, .max_steps = 4});
    results.finish(simulation, outcome);
  }
  const std::string good = folder.read("report.json"), checkpoint = folder.read("checkpoint.bin");
  std::mt19937 random(3);
  int gone_on = 0;
  for (int i = 0; i < 150; ++i) {
    std::string text = good;
    for (std::size_t changes = 1 + random() % 3; changes > 0; --changes) {
      const std::size_t at = random() % text.size(), count = 1 + random() % 20;
      constexpr std::string_view signs = "{}[]\",:-0.e9nt \\";
      if (random() % 3 == 0)
        text.erase(at, count);
      else if (random() % 2 == 0)
        text.insert(at, text.substr(random() % text.size(), count));
      else
        text[at] = signs[random() % signs.size()];
    }
    const std::string message = refusal(folder.write("report.json", text));
    EXPECT_EQ(message.find('\n'), message.npos) << message;
    if (!message.empty()) continue;
    ++gone_on;
    Simulation simulation(scene);
    ResultFolder results(folder.path());
    EXPECT_TRUE(results.resume(simulation, Resume::same_scene).has_checkpoint);
    simulation.step();
    results.record(simulation, true);
    results.finish(simulation, {.status = RunStatus::budget, .reason = "for the test"});
    EXPECT_EQ(refusal(folder / "report.json"), "");
    folder.write("checkpoint.bin", checkpoint);
  }
  EXPECT_GT(gone_on, 10);
}

}  // namespace
}  // namespace resilin::testing
