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
  const TemporaryFolder folder;

  Export() {
    folder.write("box.toml", box_scene);
    folder.write("module.wasm", std::string("\0asm\1\0\0\0", 8));  // empty, and of the right kind
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

TEST_F(Export, RefusesInOneLineAndWritesNothing) {
  folder.write("text.wasm", "no module");
  folder.write("broken.toml", "[simulation]\nkind = \"dynamic\"\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"export", "box.toml"}, "see resilin export --help"},
      {{"export", "box.toml", "play.txt", "--engine", "module.wasm"},
       "play.txt: expected a name that ends in .html"},
      {{"export", "box.toml", "play.html", "--engine", "text.wasm"},
       "text.wasm: expected a WebAssembly module"},
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
