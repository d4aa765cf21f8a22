#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "program.hpp"
#include "resilin/io/atomic_file.hpp"
#include "shared_data.hpp"
#include "temporary_folder.hpp"

// `resilin new`: a scene for a mesh or a surface that runs as it is.

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

struct New : ::testing::Test {
  const TemporaryFolder folder;

  ProgramResult run(const std::vector<std::string>& arguments) const {
    return run_program(folder.path(), arguments);
  }
  std::string data(const std::string& name) const { return (source_folder() / "data" / name).string(); }
};

TEST_F(New, WritesASceneThatRunsUnchanged) {
  for (const char* mesh : {"spot_surface.obj", "beam3_tet.veg", "starfish.msh"}) {
    const ProgramResult made =
        run({"new", data(mesh), "--scale", "0.1", "--cells", "1000", "--out", "a.toml"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr("resilin run a.toml"));
    const ProgramResult ran = run({"run", "a.toml", "--out", "out"});
    EXPECT_EQ(ran.exit_code, 0) << mesh << ran.err;
    std::filesystem::remove(folder / "a.toml");
    std::filesystem::remove_all(folder / "out");
  }
}

TEST_F(New, NeverWritesOverAFile) {
  folder.write("a.toml", "mine");
  const ProgramResult result = run({"new", data("beam3_tet.veg"), "--out", "a.toml"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("a.toml: exists already"));
  EXPECT_EQ(read_file(folder / "a.toml"), "mine");
}

TEST_F(New, RefusesInOneLineAndWritesNothing) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"new"}, "see resilin new --help"},
      {{"new", "nothing.stl"}, "nothing.stl: no such file"},
      {{"new", data("spot_surface.obj"), "--scale", "0"}, "--scale"},
      {{"new", data("spot_surface.obj"), "--cells", "0"}, "--cells"},
      {{"new", data("starfish.msh"), "--up", "z"}, "--up"},
      {{"new", (source_folder() / "examples" / "funnel.obj").string()}, "open sheet"},
      {{"new", data("beam3_tet.veg"), "--out", "no/such/folder/a.toml"}, "cannot be written"},
  };
  for (const auto& [arguments, expected] : cases) {
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 1) << result.out;
    EXPECT_THAT(result.err, HasSubstr(expected));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    EXPECT_NE(entry.path().extension(), ".toml") << entry.path();
}

}  // namespace
}  // namespace resilin::testing
