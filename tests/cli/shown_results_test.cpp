// Results for viewers: result.html and result.usda.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
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

/// README's own sequence: run, then draw any field, with the picture that a frame with the field gives.
TEST_F(ShownResultsOfARun, EveryFieldIsDrawnWithoutBeingAskedForInTheScene) {
  for (const std::string kind : {"static", "dynamic"}) {
    const std::vector<std::string> run = {
        "run", "box.toml", "--quiet", "--set", "simulation.kind=" + kind, "--steps", "2"};
    run_program(folder.path(), with(run, {"--out", "plain"}));
    for (const std::string field : {"von_mises", "averaged_von_mises", "velocity", "velocity.z",
                                    "cauchy_stress.xy", "principal_stress.1", "nodal_pressure",
                                    "nodal_green_strain.zz", "energy_density", "displacement"}) {
      const std::string asked = field.substr(0, field.find('.'));
      run_program(folder.path(), with(run, {"--out", "asked", "--set",
                                            "output.fields=[\"" + asked + "\", \"displacement\"]"}));
      for (const std::string place : {"plain", "asked"}) {
        const ProgramResult drawn = run_program(
            folder.path(),
            {"picture", place, "--field", field, "--rest", "--size", "160", "120", "--out", place + ".png"});
        EXPECT_EQ(drawn.exit_code, 0) << kind << ", " << field << ": " << drawn.err;
      }
      EXPECT_TRUE(text("plain.png") == text("asked.png")) << kind << ", " << field;
    }
    EXPECT_EQ(run_program(folder.path(), {"picture", "plain", "--out", "a.png"}).exit_code, 0);
    EXPECT_EQ(run_program(folder.path(),
                          {"picture", "plain/frames/0001.vtu", "--field", "pressure", "--out", "b.png"})
                  .exit_code,
              0);
  }
}

TEST_F(ShownResultsOfARun, FieldsThatCannotBeComputedAreRefusedInOneLine) {
  ASSERT_EQ(run_program(folder.path(), {"run", "box.toml", "--quiet"}).exit_code, 0);
  const auto refusal = [&](const std::vector<std::string>& more) {
    const ProgramResult drawn =
        run_program(folder.path(), with({"picture", "out/box", "--out", "a.png"}, more));
    EXPECT_EQ(drawn.exit_code, 1);
    EXPECT_EQ(std::ranges::count(drawn.err, '\n'), 1) << drawn.err;
    return drawn.err;
  };
  EXPECT_THAT(refusal({"--field", "von_misses"}), HasSubstr("did you mean \"von_mises\"?"));
  EXPECT_THAT(refusal({"--field", "cauchy_stress"}), HasSubstr("a component of cauchy_stress"));
  EXPECT_EQ(run_program(folder.path(), {"picture", "out/box", "--out", "a.jpg"}).err,
            "resilin: a.jpg: expected a name that ends in .png, got \".jpg\"\n");
  std::string scene = text("out/box/scene.bin");
  scene[scene.size() / 2] = static_cast<char>(scene[scene.size() / 2] ^ 1);
  folder.write("out/box/scene.bin", scene);
  EXPECT_THAT(refusal({"--field", "pressure"}), HasSubstr("scene.bin"));
  EXPECT_EQ(run_program(folder.path(), {"picture", "out/box", "--field", "displacement", "--out", "a.png"})
                .exit_code,
            0);
  std::filesystem::remove(folder / "out/box/scene.bin");
  EXPECT_THAT(refusal({"--field", "pressure"}), HasSubstr("a field of the frame (displacement"));
  // A frame of another scene in its place.
  ASSERT_EQ(run_program(folder.path(), {"run", "box.toml", "--quiet", "--out", "other", "--set",
                                        "body.0.mesh.box.cells=[2, 2, 2]"})
                .exit_code,
            0);
  std::filesystem::copy(folder / "other/scene.bin", folder / "out/box/scene.bin");
  EXPECT_THAT(refusal({"--field", "pressure"}), HasSubstr("a frame of the scene in scene.bin"));
}

TEST_F(ShownResultsOfARun, BecomeAFilmWithOneRangeAndOneFraming) {
  ASSERT_EQ(run_program(folder.path(), {"run", "box.toml", "--quiet", "--steps", "3"}).exit_code, 0);
  const ProgramResult made =
      run_program(folder.path(), {"film", "out/box", "--out", "box.png", "--size", "160", "120"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("pictures of 160 x 120 pixels"));
  EXPECT_THAT(text("box.png"), HasSubstr("acTL"));
  ASSERT_EQ(
      run_program(folder.path(), {"film", "out/box", "--out", "single", "--size", "160", "120"}).exit_code,
      0);
  EXPECT_TRUE(exists("single/00000.png"));
  EXPECT_FALSE(text("single/00000.png") == text("single/00001.png"));
  EXPECT_THAT(run_program(folder.path(), {"film", "out/box", "--out", "box.avi"}).err,
              HasSubstr("expected a name that ends in .png or .apng"));
  EXPECT_EQ(run_program(folder.path(), {"film", "nothing", "--out", "box.png"}).exit_code, 1);
  EXPECT_THAT(run_program(folder.path(), {"film", "out/box", "--out", "box.png", "--mode", "3"}).err,
              HasSubstr("expected a modal analysis"));
}

TEST_F(ShownResultsOfARun, BecomeAFilmOfAnyKindByFfmpeg) {
  ASSERT_EQ(run_program(folder.path(), {"run", "box.toml", "--quiet", "--steps", "3"}).exit_code, 0);
  const std::vector<std::pair<std::string, std::string>> kinds = {
      {"a.gif", "GIF89a"}, {"b.webp", "ANIM"}, {"c.mp4", "ftyp"}, {"d.webm", "webm"}};
  for (const auto& [name, mark] : kinds) {
    const ProgramResult made =
        run_program(folder.path(), {"film", "out/box", "--out", name, "--size", "161", "121"});
    if (made.err.find("the program ffmpeg on PATH") != std::string::npos) GTEST_SKIP() << made.err;
    EXPECT_EQ(made.exit_code, 0) << name << ": " << made.err;
    EXPECT_THAT(text(name).substr(0, 64), HasSubstr(mark)) << name;
  }
}

TEST_F(ShownResultsOfARun, OfASmallOneThePageHasEveryField) {
  ASSERT_EQ(run_program(folder.path(), {"run", "box.toml", "--quiet"}).exit_code, 0);
  const std::string page = text("out/box/result.html");
  const std::string begin = "<script id=\"fields\" type=\"application/json\">";
  const std::size_t at = page.find(begin);
  ASSERT_NE(at, page.npos);
  const auto fields =
      nlohmann::json::parse(page.substr(at + begin.size(), page.find("</script>", at) - at - begin.size()));
  std::vector<std::string> names;
  for (const auto& entry : fields) names.push_back(entry["field"]["name"]);
  for (const char* name : {"displacement.x", "averaged_pressure", "averaged_cauchy_stress.xz",
                           "averaged_principal_stress.3", "averaged_green_strain.xx"})
    EXPECT_THAT(names, ::testing::Contains(name));
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
