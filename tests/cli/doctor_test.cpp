#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "program.hpp"
#include "resilin/results/build_info.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using Json = nlohmann::json;

/// A machine with nothing on PATH but what a test puts into a folder.
struct Doctor : ::testing::Test {
  TemporaryFolder folder;
  std::vector<std::string> environment = {"PATH=" + folder.path().string(),
                                          "DISPLAY=", "WAYLAND_DISPLAY=", "BROWSER="};

  /// A program that `sh` runs.
  void put(const std::string& name, const std::string& script) {
    folder.write(name, "#!/bin/sh\n" + script);
    std::filesystem::permissions(folder / name, std::filesystem::perms::owner_all);
  }

  ProgramResult run() const { return run_program(folder.path(), {"doctor"}, environment); }

  /// Finding about one thing.
  Json finding(const std::string& name) const {
    const ProgramResult result = run_program(folder.path(), {"doctor", "--json"}, environment);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    for (const Json& one : Json::parse(result.out))
      if (one["name"] == name) return one;
    return {};
  }
};

TEST_F(Doctor, FindsWhatIsHiddenAndTheCureByItsPackage) {
  const ProgramResult result = run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const std::string found : {"computing", "instruction set", "threads", "memory", "results"})
    EXPECT_THAT(result.out, HasSubstr("ok  " + found)) << found;
  for (const std::string missing : {"browser", "ffmpeg", "pytetwild", "gmsh", "Python"})
    EXPECT_THAT(result.out, HasSubstr("--  " + missing)) << missing;
  for (const std::string cure : {"apt-get install ffmpeg", "pip install pytetwild pyvista",
                                 "apt-get install gmsh", "apt-get install python3"})
    EXPECT_THAT(result.out, HasSubstr(cure));
  const ProgramResult as_json = run_program(folder.path(), {"doctor", "--json"}, environment);
  for (const Json& one : Json::parse(as_json.out))
    EXPECT_EQ(one["ok"].get<bool>(), one["cure"].get<std::string>().empty()) << one;
}

TEST_F(Doctor, TellsWhichFilmsFfmpegCanEncode) {
  put("ffmpeg", "echo ' V....D gif  GIF'; echo ' V....D libx264  H.264'\n");
  EXPECT_THAT(finding("ffmpeg")["found"],
              AllOf(HasSubstr("cannot write .webp, .webm"), HasSubstr("no encoder")));
  put("ffmpeg", "echo gif libx264 libwebp libvpx-vp9\n");
  EXPECT_TRUE(finding("ffmpeg")["ok"]);
  put("ffmpeg", "echo gif libx264 libwebp libvpx-vp9; exit 1\n");
  EXPECT_THAT(finding("ffmpeg")["found"], HasSubstr("does not run"));
}

TEST_F(Doctor, LooksForADisplayThenForABrowser) {
  EXPECT_THAT(finding("browser")["found"], HasSubstr("no display"));
  environment.emplace_back("DISPLAY=:7");
  EXPECT_THAT(finding("browser")["cure"], HasSubstr("apt-get install xdg-utils"));
  put("xdg-open", "exit 0\n");
  EXPECT_TRUE(finding("browser")["ok"]);
  environment.emplace_back("BROWSER=opera --kiosk:other");
  EXPECT_THAT(finding("browser")["found"], HasSubstr("opera --kiosk is not there"));
  put("opera", "exit 0\n");
  EXPECT_TRUE(finding("browser")["ok"]);
}

/// A program that lies in a clone knows what makes the clone's site.
TEST_F(Doctor, SaysWhatTheSiteOfItsCloneLacks) {
  const std::filesystem::path clone = folder / "clone", place = clone / "build/release/apps/cli";
  std::filesystem::create_directories(place);
  std::filesystem::copy_file(program_path(), place / "resilin");
  const auto site = [&] {
    const ProgramResult result =
        run_shell(folder.path(), "PATH=$PWD exec clone/build/release/apps/cli/resilin doctor --json");
    for (const Json& one : Json::parse(result.out))
      if (one["name"] == "site") return one;
    return Json();
  };
  EXPECT_TRUE(site().is_null());  // no clone
  std::filesystem::create_directories(clone / "scripts");
  std::ofstream(clone / "scripts/build_site.sh");
  EXPECT_EQ(site()["found"],
            "scripts/build_site.sh lacks what makes pages, what notebooks print, scenes to play with, films");
  for (const std::string tool : {"build/site/venv/bin/python", "build/python/venv/bin/python",
                                 "build/wasm/apps/play/resilin_play.wasm"}) {
    std::filesystem::create_directories((clone / tool).parent_path());
    std::ofstream{clone / tool};
  }
  EXPECT_THAT(site()["cure"], HasSubstr("ffmpeg"));
  put("ffmpeg", "exit 0\n");
  EXPECT_TRUE(site()["ok"]);
}

TEST_F(Doctor, AsksPythonWhatItCanImport) {
  const std::string mesher = "[ \"$2\" = 'import pytetwild' ] && exit 1\n";
  put("python3", mesher + "echo 'ModuleNotFoundError: no resilin'; exit 1\n");
  EXPECT_THAT(finding("Python")["found"],
              HasSubstr("cannot import resilin: ModuleNotFoundError: no resilin"));
  put("python3", mesher + "echo version 0.0.1\n");
  EXPECT_THAT(finding("Python")["found"], HasSubstr("another version 0.0.1"));
  put("python3", mesher + "echo package torch; echo version " + std::string(version()) + "\n");
  EXPECT_TRUE(finding("Python")["ok"]);
  EXPECT_TRUE(finding("torch")["ok"]);
  EXPECT_EQ(finding("pandas")["cure"], "pip install 'resilin[pandas]'");
  EXPECT_FALSE(finding("pytetwild")["ok"]);
}

TEST_F(Doctor, RefusesOnlyWhereScenesCannotBeSimulated) {
  for (const std::string wrong : {"RESILIN_ISA=z80", "RESILIN_THREADS=0"}) {
    const ProgramResult result = run_program(folder.path(), {"doctor"}, {wrong});
    EXPECT_EQ(result.exit_code, 1) << wrong;
    EXPECT_THAT(result.err, HasSubstr(wrong.substr(0, wrong.find('=')))) << wrong;
  }
}

}  // namespace
}  // namespace resilin::testing
