#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "fake_scene.hpp"

namespace resilin::viewer {
namespace {

using viewer::PageClient;
using viewer::Socket;

/// Random bytes, and good messages with random faults; the same at every run.
class Faults {
 public:
  explicit Faults(std::uint32_t seed) : random_(seed) {}

  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }

  std::string bytes(std::size_t size) {
    std::string bytes(size, '\0');
    for (char& byte : bytes) byte = static_cast<char>(below(256));
    return bytes;
  }

  /// One to four changes: a byte is turned, left out, doubled, or a piece of another good message put in.
  std::string mutated(std::string text, const std::vector<std::string>& pieces) {
    for (std::size_t n = 1 + below(4); n > 0; --n) {
      const std::size_t at = below(text.size() + 1);
      switch (below(5)) {
        case 0:
          if (at < text.size()) text[at] = static_cast<char>(below(below(20) == 0 ? 256 : 128));
          break;
        case 1:
          text.erase(at, 1 + below(8));
          break;
        case 2:
          text.insert(at, text.substr(at, 1 + below(16)));
          break;
        case 3:
          text.insert(at, pieces[below(pieces.size())]);
          break;
        default:
          text.resize(at);
      }
    }
    return text;
  }

 private:
  std::mt19937 random_;
};

const std::vector<std::string>& good_texts() {
  static const std::vector<std::string> texts = {
      R"({"type": "grab", "vertex": 17, "point": [0.1, 0.2, 0.3]})",
      R"({"type": "release"})",
      R"({"type": "pin", "vertex": 17})",
      R"({"type": "unpin_all"})",
      R"({"type": "poke", "center": [0, 0, 0], "radius": 0.1})",
      R"({"type": "poke_end"})",
      R"({"type": "set", "key": "youngs_modulus", "value": 1e5})",
      R"({"type": "set", "key": "gravity", "value": [0, -9.81, 0]})",
      R"({"type": "set", "key": "law", "value": "stable_neo_hookean"})",
      R"({"type": "field", "name": "von_mises"})",
      R"({"type": "field", "name": "", "arrows": "velocity"})",
      R"({"type": "step"})",
      R"({"type": "reset"})",
  };
  return texts;
}

const std::vector<std::string>& pieces() {
  static const std::vector<std::string> pieces = {
      "\"type\":",  "1e999", "-0",     "null", "[[[[", "}}",   "\\ud800", "\xff\xfe",
      "\"vertex\"", "NaN",   "1e-400", ",",    ":",    "\"\"", "\n",      "18446744073709551616"};
  return pieces;
}

/// One message of a page, mostly wrong.
void send_message(PageClient& page, Faults& faults) {
  const std::string drag = std::string("\2\0\0\0", 4) + faults.bytes(16);
  const std::string acknowledgement = std::string("\1\0\0\0", 4) + faults.bytes(4);
  switch (faults.below(4)) {
    case 0:
      page.send_binary(
          faults.mutated(faults.below(2) == 0 ? drag : acknowledgement, {"\0", "\x7f\x80", "\xff\xff"}));
      break;
    case 1:
      page.send_binary(faults.bytes(faults.below(80)));
      break;
    default:
      page.send_text(faults.mutated(good_texts()[faults.below(good_texts().size())], pieces()));
  }
}

std::string upgrade_request(const FakeScene& scene) {
  const std::string port = std::to_string(scene.server.port());
  return viewer::request_text(
      scene.server.port(), "/live?token=" + scene.server.token(),
      "Origin: http://127.0.0.1:" + port +
          "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
          "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n");
}

/// Counts what arrives: a page whose text is no UTF-8 is sent away, and what it says after that does not
/// count.
class CountingRoom : public LiveRoom {
 public:
  using LiveRoom::LiveRoom;
  void received(ClientId client, bool is_text, std::string_view bytes) override {
    ++num_received;
    LiveRoom::received(client, is_text, bytes);
  }
  std::atomic<int> num_received = 0;
};

TEST(Fuzz, TheServerStandsAHundredThousandMessagesAndAnswersAfterwards) {
  constexpr int num_messages = 100000, per_page = 50;
  Mailbox mailbox;
  CountingRoom room(mailbox);
  PageServer server({}, {}, &room);
  const auto switches = std::make_shared<FakeSwitches>();
  const LiveLoop loop(std::make_unique<FakeServedScene>(switches, 100), mailbox,
                      [&server] { server.wake(); });
  Faults faults(1);
  while (room.num_received < num_messages) {
    PageClient page(server.port(), server.token());
    for (int i = 0; i < per_page; ++i) send_message(page, faults);
    page.socket().finish_sending();  // closed at once, what is under way would be lost
    page.socket().receive_all();
  }
  PageClient page(server.port(), server.token());
  page.receive_text("hello");
  EXPECT_GT(viewer::frame_number(page.receive_frame()), 0U);
  const int steps = switches->num_steps;
  page.send_text(R"({"type": "step"})");
  EXPECT_TRUE(comes_true([&] { return switches->num_steps > steps; }));
}

TEST(Fuzz, TheServerStandsBytesThatAreNoWebSocketFrames) {
  const FakeScene scene;
  Faults faults(2);
  for (int i = 0; i < 300; ++i) {
    Socket socket(scene.server.port());
    socket.send(upgrade_request(scene));
    if (i % 2 == 0) socket.receive(1024);
    socket.send(faults.bytes(1 + faults.below(2000)));
    if (i % 3 == 0) socket.receive(1024);
  }
  EXPECT_TRUE(comes_true([&] { return scene.answers(); }));
}

TEST(Fuzz, TheServerStandsRequestsThatAreNone) {
  const FakeScene scene;
  Faults faults(3);
  const std::string page = viewer::request_text(scene.server.port(), "/?token=" + scene.server.token());
  const std::string live = upgrade_request(scene);
  for (int i = 0; i < 2000; ++i) {
    Socket socket(scene.server.port());
    if (i % 4 == 0) {
      socket.send(faults.bytes(faults.below(500)));
    } else {
      socket.send(faults.mutated(i % 2 == 0 ? page : live,
                                 {"\r\n", "\r\n\r\n", ": ", "HTTP/1.1", "Content-Length: 9\r\n",
                                  "Transfer-Encoding: chunked\r\n", "websocket", "\t"}));
    }
  }
  EXPECT_TRUE(comes_true([&] { return scene.answers(); }));
}

TEST(Fuzz, ConnectionsThatBreakOffAreForgotten) {
  const FakeScene scene;
  const std::string request = upgrade_request(scene);
  for (std::size_t end = 0; end <= request.size(); end += 3) {
    Socket socket(scene.server.port());
    socket.send(request.substr(0, end));
  }
  EXPECT_TRUE(comes_true([&] { return scene.answers(); }));
}

}  // namespace
}  // namespace resilin::viewer
