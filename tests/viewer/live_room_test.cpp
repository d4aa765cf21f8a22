#include "viewer/live_room.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>

#include "fake_scene.hpp"

namespace resilin::viewer {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using viewer::PageClient;

constexpr const char* grab = R"({"type": "grab", "vertex": 1, "point": [0, 0, 0]})";

json next_json(PageClient& page, std::string_view type) { return json::parse(page.receive_text(type)); }

/// True once a `state` comes in which the keys, of objects inside it too, have these values.
bool comes_to(PageClient& page, const json& values) {
  for (int i = 0; i < 100; ++i) {
    json state = next_json(page, "state");
    const json before = state;
    state.update(values, /*merge_objects=*/true);
    if (state == before) return true;
  }
  return false;
}

double frame_time(std::string_view frame) {
  double time = 0;
  std::memcpy(&time, frame.substr(8, sizeof time).data(), sizeof time);
  return time;
}

/// A server that waits for its pages longer than any test takes.
ServerOptions patient() {
  constexpr std::chrono::milliseconds long_time = std::chrono::hours(1);
  ServerOptions options;
  options.request_timeout = options.send_timeout = options.body_timeout = options.idle_timeout = long_time;
  return options;
}

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

TEST(LiveRoom, TellsAPageEverythingInOrder) {
  const FakeScene scene;
  PageClient page = scene.page();
  const auto hello = page.receive();
  ASSERT_TRUE(hello && hello->is_text);
  const json header = json::parse(hello->bytes);
  EXPECT_EQ(header["type"], "hello");
  EXPECT_EQ(header["title"], "A fake");
  EXPECT_EQ(header["client"], 1);
  EXPECT_EQ(header["state"]["type"], "state");
  EXPECT_EQ(header["state"]["values"]["speed"], 1);
  EXPECT_EQ(header["state"]["paused"], false);
  EXPECT_TRUE(header["state"]["grabbed_by"].is_null());
  const auto topology = page.receive();
  ASSERT_TRUE(topology && !topology->is_text);
  EXPECT_TRUE(topology->bytes.starts_with("RST1"));
  const std::uint32_t first = viewer::frame_number(page.receive_frame());
  EXPECT_GT(viewer::frame_number(page.receive_frame()), first);
  EXPECT_TRUE(next_json(page, "status").contains("real_time_ratio"));
}

/// Those that have shown the token stay; those that say nothing make room.
TEST(LiveRoom, PagesAreNotSentAwayForWhoSaysNothing) {
  ServerOptions options = patient();
  options.max_connections = 4;
  const FakeScene scene(4, options);
  std::vector<PageClient> pages;
  for (int i = 0; i < 3; ++i) {
    pages.emplace_back(scene.server.port(), scene.server.token());
    pages.back().receive_text("hello");
  }
  std::vector<Socket> silent;
  for (int i = 0; i < 20; ++i) silent.emplace_back(scene.server.port());
  const auto page = [&] {
    return exchange(scene.server.port(), request_text(scene.server.port(), "/?token=" + scene.server.token()))
        .substr(0, 12);
  };
  EXPECT_TRUE(comes_true([&] { return page() == "HTTP/1.1 200"; }));
  for (PageClient& client : pages) client.receive_frame();
  pages.emplace_back(scene.server.port(), scene.server.token());
  pages.back().receive_text("hello");
  EXPECT_TRUE(comes_true([&] { return page() == "HTTP/1.1 503"; })) << "all are pages";
  pages.pop_back();
  EXPECT_TRUE(comes_true([&] { return page() == "HTTP/1.1 200"; }));
}

TEST(LiveRoom, SendsNothingMoreUntilAFrameIsAcknowledgedAndThenTheNewest) {
  const FakeScene scene;
  PageClient page = scene.page();
  const std::string first = page.receive_frame(false);
  double told = 0;  // by a status, which comes after the frame of its time [s]
  while (told < frame_time(first) + 0.1) {
    const auto message = page.receive();
    ASSERT_TRUE(message);
    ASSERT_FALSE(viewer::is_frame(*message)) << "a second frame before the first is acknowledged";
    const json text = json::parse(message->bytes);
    if (text["type"] == "status") told = text["time"];
  }
  page.acknowledge(viewer::frame_number(first) + 1000);  // none that it has
  page.acknowledge(viewer::frame_number(first));
  const std::string second = page.receive_frame();
  EXPECT_GE(frame_time(second), told) << "not the newest";
  EXPECT_GT(viewer::frame_number(second), viewer::frame_number(first) + 1);
}

/// Where one page waited for another, it would wait until the test is given up.
TEST(LiveRoom, ASlowPageDoesNotStallTheOthers) {
  FakeScene scene(20000, patient());
  PageClient silent = scene.page();  // reads and never acknowledges
  PageClient unread = scene.page();  // reads nothing at all
  silent.receive_frame(false);
  for (int i = 0; i < 2000; ++i) unread.send_text(R"({"type": "what"})");
  PageClient page = scene.page();
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(page.receive_frame().empty());
}

TEST(LiveRoom, APageThatTakesNothingIsDropped) {
  ServerOptions options;
  options.send_timeout = std::chrono::milliseconds(2000);
  FakeScene scene(2000000, options);  // a frame of 12 MB: more than sockets hold
  PageClient page = scene.page();
  page.send_text(R"({"type": "pause"})");  // its own frames are large, too
  PageClient unread = scene.page();
  ASSERT_TRUE(unread.send_text(grab));
  ASSERT_TRUE(comes_to(page, {{"grabbed_by", 2}}));
  EXPECT_TRUE(comes_to(page, {{"grabbed_by", nullptr}}))
      << "the page that held the body is gone, so it is let go";
}

TEST(LiveRoom, SimulatesInRealTime) {
  const Clock::time_point start = Clock::now();
  const FakeScene scene;
  ASSERT_TRUE(comes_true([&] { return scene.switches->num_steps >= 30; }));
  const int steps = scene.switches->num_steps;
  EXPECT_LE(steps, 60 * seconds_since(start) + 2) << "ahead of the wall clock";
  EXPECT_TRUE(comes_true([&] {  // a busy machine loses time, but not always
    const Clock::time_point begin = Clock::now();
    const int before = scene.switches->num_steps;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    return scene.switches->num_steps - before >= 0.8 * 60 * seconds_since(begin);
  }));
}

TEST(LiveRoom, DropsTimeThatIsLost) {
  const Clock::time_point start = Clock::now();
  const FakeScene scene;
  constexpr double slow = 0.4;  // [s] for a step of 1/60 s
  scene.switches->step_milliseconds = 400;
  const int fast = scene.switches->num_steps;
  ASSERT_TRUE(comes_true([&] { return scene.switches->num_steps >= fast + 4; }));  // three slow ones at least
  scene.switches->step_milliseconds = 0;
  const int before = scene.switches->num_steps;
  ASSERT_TRUE(comes_true([&] { return scene.switches->num_steps > before + 60; }));
  // Steps of no length make up for the time of the slow one before them, but not for that of two others.
  const int steps = scene.switches->num_steps;
  const double lost = 2 * (slow - 2.0 / 60);
  EXPECT_LE(steps, 60 * (seconds_since(start) - lost) + 2)
      << "it runs after the time that the slow steps have lost";
}

TEST(LiveRoom, ShowsSlowMotionAtTheRateOfFrames) {
  const FakeScene scene;
  PageClient page = scene.page();
  page.send_text(R"({"type": "set", "key": "speed", "value": 0.05})");
  ASSERT_TRUE(comes_to(page, {{"values", {{"speed", 0.05}}}}));
  EXPECT_TRUE(comes_true([&] {  // 30 frames take half a second, 1.5 steps, when the machine has time for them
    const int steps = scene.switches->num_steps;
    for (int i = 0; i < 30; ++i) page.receive_frame();
    return scene.switches->num_steps - steps <= 10;
  }));
}

TEST(LiveRoom, PausesStepsAndPlays) {
  const FakeScene scene;
  PageClient page = scene.page();
  page.send_text(R"({"type": "pause"})");
  ASSERT_TRUE(comes_to(page, {{"paused", true}}));
  const int paused_at = scene.switches->num_steps;
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(scene.switches->num_steps, paused_at);
  page.send_text(R"({"type": "step"})");
  ASSERT_TRUE(comes_true([&] { return scene.switches->num_steps == paused_at + 1; }));
  page.send_text(R"({"type": "play"})");
  EXPECT_TRUE(comes_to(page, {{"paused", false}}));
  EXPECT_TRUE(comes_true([&] { return scene.switches->num_steps > paused_at + 2; }));
}

TEST(LiveRoom, SleepsWhenNothingMoves) {
  const FakeScene scene;
  PageClient page = scene.page();
  scene.switches->rests = true;
  page.receive_frame();
  ASSERT_TRUE(comes_true([&] {
    const int before = scene.switches->num_steps;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return scene.switches->num_steps == before;
  }));
  EXPECT_TRUE(comes_true([] {
    const double before = processor_seconds();
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    return processor_seconds() - before < 0.01;
  }));
}

TEST(LiveRoom, GivesEachPageTheFieldThatItChooses) {
  const FakeScene scene;
  scene.switches->rests = true;
  PageClient one = scene.page(), other = scene.page();
  const std::size_t plain = one.receive_frame().size();
  one.send_text(R"({"type": "field", "name": "von_mises"})");
  std::string frame = one.receive_frame();
  while (frame.size() == plain) frame = one.receive_frame();
  EXPECT_EQ(frame.size(), plain + 200);
  EXPECT_EQ(frame[28], 1);  // its number in the header's list
  EXPECT_EQ(other.receive_frame().size(), plain);
  one.send_text(R"({"type": "field", "name": "von_mise"})");
  EXPECT_THAT(one.receive_text("error"), HasSubstr("one of displacement, von_mises"));
  one.send_text(R"({"type": "field", "name": "", "arrows": "von_mises"})");
  EXPECT_THAT(one.receive_text("error"), HasSubstr("arrows"));
}

TEST(LiveRoom, LetsOnePageDragAndAnotherAfterIt) {
  const FakeScene scene;
  PageClient one = scene.page(), other = scene.page();
  one.send_text(grab);
  ASSERT_TRUE(comes_to(other, {{"grabbed_by", 1}}));
  other.send_text(grab);
  EXPECT_THAT(other.receive_text("error"), HasSubstr("another page"));
  other.send_text(R"({"type": "release"})");  // not its own
  for (std::uint32_t i = 1; i <= 50; ++i) one.drag(i, 0, 0, static_cast<float>(i));
  while (viewer::answered_drag(other.receive_frame()) != 50) {
  }
  one.send_text(R"({"type": "release"})");
  ASSERT_TRUE(comes_to(other, {{"grabbed_by", nullptr}}));
  other.send_text(grab);
  ASSERT_TRUE(comes_to(one, {{"grabbed_by", 2}}));
  one.drag(99, 0, 0, 0);  // too late
  other.drag(7, 0, 0, 0);
  while (viewer::answered_drag(one.receive_frame()) != 7) {
  }
}

TEST(LiveRoom, LetsGoWhenThePageThatHoldsLeaves) {
  const FakeScene scene;
  PageClient watching = scene.page();
  {
    PageClient holding = scene.page();
    holding.send_text(grab);
    holding.send_text(R"({"type": "poke", "center": [0, 0, 0], "radius": 1})");
    ASSERT_TRUE(comes_to(watching, {{"grabbed_by", 2}, {"poking", true}}));
  }
  EXPECT_TRUE(comes_to(watching, {{"grabbed_by", nullptr}, {"poking", false}}));
}

TEST(LiveRoom, TellsOnlyThePageThatErred) {
  const FakeScene scene;
  PageClient page = scene.page(), other = scene.page();
  page.send_text(R"({"type": "grab", "vertex": 100, "point": [0, 0, 0]})");
  EXPECT_THAT(page.receive_text("error"), HasSubstr("expected a number below 100, got 100"));
  page.send_text("no JSON");
  EXPECT_THAT(page.receive_text("error"), HasSubstr("got no JSON"));
  page.send_text(R"({"type": "set", "key": "speed", "value": 0})");
  EXPECT_THAT(page.receive_text("error"), HasSubstr("from 0.01 to 10, got 0"));
  page.send_binary(std::string(100, '\1'));
  EXPECT_THAT(page.receive_text("error"), HasSubstr("at most 64 bytes"));
  for (int i = 0; i < 20; ++i) {
    const auto message = other.receive();
    ASSERT_TRUE(message);
    if (viewer::is_frame(*message)) other.acknowledge(viewer::frame_number(message->bytes));
    EXPECT_EQ(message->bytes.find("\"error\""), std::string::npos);
  }
}

TEST(LiveRoom, AMessageThatIsTooLongEndsTheConnectionOfItsPageAlone) {
  const FakeScene scene;
  PageClient page = scene.page();
  PageClient other = scene.page();
  page.send_text(std::string(5000, ' '));
  EXPECT_THROW(page.receive_text("error"), std::runtime_error);
  EXPECT_GT(viewer::frame_number(other.receive_frame()), 0U);
}

TEST(LiveRoom, ReloadsAndKeepsTheOldSceneWhenTheNewOneIsBroken) {
  const FakeScene scene;
  PageClient page = scene.page(), other = scene.page();
  page.receive_text("hello");
  other.receive_text("hello");
  scene.switches->breaks_on_reload = true;
  page.send_text(R"({"type": "reload"})");
  EXPECT_THAT(page.receive_text("error"), HasSubstr("fake.toml: the scene is broken"));
  const int steps = scene.switches->num_steps;
  EXPECT_TRUE(comes_true([&] { return scene.switches->num_steps > steps; }));
  scene.switches->breaks_on_reload = false;
  page.send_text(R"({"type": "reload"})");
  EXPECT_EQ(next_json(other, "hello")["client"], 2);
  EXPECT_GT(viewer::frame_number(other.receive_frame()), 0U);
}

TEST(LiveRoom, AFaultInAStepIsToldToEveryPageAndPauses) {
  const FakeScene scene;
  PageClient page = scene.page(), other = scene.page();
  page.receive_frame();
  other.receive_frame();
  scene.switches->breaks_in_step = true;
  EXPECT_THAT(page.receive_text("error"), HasSubstr("a step broke"));
  EXPECT_THAT(other.receive_text("error"), HasSubstr("reset or reload"));
  scene.switches->breaks_in_step = false;
  page.send_text(R"({"type": "play"})");
  EXPECT_TRUE(comes_to(other, {{"paused", false}}));
  EXPECT_TRUE(scene.answers());
}

/// Where it waited for one of them, it would wait until the test is given up.
TEST(LiveRoom, EndsWithPagesInEveryState) {
  auto scene = std::make_unique<FakeScene>(2000000, patient());
  PageClient reading = scene->page(), unread = scene->page(), silent = scene->page();
  viewer::Socket half(scene->server.port());
  half.send("GET /live?tok");
  reading.receive_frame();
  silent.receive_frame(false);
  scene.reset();
  while (reading.receive()) {
  }
}

TEST(LiveRoom, ComesToRestInTheEndWhateverOrderPagesComeAndGo) {
  FakeScene scene;
  for (int i = 0; i < 50; ++i) {
    PageClient page = scene.page();
    if (i % 2 == 0) page.send_text(grab);
    if (i % 3 == 0) page.receive_frame(i % 2 == 0);
    if (i % 5 == 0) page.send_text(R"({"type": "reload"})");
  }
  PageClient last = scene.page();
  EXPECT_TRUE(comes_true([&] {
    last.send_text(R"({"type": "pin", "vertex": 0})");
    return scene.answers();
  }));
}

}  // namespace
}  // namespace resilin::viewer
