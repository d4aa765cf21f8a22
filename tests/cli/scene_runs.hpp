#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {

/// Runs scenes and reads their reports.
struct Scenes : ::testing::Test {
  TemporaryFolder folder;

  nlohmann::json frames_of(const std::string& scene, const std::vector<std::string>& settings = {}) const {
    folder.write("scene.toml", scene);
    std::vector<std::string> arguments = {"run", "scene.toml", "--quiet", "--set", "output.formats=[]"};
    for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
    const ProgramResult result = run_program(folder.path(), arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_json(folder / "out/scene/report.json")["frames"];
  }
  std::string error_of(const std::string& scene, const std::string& setting) const {
    folder.write("scene.toml", scene);
    const ProgramResult result = run_program(folder.path(), {"check", "scene.toml", "--set", setting});
    EXPECT_EQ(result.exit_code, 1) << setting;
    return result.err;
  }
};

}  // namespace resilin::testing
