#include "viewer/access.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace resilin::viewer {
namespace {

const std::string token = "0123456789abcdef0123456789abcdef";
constexpr std::uint16_t port = 8765;

bool passes(RequestOrigin request) { return why_forbidden(request, port, token).empty(); }

RequestOrigin good_request() {
  return {.target = "/?token=0123456789abcdef0123456789abcdef", .host = "127.0.0.1:8765"};
}

TEST(Token, IsThirtyTwoDigitsAndAnotherOneEachTime) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) {
    const std::string made = make_token();
    EXPECT_EQ(made.size(), 32U);
    EXPECT_EQ(made.find_first_not_of("0123456789abcdef"), std::string::npos);
    tokens.insert(made);
  }
  EXPECT_EQ(tokens.size(), 100U);
}

TEST(Token, IsComparedWhole) {
  EXPECT_TRUE(is_same_token(token, token));
  EXPECT_FALSE(is_same_token("", token));
  EXPECT_FALSE(is_same_token(token.substr(1), token));
  EXPECT_FALSE(is_same_token(token + "0", token));
  for (std::size_t i = 0; i < token.size(); ++i) {
    std::string other = token;
    other[i] = other[i] == '0' ? '1' : '0';
    EXPECT_FALSE(is_same_token(other, token)) << i;
  }
}

TEST(Target, IsTakenApart) {
  EXPECT_EQ(parse_target("/").path, "/");
  EXPECT_EQ(parse_target("/").token, "");
  EXPECT_EQ(parse_target("/live?token=ab").path, "/live");
  EXPECT_EQ(parse_target("/live?token=ab").token, "ab");
  EXPECT_EQ(parse_target("/?view=1&token=ab&x").token, "ab");
  EXPECT_EQ(parse_target("/?nottoken=ab").token, "");
  EXPECT_EQ(parse_target("").path, "");
  EXPECT_EQ(parse_target("?&&=&token=").token, "");
}

TEST(Access, IsForThePagesOfThisServer) {
  EXPECT_TRUE(passes(good_request()));
  RequestOrigin request = good_request();
  request.host = "localhost:8765";
  EXPECT_TRUE(passes(request));
  request.origin = "http://localhost:8765";
  EXPECT_TRUE(passes(request));
  request.needs_origin = true;
  EXPECT_TRUE(passes(request));
}

TEST(Access, IsRefusedToOtherHosts) {
  for (const char* host :
       {"", "127.0.0.1", "127.0.0.1:8766", "example.org:8765", "127.0.0.1:8765.example.org",
        "127.0.0.1.example.org:8765", "localhost", "[::1]:8765"}) {
    RequestOrigin request = good_request();
    request.host = host;
    EXPECT_FALSE(passes(request)) << host;
  }
  RequestOrigin request = good_request();
  request.host.reset();
  EXPECT_FALSE(passes(request));
}

TEST(Access, IsRefusedToPagesFromElsewhere) {
  for (const char* origin :
       {"", "null", "http://example.org", "http://example.org:8765", "https://127.0.0.1:8765",
        "http://127.0.0.1:80", "http://127.0.0.1", "http://127.0.0.1:8765.example.org",
        "http://localhost:8765@example.org", "file://"}) {
    for (const bool is_websocket : {false, true}) {
      RequestOrigin request = good_request();
      request.origin = origin;
      request.needs_origin = is_websocket;
      EXPECT_FALSE(passes(request)) << origin;
    }
  }
}

TEST(Access, OfAWebSocketNeedsAnOrigin) {
  RequestOrigin request = good_request();
  request.needs_origin = true;
  EXPECT_FALSE(passes(request));
}

TEST(Access, IsRefusedWithoutTheToken) {
  for (const char* target :
       {"/", "/?token=", "/?token=0123456789abcdef0123456789abcdeF",
        "/?Token=0123456789abcdef0123456789abcdef", "/0123456789abcdef0123456789abcdef"}) {
    RequestOrigin request = good_request();
    request.target = target;
    EXPECT_FALSE(passes(request)) << target;
  }
}

TEST(Access, IsRefusedInOneLineThatSaysWhatToDo) {
  RequestOrigin request = good_request();
  request.target = "/";
  const std::string why = why_forbidden(request, port, token);
  EXPECT_NE(why.find("token"), std::string::npos);
  EXPECT_EQ(std::ranges::count(why, '\n'), 0);
  EXPECT_EQ(why.find(token), std::string::npos);
}

}  // namespace
}  // namespace resilin::viewer
