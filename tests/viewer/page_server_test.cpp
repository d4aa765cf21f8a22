#include "viewer/page_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "fake_scene.hpp"
#include "resilin/core/error.hpp"
#include "temporary_folder.hpp"
#include "viewer/page_client.hpp"

namespace resilin::viewer {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using viewer::exchange;
using viewer::request_text;

struct PageServerTest : ::testing::Test {
  const testing::TemporaryFolder folder;
  const std::filesystem::path recording = folder.write("recording.bin", std::string(3000000, 'r'));
  ServerOptions options;
  std::unique_ptr<PageServer> server = serve();

  std::unique_ptr<PageServer> serve() const {
    const std::map<std::string, Resource> resources = {
        {"/", {"text/html; charset=utf-8", std::make_shared<const std::string>("<p>the page</p>"), "n0nce"}},
        {"/recording", {"application/octet-stream", recording, {}}},
        {"/lost", {"application/json", folder / "lost", {}}},
        {"/take", {"text/plain", TakeBytes(take), {}}}};
    return std::make_unique<PageServer>(options, resources, nullptr);
  }

  /// Says how much it got.
  static std::string take(std::string_view, std::string bytes) {
    if (bytes == "bad") throw InputError("sent", "something good", "bad");
    return std::to_string(bytes.size()) + " bytes";
  }
  std::string own_origin() const {
    return "Origin: http://127.0.0.1:" + std::to_string(server->port()) + "\r\n";
  }
  std::string post(const std::string& headers, const std::string& body) const {
    return ask("POST /take?token=" + server->token() + " HTTP/1.1\r\n" + host() + headers + "\r\n" + body);
  }

  std::string get(const std::string& path, const std::string& headers = {}) const {
    return exchange(server->port(),
                    request_text(server->port(), path + "?token=" + server->token(), headers));
  }
  std::string ask(const std::string& request) const { return exchange(server->port(), request); }
  std::string host() const { return "Host: 127.0.0.1:" + std::to_string(server->port()) + "\r\n"; }
};

TEST_F(PageServerTest, ServesThePageWithHeadersThatKeepOthersOut) {
  const std::string answer = get("/");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(answer, HasSubstr("\r\n\r\n<p>the page</p>"));
  for (const char* header :
       {"Content-Security-Policy: default-src 'none'; script-src 'nonce-n0nce';", "frame-ancestors 'none'",
        "X-Content-Type-Options: nosniff", "Referrer-Policy: no-referrer", "Cache-Control: no-store",
        "Content-Type: text/html; charset=utf-8", "Content-Length: 15", "Connection: close"}) {
    EXPECT_THAT(answer, HasSubstr(header));
  }
  EXPECT_THAT(answer, HasSubstr("ws://127.0.0.1:" + std::to_string(server->port())));
  EXPECT_THAT(answer, Not(HasSubstr("Access-Control")));
}

TEST_F(PageServerTest, TakesWhatItsOwnPageSendsAndNothingElse) {
  const auto length = [](std::size_t size) { return "Content-Length: " + std::to_string(size) + "\r\n"; };
  const std::string large(1000000, 'x');
  EXPECT_THAT(post(own_origin() + length(large.size()), large), HasSubstr("\r\n\r\n1000000 bytes"));
  EXPECT_THAT(post(own_origin() + length(0), ""), HasSubstr("\r\n\r\n0 bytes"));
  EXPECT_THAT(post(own_origin() + "Transfer-Encoding: chunked\r\n", "3\r\nabc\r\n0\r\n\r\n"),
              HasSubstr("\r\n\r\n3 bytes"));
  const std::string refused = post(own_origin() + length(3), "bad");
  EXPECT_THAT(refused, StartsWith("HTTP/1.1 422"));
  EXPECT_THAT(refused, HasSubstr("sent: expected something good, got bad"));
  EXPECT_THAT(post(length(3), "abc"), StartsWith("HTTP/1.1 403")) << "without an origin";
  EXPECT_THAT(post("Origin: http://example.org\r\n" + length(3), "abc"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get("/take"), StartsWith("HTTP/1.1 405"));
  const std::string other =
      "POST /recording?token=" + server->token() + " HTTP/1.1\r\n" + host() + own_origin();
  EXPECT_THAT(ask(other + "\r\n"), StartsWith("HTTP/1.1 405"));
  options.max_sent_bytes = 1 << 20;
  server = serve();
  const std::string too_large = post(own_origin() + length((1 << 20) + 1), "");
  EXPECT_THAT(too_large, StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(too_large, HasSubstr("larger than 1 MiB"));
  EXPECT_THAT(get("/"), StartsWith("HTTP/1.1 200")) << "it goes on";
}

TEST_F(PageServerTest, ServesAFileWhole) {
  const std::string answer = get("/recording");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(answer.ends_with("\r\n\r\n" + std::string(3000000, 'r')));
  EXPECT_THAT(get("/lost"), StartsWith("HTTP/1.1 404"));
}

TEST_F(PageServerTest, RefusesWhoDoesNotBelongHere) {
  const std::string token = "?token=" + server->token();
  const std::string line = "GET /" + token + " HTTP/1.1\r\n";
  for (const std::string& request :
       {request_text(server->port(), "/"),
        request_text(server->port(), "/?token=00000000000000000000000000000000"),
        request_text(server->port(), "/recording"), line + "\r\n", line + "Host: example.org\r\n\r\n",
        line + host() + "Host: example.org\r\n\r\n", line + host() + host() + "\r\n",
        line + host() + "Origin: http://example.org\r\n\r\n", line + host() + "Origin: null\r\n\r\n",
        request_text(server->port(), "/nothing/here")}) {
    const std::string answer = ask(request);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 403")) << request;
    EXPECT_THAT(answer, Not(HasSubstr("the page"))) << request;
    EXPECT_THAT(answer, Not(HasSubstr(server->token()))) << request;
  }
}

TEST_F(PageServerTest, AnswersWhatItDoesNotServeInOneLine) {
  const std::string target = "/?token=" + server->token() + " HTTP/1.1\r\n" + host();
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"GET /nothing?token=" + server->token() + " HTTP/1.1\r\n" + host() + "\r\n", "HTTP/1.1 404"},
      {"DELETE " + target + "\r\n", "HTTP/1.1 405"},
      {"HEAD " + target + "\r\n", "HTTP/1.1 405"},
      {"GET " + target + "Content-Length: 5\r\n\r\nhello", "HTTP/1.1 431"},
      {"GET " + target + "X: " + std::string(20000, 'x') + "\r\n\r\n", "HTTP/1.1 431"},
      {"GET /" + std::string(20000, 'x') + " HTTP/1.1\r\n\r\n", "HTTP/1.1 431"},
      {"what is this\r\n\r\n", "HTTP/1.1 400"},
      {"GET / HTTP/7.0\r\n\r\n", "HTTP/1.1 400"},
      {"\x16\x03\x01\x02\x01\x01\x01\r\n\r\n", "HTTP/1.1 400"},
  };
  for (const auto& [request, expected] : cases) {
    const std::string answer = ask(request);
    EXPECT_THAT(answer, StartsWith(expected)) << request.substr(0, 80);
  }
  EXPECT_THAT(get("/"), StartsWith("HTTP/1.1 200"));
}

TEST_F(PageServerTest, RefusesAWebSocketWhereThereIsNoLiveScene) {
  EXPECT_THROW(viewer::PageClient(server->port(), server->token()), std::runtime_error);
  EXPECT_THAT(get("/live"), StartsWith("HTTP/1.1 404"));
}

TEST_F(PageServerTest, EndsARequestThatDoesNotComeToItsEnd) {
  options.request_timeout = std::chrono::milliseconds(300);
  server = serve();
  viewer::Socket slow(server->port());
  slow.send("GET / HT");
  EXPECT_EQ(slow.receive(), "");
  viewer::Socket silent(server->port());
  EXPECT_EQ(silent.receive(), "");
  // A busy machine may need longer than this for a request that is whole.
  EXPECT_TRUE(comes_true([this] { return get("/").starts_with("HTTP/1.1 200"); }));
}

/// A client without the token can hold nothing up, however much of a request has come.
TEST_F(PageServerTest, ConnectionsThatAskForNothingKeepNobodyOut) {
  const std::string whole = request_text(server->port(), "/?token=" + std::string(32, '0'));
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{9}, whole.size() / 2, whole.size() - 1}) {
    std::vector<viewer::Socket> sockets;
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 3 * options.max_connections; ++i) {
      sockets.emplace_back(server->port());
      sockets.back().send(whole.substr(0, size));
      if (i % 7 > 0) continue;
      EXPECT_THAT(get("/"), StartsWith("HTTP/1.1 200")) << i << " after " << size;
    }
    EXPECT_THAT(get("/recording"), StartsWith("HTTP/1.1 200"));
    // Well before any of the silent ones has run out of time.
    EXPECT_LT(std::chrono::steady_clock::now() - start, options.request_timeout);
  }
}

