// `resilin mesh SURFACE OUT --tets N` with programs of its own in place of Gmsh.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Fills the unit cube with 6 n^3 tetrahedra, n = 1 / size, whatever the surface.
const std::string cube_filler = R"(#!/bin/sh
test -s surface.msh || exit 9
size=$(sed -n 's/Mesh.MeshSizeMax = \(.*\);/\1/p' fill.geo)
n=$(awk "BEGIN { n = int(1 / $size + 0.5); print n < 1 ? 1 : n }")
exec ")" + program_path() + R"(" mesh filled.msh --box 1 1 1 --cells $n $n $n
)";

struct Fill : ::testing::Test {
  TemporaryFolder folder;
  std::filesystem::path temporary = folder.path() / "it's; \"a\" folder";

  Fill() {
    std::filesystem::create_directories(folder.path() / "bin");
    std::filesystem::create_directories(temporary);
    run_program(folder.path(), {"mesh", "cube.msh", "--box", "1", "1", "1", "--cells", "2", "2", "2"});
    run_program(folder.path(), {"mesh", "cube.msh", "cube.obj", "--surface"});
  }

  void install_gmsh(const std::string& script) const {
    folder.write("bin/gmsh", script);
    std::filesystem::permissions(folder.path() / "bin/gmsh", std::filesystem::perms::owner_all);
  }

  ProgramResult run(std::vector<std::string> arguments,
                    const std::string& other_programs = ":/usr/bin:/bin") {
    arguments.insert(arguments.begin(), "mesh");
    return run_program(
        folder.path(), arguments,
        {"PATH=" + (folder.path() / "bin").string() + other_programs, "TMPDIR=" + temporary.string()});
  }

  void expect_refusal(const ProgramResult& result, const std::string& text) const {
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.msh"));
    EXPECT_TRUE(std::filesystem::is_empty(temporary));
  }
};

TEST_F(Fill, NeedsNoOtherProgram) {
  const ProgramResult result = run({"cube.obj", "out.msh", "--tets", "600"}, "");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("the mesh has 1 times the volume of the surface"),
                                HasSubstr("smallest angle between sides"), HasSubstr("tetrahedra")));
  EXPECT_EQ(result.err, "");
  const ProgramResult lattice = run({"cube.obj", "out.msh", "--mesher", "lattice"}, "");
  EXPECT_EQ(lattice.exit_code, 0) << lattice.err;
  EXPECT_THAT(lattice.out, HasSubstr("smallest angle between sides 60 degrees"));
}

TEST_F(Fill, ChangesTheSizeUntilTheNumberOfTetrahedraIsNear) {
  install_gmsh(cube_filler);
  const ProgramResult result = run({"cube.obj", "out.msh", "--tets", "3000", "--mesher", "gmsh"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("out.msh: 729 vertices, 768 triangles, 3072 tetrahedra"));
  EXPECT_THAT(result.out, HasSubstr("smallest angle between sides 45 degrees"));
  EXPECT_THAT(result.out, HasSubstr("the surface stands at most 0 m outside"));
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(run({"out.msh", "again.vtu"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::is_empty(temporary));
}

TEST_F(Fill, TakesFilesOfAnyName) {
  install_gmsh(cube_filler);
  const std::string name = "$(touch hole) 'a\".obj";
  std::filesystem::rename(folder.path() / "cube.obj", folder.path() / name);
  EXPECT_EQ(run({name, "out.msh", "--tets", "300", "--mesher", "gmsh"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "hole"));
}

TEST_F(Fill, SaysWhenTheNumberCannotBeMet) {
  install_gmsh("#!/bin/sh\nexec \"" + program_path() + "\" mesh filled.msh --box 1 1 1 --cells 3 3 3\n");
  const ProgramResult result = run({"cube.obj", "out.msh", "--tets", "3000", "--mesher", "gmsh"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("nearest to 3000 tetrahedra that gmsh makes of this surface is 162"));
}

TEST_F(Fill, ShowsTheEndOfWhatAFailedProgramSaid) {
  install_gmsh("#!/bin/sh\necho first; echo 'Error : the surface crosses itself' >&2; echo; exit 3\n");
  expect_refusal(run({"cube.obj", "out.msh", "--tets", "300", "--mesher", "gmsh"}),
                 "gmsh: failed with exit code 3; it said last: Error : the surface crosses itself");
  install_gmsh("#!/bin/sh\nkill -SEGV $$\n");
  expect_refusal(run({"cube.obj", "out.msh", "--tets", "300", "--mesher", "gmsh"}),
                 "gmsh: was ended by signal 11");
  install_gmsh("#!/bin/sh\necho Stopped\n");
  expect_refusal(run({"cube.obj", "out.msh", "--tets", "300", "--mesher", "gmsh"}),
                 "gmsh: made no mesh; it said last: Stopped");
  install_gmsh("#!/bin/sh\necho nonsense > filled.msh\n");
  expect_refusal(run({"cube.obj", "out.msh", "--tets", "300", "--mesher", "gmsh"}), "filled.msh");
}

TEST_F(Fill, EndsAProgramThatTakesTooLong) {
  install_gmsh("#!/bin/sh\nsleep 50 & wait\n");
  expect_refusal(run({"cube.obj", "out.msh", "--tets", "300", "--time-limit", "0.3", "--mesher", "gmsh"}),
                 "gmsh: stopped after 0.3 s");
}

TEST_F(Fill, SaysHowToInstallAProgramWhereThereIsNone) {
  const ProgramResult result = run({"cube.obj", "out.msh", "--tets", "300", "--mesher", "gmsh"}, "");
  expect_refusal(result, "pip install gmsh");
  EXPECT_THAT(result.err, StartsWith("resilin: "));
  expect_refusal(run({"cube.obj", "out.msh", "--tets", "300", "--mesher", "pytetwild"}, ""),
                 "pip install pytetwild");
  expect_refusal(run({"cube.obj", "out.msh", "--tets", "300", "--mesher", "tetgen"}),
                 "expected one of fitted, lattice, pytetwild, gmsh, got \"tetgen\"");
}

TEST_F(Fill, RefusesSurfacesThatEncloseNothing) {
  install_gmsh(cube_filler);
  std::string open = read_text_file(folder.path() / "cube.obj");
  open.erase(open.rfind("f "));
  folder.write("open.obj", open);
  expect_refusal(run({"open.obj", "out.msh", "--tets", "300", "--mesher", "gmsh"}),
                 "open.obj is not closed: 3 edges do not have two triangles");
  expect_refusal(run({"cube.msh", "out.msh", "--tets", "0", "--mesher", "gmsh"}),
                 "expected a whole number >= 1, got 0");
}

}  // namespace
}  // namespace resilin::testing
