// What a run leaves to be looked at: result.html and result.usda.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <regex>

#include "program.hpp"
#include "resilin/results/shown_results.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string> motion = {
    "run", "box.toml", "--quiet", "--set", "simulation.kind=dynamic", "--set", "simulation.end_time=0.3"};

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

struct ShownResultsOfARun : ::testing::Test {
  TemporaryFolder folder;
  ShownResultsOfARun() { folder.write("box.toml", box_scene); }
  std::string text(const std::string& name) const { return read_text_file(folder.path() / name); }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder.path() / name); }
};

TEST_F(ShownResultsOfARun, ArePutIntoOnePageThatAsksForNothing) {
  const ProgramResult result =
      run_program(folder.path(), {"run", "box.toml", "--set", "title=\"</script><b>&\""});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("out/box/result.html ("));
  EXPECT_THAT(result.out, HasSubstr(" kB, opens in a browser)"));
  const std::string page = text("out/box/result.html");
  EXPECT_EQ(read_json(folder.path() / "out/box/report.json")["files"]["result.html"], page.size());
  const auto has = [&page](const std::string& part) { return page.find(part) != page.npos; };
  EXPECT_TRUE(has(R"({"kind": "embedded"})"));
  EXPECT_TRUE(has(base64(text("out/box/recording.bin"))));
  EXPECT_FALSE(has("</script><b>"));
  EXPECT_TRUE(has("\\u003c/script>\\u003cb>"));
  // Names of XML vocabularies look like addresses; nothing else does.
  const std::regex address("https?://[^\"'` )]*");
  for (auto it = std::sregex_iterator(page.begin(), page.end(), address); it != std::sregex_iterator(); ++it)
    EXPECT_THAT(it->str(), HasSubstr("http://www.w3.org/"));
  for (const char* link : {"href=\"http", "src=\"", "@import", "url(http"}) EXPECT_FALSE(has(link)) << link;
}

TEST_F(ShownResultsOfARun, AreThoseOfTheUnbrokenRunAfterAResume) {
  const std::vector<std::string> all = {"--formats", "html,usda", "--set", "output.every=4"};
  const auto run = [&](const std::vector<std::string>& more) {
    return run_program(folder.path(), with(with(motion, all), more)).exit_code;
  };
  ASSERT_EQ(run({"--out", "whole"}), 0);
  ASSERT_EQ(run({"--out", "parts", "--steps", "11"}), 2);
  EXPECT_TRUE(exists("parts/result.html"));
  EXPECT_TRUE(exists("parts/result.usda"));
  EXPECT_FALSE(exists("parts/frames.pvd"));
  ASSERT_EQ(run({"--out", "parts", "--resume"}), 0);
  EXPECT_TRUE(text("parts/recording.bin") == text("whole/recording.bin"));
  EXPECT_TRUE(text("parts/result.usda") == text("whole/result.usda"));
  EXPECT_FALSE(exists("parts/result.usda.points"));
  // A run that has nothing left to do leaves them.
  ASSERT_EQ(run({"--out", "parts", "--resume"}), 0);
  EXPECT_TRUE(text("parts/recording.bin") == text("whole/recording.bin"));
  EXPECT_TRUE(text("parts/result.usda") == text("whole/result.usda"));
}

TEST_F(ShownResultsOfARun, AreThoseOfTheUnbrokenRunAfterAKill) {
  ASSERT_EQ(run_program(folder.path(), with(motion, {"--out", "whole"})).exit_code, 0);
  const ProgramResult killed = run_program_until(folder.path(), with(motion, {"--out", "killed"}), "killed",
                                                 "frames/0010.vtu", SIGKILL);
  ASSERT_EQ(killed.exit_code, 128 + SIGKILL);
  ASSERT_EQ(run_program(folder.path(), with(motion, {"--out", "killed", "--resume"})).exit_code, 0);
  EXPECT_TRUE(text("killed/recording.bin") == text("whole/recording.bin"));
}

TEST_F(ShownResultsOfARun, OfFormatsThatAreNotAskedForAreNotLeftFromEarlier) {
  ASSERT_EQ(run_program(folder.path(), {"run", "box.toml", "--formats", "vtu,html,usda"}).exit_code, 0);
  for (const char* name : {"recording.bin", "result.html", "result.usda"})
    EXPECT_TRUE(exists(std::string("out/box/") + name)) << name;
  ASSERT_EQ(run_program(folder.path(), {"run", "box.toml", "--formats", "vtu"}).exit_code, 0);
  for (const char* name : {"recording.bin", "result.html", "result.usda"})
    EXPECT_FALSE(exists(std::string("out/box/") + name)) << name;
  EXPECT_EQ(run_program(folder.path(), {"run", "box.toml", "--formats", "gif"}).exit_code, 1);
}

TEST(Base64, IsThatOfTheStandard) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe"), "//4=");
}

}  // namespace
}  // namespace resilin::testing
