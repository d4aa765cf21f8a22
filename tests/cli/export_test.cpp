#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "program.hpp"
#include "resilin/io/atomic_file.hpp"
#include "temporary_folder.hpp"

// `resilin export`: one page that carries a scene and what simulates it.

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct Export : ::testing::Test {
  const std::string old_module = std::string("\0asm\1\0\0\0", 8);
  const TemporaryFolder folder;

  Export() {
    folder.write("box.toml", box_scene);
    folder.write("module.wasm", old_module + "resilin_start");  // empty, and of the right kind
  }
  ProgramResult run(const std::vector<std::string>& arguments) const {
    return run_program(folder.path(), arguments);
  }
};

TEST_F(Export, WritesOnePageWithModuleAndScene) {
  const ProgramResult made = run({"export", "box.toml", "play.html", "--engine", "module.wasm"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("play.html: "));
  const std::string page = read_file(folder / "play.html");
  for (const char* part : {R"({"kind": "playable"})", R"(<script id="engine" type="text/plain">eJ)",
                           R"(<script id="scene" type="text/plain">eJ)", R"(<script id="worker")"})
    EXPECT_THAT(page, HasSubstr(part));
  EXPECT_THAT(page, Not(HasSubstr(R"({"kind": "live"})")));
}

TEST_F(Export, TheSameSceneGivesTheSamePage) {
  run({"export", "box.toml", "a.html", "--engine", "module.wasm"});
  run({"export", "box.toml", "b.html", "--engine", "module.wasm"});
  EXPECT_EQ(read_file(folder / "a.html"), read_file(folder / "b.html"));
  run({"export", "box.toml", "b.html", "--engine", "module.wasm", "--set",
       "body.0.material.youngs_modulus=7e4"});
  EXPECT_NE(read_file(folder / "a.html"), read_file(folder / "b.html"));
}

/// A run that was cut short, too.
TEST_F(Export, OfARunWritesItsRecordingWithTheStateOfEachFrame) {
  for (const std::string kind : {"static", "dynamic"}) {
    const std::string setting = kind == "static" ? "simulation.load_steps=5" : "simulation.end_time=0.1";
    ASSERT_EQ(run({"run", "box.toml", "--quiet", "--out", "out", "--steps", "3", "--set",
                   "simulation.kind=" + kind, "--set", setting, "--set", "title=\"</script><!--\""})
                  .exit_code,
              2);
    const ProgramResult made = run({"export", "out", "play.html", "--engine", "module.wasm"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr("a recording, and "));
    EXPECT_EQ(made.out.find("interactive continuation: ") != std::string::npos, kind == "static");
    const std::string page = read_file(folder / "play.html"),
                      result = read_file(folder / "out" / "result.html");
    for (const char* part : {R"({"kind": "embedded"})", R"(<script id="engine" type="text/plain">eJ)",
                             R"(<script id="scene" type="text/plain">eJ)", R"(<script id="taking_up")"})
      EXPECT_THAT(page, HasSubstr(part));
    for (const int number : {0, 1, 2, 3})
      EXPECT_THAT(page,
                  HasSubstr("<script id=\"state-" + std::to_string(number) + "\" type=\"text/plain\">eJ"));
    EXPECT_THAT(page, Not(HasSubstr("state-4")));
    // It plays the same recording as result.html.
    const std::size_t begin = result.find("<script id=\"recording\""), end = result.find("</script>", begin);
    EXPECT_THAT(page, HasSubstr(result.substr(begin, end - begin)));
    std::filesystem::remove_all(folder / "out");
  }
}

TEST_F(Export, OfARunRefusesInOneLineWhatCannotBeTakenUp) {
  const auto made = [&](const std::vector<std::string>& settings) {
    std::filesystem::remove_all(folder / "out");
    std::vector<std::string> words = {"run",
                                      "box.toml",
                                      "--quiet",
                                      "--out",
                                      "out",
                                      "--set",
                                      "simulation.kind=dynamic",
                                      "--set",
                                      "simulation.end_time=0.03"};
    for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
    return run(words).exit_code;
  };
  const auto expect_refused = [&](const std::string& why, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"export", "out", "play.html", "--engine", "module.wasm"};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramResult result = run(words);
    EXPECT_EQ(result.exit_code, 1) << why;
    EXPECT_THAT(result.err, HasSubstr(why));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "play.html")) << why;
  };
  ASSERT_EQ(made({"output.formats=[\"vtu\"]"}), 0);
  expect_refused("expected a folder of results with recording.bin");
  ASSERT_EQ(made({"output.formats=[\"html\"]"}), 0);
  expect_refused("expected a folder of results with scene.bin");
  ASSERT_EQ(made({"simulation.kind=modes"}), 0);
  expect_refused("a modal analysis, whose frames are mode shapes");
  ASSERT_EQ(made({}), 0);
  expect_refused("--set: expected a scene to change", {"--set", "title=other"});
  std::filesystem::rename(folder / "out/frames/0002.vtu", folder / "out/frames/0003.vtu");
  expect_refused("expected the frame 0002.vtu, got none");
  std::filesystem::copy_file(folder / "out/frames/0001.vtu", folder / "out/frames/0002.vtu");
  expect_refused("expected the frame that was recorded, got one of another run: 0.01 s");
  folder.write("out/frames/0002.vtu", "half");
  expect_refused("0002.vtu");
}

TEST_F(Export, RefusesInOneLineAndWritesNothing) {
  folder.write("text.wasm", "no module");
  folder.write("old.wasm", old_module);
  folder.write("broken.toml", "[simulation]\nkind = \"dynamic\"\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"export", "box.toml"}, "see resilin export --help"},
      {{"export", "box.toml", "play.txt", "--engine", "module.wasm"},
       "play.txt: expected a name that ends in .html"},
      {{"export", "box.toml", "play.html", "--engine", "text.wasm"},
       "text.wasm: expected the WebAssembly module of Resilin"},
      {{"export", "box.toml", "play.html", "--engine", "old.wasm"}, "got another one"},
      {{"export", "box.toml", "play.html", "--engine", "none.wasm"}, "none.wasm: "},
      {{"export", "none.toml", "play.html", "--engine", "module.wasm"}, "none.toml"},
      {{"export", "broken.toml", "play.html", "--engine", "module.wasm"}, "broken.toml"},
      {{"export", "box.toml", "no/such/play.html", "--engine", "module.wasm"}, "cannot be written"},
  };
  for (const auto& [arguments, expected] : cases) {
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 1) << expected;
    EXPECT_THAT(result.err, HasSubstr(expected));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "play.html")) << expected;
  }
}

}  // namespace
}  // namespace resilin::testing