TEST_F(PageServerTest, TheOldestOfThoseThatAskForNothingMakesRoom) {
  options.max_connections = 3;
  server = serve();
  std::vector<viewer::Socket> sockets;
  for (int i = 0; i < 3; ++i) {
    sockets.emplace_back(server->port());
    EXPECT_TRUE(comes_true([&] { return sockets.back().send("GET "); }));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // so that they come one after another
  }
  EXPECT_THAT(get("/"), StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(sockets[0].receive(), "") << "the oldest is closed";
  sockets[2].send("/?token=" + server->token() + " HTTP/1.1\r\n" + host() + "\r\n");
  EXPECT_THAT(sockets[2].receive(), StartsWith("HTTP/1.1 200")) << "the newest is not";
}

TEST_F(PageServerTest, SaysThatThePortIsInUse) {
  options.port = server->port();
  try {
    const PageServer second(options, {}, nullptr);
    FAIL() << "two servers on one port";
  } catch (const InputError& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "port " + std::to_string(server->port()) +
            ": expected a free one on 127.0.0.1, got one that another program listens on; end that program, "
            "choose another port, or let --port 0 find a free one");
  }
}

TEST_F(PageServerTest, GivesItsPortBackAtOnce) {
  // Another program may be given the port in between, but not again and again.
  EXPECT_TRUE(comes_true([this] {
    options.port = 0;
    server = serve();
    options.port = server->port();
    get("/");
    server.reset();
    try {
      server = serve();
    } catch (const InputError&) {
      return false;
    }
    return server->port() == options.port;
  }));
  EXPECT_EQ(server->address(),
            "http://127.0.0.1:" + std::to_string(options.port) + "/?token=" + server->token());
}

TEST_F(PageServerTest, EndsWhileRequestsAreUnderWay) {
  std::vector<viewer::Socket> sockets;
  for (int i = 0; i < 8; ++i) {
    sockets.emplace_back(server->port());
    sockets.back().send(request_text(server->port(), "/recording?token=" + server->token()));
  }
  server.reset();
}

}  // namespace
}  // namespace resilin::viewer
