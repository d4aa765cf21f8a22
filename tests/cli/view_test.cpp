#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>  // setenv

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <regex>
#include <thread>

#include "jelly_scene.hpp"
#include "program.hpp"
#include "temporary_folder.hpp"
#include "viewer/page_client.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
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

  /// Address that a running program has printed.
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
  folder.write("sheet.toml",
               "[simulation]\ndimension = \"plane_stress\"\n[[body]]\nname = \"sheet\"\n"
               "mesh = { box = { size = [1, 1], cells = [2, 2] } }\n"
               "material = { law = \"neo_hookean\", youngs_modulus = 1e5, poissons_ratio = 0.3 }\n");
  folder.write("sheet.stl",
               "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
               "endfacet\nendsolid\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"view"}, "see resilin view --help"},
      {{"view", "nothing.toml"}, "nothing.toml"},
      {{"view", "broken.toml"}, "broken.toml:2: simulation.kynd"},
      {{"view", "sheet.stl"}, "open sheet"},
      {{"view", "sheet.toml"}, "simulation.dimension: the live page has no \"plane_stress\" scenes"},
      {{"view", "sheet.toml", "--set", "simulation.dimension=axisymmetric"},
       "simulation.dimension: the live page has no \"axisymmetric\" scenes"},
      {{"view", "results"}, "run the scene again with formats = [\"vtu\", \"html\"]"},
      {{"view", "results", "--set", "a=1"}, "--set: expected a scene to change"},
      {{"view", "jelly.toml", "--set", "simulation.kynd=1"}, "simulation.kynd"},
      {{"view", "jelly.toml", "--port", "70000"}, "70000"},
      {{"view", "jelly.toml", "--port", "http"}, "--port"},
      {{"view", "jelly.toml", "--threads", "0"}, "--threads"},
      {{"view", "jelly.toml", "--threads", "1000000"}, "--threads"},
      {{"view", "jelly.toml", "--threads", "abc"}, "--threads"},
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

TEST_F(View, KeepsItsAddressInAFileOverARestart) {
  const std::vector<std::string> words = {"view", "jelly.toml", "--no-browser", "--address-file", "address"};
  const auto start_and_end = [&] {
    RunningProgram program(folder.path(), words);
    const Address address = address_of(program);
    program.kill(SIGINT);
    EXPECT_EQ(program.finish().exit_code, 0);
    return address;
  };
  const Address first = start_and_end();
  const Address second = start_and_end();
  EXPECT_EQ(first.port, second.port);
  EXPECT_EQ(first.token, second.token);
  EXPECT_EQ(std::filesystem::status(folder.path() / "address").permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  std::filesystem::remove(folder.path() / "address");
  folder.write("address", "http://example.org");
  EXPECT_THAT(run(words).err, HasSubstr("address: expected an address that an earlier start has written"));
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

TEST_F(View, ComputesFieldsOfARunThatItsRecordingDoesNotHold) {
  ASSERT_EQ(run({"run", "jelly.toml", "--steps", "3", "--quiet"}).exit_code, 2);
  RunningProgram program(folder.path(), {"view", "out/jelly", "--no-browser"});
  const Address address = address_of(program);
  const auto get = [&address](const std::string& path) {
    const std::string answer =
        viewer::exchange(address.port, viewer::request_text(address.port, path + "token=" + address.token));
    return std::pair(answer.substr(0, 12), answer.substr(answer.find("\r\n\r\n") + 4));
  };
  const auto fields = nlohmann::json::parse(get("/fields?").second);
  ASSERT_GT(fields.size(), 40U);
  std::size_t size = 0;
  for (const auto& field : fields) {
    const auto [status, bytes] = get("/field?name=" + field["name"].get<std::string>() + "&");
    EXPECT_EQ(status, "HTTP/1.1 200") << field;
    EXPECT_TRUE(bytes.starts_with("RSV1")) << field;
    if (size == 0) size = bytes.size();
    EXPECT_EQ(bytes.size(), size) << field;
  }
  std::uint32_t counts[2];  // vertices, frames
  std::memcpy(counts, get("/field?name=averaged_pressure&").second.data() + 4, sizeof counts);
  EXPECT_EQ(counts[1], 4U);
  EXPECT_EQ(size, 12 + counts[1] * (12 + 2 * (counts[0] + counts[0] % 2)));
  for (const char* wrong : {"", "nothing", "cauchy_stress", "von_mises.x", "../report"}) {
    const auto [status, words] = get(std::string("/field?name=") + wrong + "&");
    EXPECT_EQ(status, "HTTP/1.1 404") << wrong;
    EXPECT_EQ(std::ranges::count(words, '\n'), 1) << words;
  }
  std::filesystem::remove(folder / "out/jelly/scene.bin");
  EXPECT_GT(nlohmann::json::parse(get("/fields?").second).size(), 40U) << "it is read once";
  program.kill(SIGINT);
  EXPECT_EQ(program.finish().exit_code, 0);
  RunningProgram without(folder.path(), {"view", "out/jelly", "--no-browser"});
  const Address other = address_of(without);
  EXPECT_TRUE(viewer::exchange(other.port, viewer::request_text(other.port, "/fields?token=" + other.token))
                  .ends_with("[]"));
}

/// Arguments of processes can be read by every user of the machine.
TEST_F(View, NoProcessIsCalledWithTheTokenWhenABrowserIsOpened) {
  folder.write("browser", R"sh(#!/bin/sh
cat "$1" > content.txt
stat -c %a "$1" "$(dirname "$1")" > modes.txt
printf %s "$1" > opened.txt
cat /proc/[0-9]*/cmdline 2>/dev/null | tr '\0' '\n' > calls.txt
touch done
)sh");
  std::filesystem::permissions(folder / "browser", std::filesystem::perms::owner_all);
  setenv("BROWSER", (folder / "browser").c_str(), 1);
  setenv("DISPLAY", ":0", 1);
  for (const bool has_runtime_folder : {false, true}) {
    std::filesystem::remove(folder / "done");
    const std::string runtime = (folder.path() / "runtime").string();
    std::filesystem::create_directories(runtime);
    has_runtime_folder ? setenv("XDG_RUNTIME_DIR", runtime.c_str(), 1) : unsetenv("XDG_RUNTIME_DIR");
    RunningProgram program(folder.path(), {"view", "jelly.toml"});
    const Address address = address_of(program);
    while (program.is_running() && !std::filesystem::exists(folder / "done"))
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_THAT(folder.read("calls.txt"),
                ::testing::AllOf(HasSubstr("jelly.toml"), Not(HasSubstr(address.token))));
    EXPECT_THAT(folder.read("content.txt"),
                HasSubstr("http://127.0.0.1:" + std::to_string(address.port) + "/?token=" + address.token));
    EXPECT_EQ(folder.read("modes.txt"), "600\n700\n");
    const std::filesystem::path opened = folder.read("opened.txt");
    EXPECT_EQ(opened.string().starts_with(runtime), has_runtime_folder);
    EXPECT_TRUE(std::filesystem::exists(opened));
    program.kill(SIGINT);
    EXPECT_EQ(program.finish().exit_code, 0);
    EXPECT_FALSE(std::filesystem::exists(opened.parent_path())) << "nothing is left behind";
  }
}

}  // namespace
}  // namespace resilin::testing
