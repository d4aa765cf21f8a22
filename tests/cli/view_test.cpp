#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <regex>

#include "jelly_scene.hpp"
#include "program.hpp"
#include "temporary_folder.hpp"
#include "viewer/page_client.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Address {
  std::uint16_t port = 0;
  std::string token;
};

struct View : ::testing::Test {
  TemporaryFolder folder;

  void SetUp() override { folder.write("jelly.toml", jelly); }

  ProgramResult run(const std::vector<std::string>& arguments) {
    return run_program(folder.path(), arguments);
  }

  /// What a running program has printed.
  static Address address_of(RunningProgram& program) {
    const std::string out = program.wait_for("token=[0-9a-f]{32}");
    std::smatch match;
    EXPECT_TRUE(std::regex_search(out, match,
                                  std::regex("Listening on http://127\\.0\\.0\\.1:(\\d+)/\\?token=(\\w+)")))
        << out;
    return {static_cast<std::uint16_t>(std::stoi(match[1])), match[2]};
  }
};

TEST_F(View, RefusesWhatItCannotShowInOneLine) {
  const std::filesystem::path results = folder.path() / "results";
  std::filesystem::create_directory(results);
  folder.write("broken.toml", "[simulation]\nkynd = 1\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"view"}, "see resilin view --help"},
      {{"view", "nothing.toml"}, "nothing.toml"},
      {{"view", "broken.toml"}, "broken.toml:2: simulation.kynd"},
      {{"view", "results"}, "run the scene again with formats = [\"vtu\", \"html\"]"},
      {{"view", "results", "--set", "a=1"}, "--set: expected a scene to change"},
      {{"view", "jelly.toml", "--set", "simulation.kynd=1"}, "simulation.kynd"},
      {{"view", "jelly.toml", "--port", "70000"}, "70000"},
      {{"view", "jelly.toml", "--port", "http"}, "--port"},
      {{"view", "jelly.toml", "--threads", "0"}, "--threads"},
  };
  for (const auto& [arguments, expected] : cases) {
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 1) << result.out;
    EXPECT_THAT(result.err, StartsWith("resilin: "));
    EXPECT_THAT(result.err, HasSubstr(expected));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
  }
}

TEST_F(View, ServesASceneUntilItIsInterrupted) {
  for (const int signal : {SIGINT, SIGTERM}) {
    RunningProgram program(folder.path(), {"view", "jelly.toml", "--no-browser", "--threads", "1"});
    const Address address = address_of(program);
    const std::string page =
        viewer::exchange(address.port, viewer::request_text(address.port, "/?token=" + address.token));
    EXPECT_THAT(page, HasSubstr("{\"kind\": \"live\"}"));
    viewer::PageClient client(address.port, address.token);
    EXPECT_THAT(client.receive_text("hello"), HasSubstr("\"title\":\"jelly.toml\""));
    client.receive_frame();
    program.kill(signal);
    const ProgramResult result = program.finish();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    while (client.receive()) {  // the connection is closed in order
    }
  }
}

TEST_F(View, ReadsTheSceneAgainAndSurvivesABrokenOne) {
  RunningProgram program(folder.path(), {"view", "jelly.toml", "--no-browser"});
  const Address address = address_of(program);
  viewer::PageClient client(address.port, address.token);
  client.receive_text("hello");
  folder.write("jelly.toml", "[simulation]\nkynd = 1\n");
  client.send_text(R"({"type": "reload"})");
  EXPECT_THAT(client.receive_text("error"), HasSubstr("jelly.toml:2: simulation.kynd"));
  client.receive_frame();
  folder.write("jelly.toml", "title = \"Another jelly\"\n" + jelly);
  client.send_text(R"({"type": "reload"})");
  EXPECT_THAT(client.receive_text("hello"), HasSubstr("Another jelly"));
  client.receive_frame();
  program.kill(SIGINT);
  EXPECT_EQ(program.finish().exit_code, 0);
}

TEST_F(View, SaysThatThePortIsInUse) {
  RunningProgram first(folder.path(), {"view", "jelly.toml", "--no-browser"});
  const std::string port = std::to_string(address_of(first).port);
  TemporaryFolder other;
  other.write("jelly.toml", jelly);
  const ProgramResult second =
      run_program(other.path(), {"view", "jelly.toml", "--no-browser", "--port", port});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.err,
              HasSubstr("port " + port + ": expected a free one on 127.0.0.1, got one that another program"));
  EXPECT_THAT(second.err, HasSubstr("--port 0"));
  first.kill(SIGINT);
  EXPECT_EQ(first.finish().exit_code, 0);
}

TEST_F(View, ServesTheResultsOfARun) {
  std::filesystem::create_directory(folder.path() / "results");
  folder.write("results/recording.bin", "RSR1");
  folder.write("results/report.json", R"({"frames": []})");
  RunningProgram program(folder.path(), {"view", "results", "--no-browser"});
  const Address address = address_of(program);
  const auto get = [&address](const std::string& path) {
    return viewer::exchange(address.port,
                            viewer::request_text(address.port, path + "?token=" + address.token));
  };
  EXPECT_THAT(get("/"), HasSubstr("{\"kind\": \"recorded\"}"));
  EXPECT_TRUE(get("/recording").ends_with("\r\n\r\nRSR1"));
  EXPECT_TRUE(get("/report").ends_with("\r\n\r\n{\"frames\": []}"));
  EXPECT_THAT(get("/live"), HasSubstr("404"));
  program.kill(SIGTERM);
  EXPECT_EQ(program.finish().exit_code, 0);
}

}  // namespace
}  // namespace resilin::testing
