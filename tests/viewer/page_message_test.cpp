#include "viewer/page_message.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "resilin/core/error.hpp"

namespace resilin::viewer {
namespace {

using ::testing::HasSubstr;

template <class Message>
Message read_as(std::string_view text) {
  return std::get<Message>(read_text_message(text));
}

/// The one line with which a message is refused; empty when it is not.
template <class Read>
std::string refusal_of(Read read) {
  try {
    read();
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

std::string refusal(std::string_view text) {
  return refusal_of([text] { read_text_message(text); });
}

std::string drag_bytes(std::uint32_t number, float x, float y, float z) {
  std::string bytes("\2\0\0\0", 4);
  bytes.resize(20);
  std::memcpy(bytes.data() + 4, &number, 4);
  for (std::size_t i = 0; const float coordinate : {x, y, z})
    std::memcpy(bytes.data() + 8 + 4 * i++, &coordinate, 4);
  return bytes;
}

TEST(PageMessage, OfEachTypeIsRead) {
  const auto grab = read_as<Grab>(R"({"type": "grab", "vertex": 17, "point": [1, 2.5, -3e-2]})");
  EXPECT_EQ(grab.vertex, 17U);
  EXPECT_EQ(grab.point, Vector3(1, 2.5, -0.03));
  read_as<Release>(R"({"type":"release"})");
  EXPECT_EQ(read_as<Pin>(R"({"vertex": 4294967295, "type": "pin"})").vertex, 4294967295U);
  EXPECT_EQ(read_as<Unpin>(R"({"type": "unpin", "vertex": 0})").vertex, 0U);
  read_as<UnpinAll>(R"({"type": "unpin_all"})");
  EXPECT_EQ(read_as<Poke>(R"({"type": "poke", "center": [0, 0, 0], "radius": 0.1})").radius, 0.1);
  const auto hold =
      read_as<HoldFace>(R"({"type": "hold", "vertex": 3, "point": [1, 2, 3], "angle": 30, "radius": 0})");
  EXPECT_EQ(hold.vertex, 3U);
  EXPECT_EQ(hold.point, Vector3(1, 2, 3));
  EXPECT_EQ(hold.reach.angle, 30);
  read_as<FreeFaces>(R"({"type": "free_faces"})");
  const auto load = read_as<LoadFace>(
      R"({"type": "load", "vertex": 3, "point": [1, 2, 3], "angle": 30, "radius": 0, "kind": "pressure", "value": -5})");
  EXPECT_EQ(load.face.vertex, 3U);
  EXPECT_EQ(load.choice.kind, FaceLoadChoice::Kind::pressure);
  EXPECT_EQ(load.choice.value, -5);
  read_as<RemoveLoads>(R"({"type": "remove_loads"})");
  read_as<Settle>(R"({"type": "settle"})");
  EXPECT_EQ(read_as<SetControl>(R"({"type": "set", "key": "youngs_modulus", "value": 1e5, "body": 2})").body,
            2U);
  EXPECT_FALSE(read_as<SetControl>(R"({"type": "set", "key": "youngs_modulus", "value": 1e5})").body);
  read_as<SaveScene>(R"({"type": "save"})");
  read_as<PokeEnd>(R"({"type": "poke_end"})");
  EXPECT_EQ(read_as<ChooseField>(R"({"type": "field", "name": ""})").name, "");
  EXPECT_EQ(read_as<ChooseField>(R"({"type": "field", "name": "", "arrows": "velocity"})").arrows,
            "velocity");
  read_as<Pause>(R"({"type": "pause"})");
  read_as<Play>(R"({"type": "play"})");
  read_as<SingleStep>(R"({"type": "step"})");
  read_as<Reset>(R"({"type": "reset"})");
  read_as<Reload>(R"({"type": "reload"})");
}

TEST(PageMessage, SetsEachControlToItsKindOfValue) {
  for (const LiveControl& control : live_control_table()) {
    const std::string key(control.key);
    const std::string begin = R"({"type": "set", "key": ")" + key + R"(", "value": )";
    // Values of all kinds, in the order of ControlValue.
    const std::vector<std::string> values = {"0.5", "true", R"("gent")", "[0, 0, 1]"};
    const std::size_t own = value_of(control, LiveControls{}).index();
    for (std::size_t kind = 0; kind < values.size(); ++kind) {
      SCOPED_TRACE(key + " = " + values[kind]);
      const std::string text = begin + values[kind] + "}";
      if (kind != own) {
        EXPECT_THAT(refusal(text), HasSubstr("message \"set\": value: expected"));
        continue;
      }
      const auto set = read_as<SetControl>(text);
      EXPECT_EQ(set.control, &control);
      EXPECT_EQ(set.value.index(), own);
    }
  }
  const auto gravity = read_as<SetControl>(R"({"type":"set","key":"gravity","value":[0,0,1]})");
  EXPECT_EQ(std::get<Vector3>(gravity.value), Vector3(0, 0, 1));
}

TEST(PageMessage, ThatIsWrongIsRefusedInOneLineThatSaysWhatWasExpected) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "one object of JSON with a \"type\", got no JSON"},
      {"{", "got no JSON"},
      {"[1, 2]", "got [1,2]"},
      {"17", "got 17"},
      {R"({"type": "hold", "vertex": 3, "point": [1, 2, 3], "angle": 181, "radius": 0})",
       "message \"hold\": angle: expected degrees from 0 to 180, got 181"},
      {R"({"type": "hold", "vertex": 3, "point": [1, 2, 3], "angle": 1, "radius": -1})",
       "message \"hold\": radius: expected a number >= 0, got -1"},
      {"{}", "message: type: expected one of field, free_faces, grab"},
      {R"({"type": 3})", "got 3"},
      {R"({"type": "grap"})", "did you mean \"grab\"?"},
      {R"({"type": "grab", "point": [0, 0, 0]})",
       "\"grab\": vertex: expected a whole number from 0, got none"},
      {R"({"type": "grab", "vertex": 1})", "point: expected three finite numbers, got none"},
      {R"({"type": "grab", "vertex": -1, "point": [0, 0, 0]})", "got -1"},
      {R"({"type": "grab", "vertex": 1.5, "point": [0, 0, 0]})", "got 1.5"},
      {R"({"type": "grab", "vertex": 4294967296, "point": [0, 0, 0]})", "got 4294967296"},
      {R"({"type": "grab", "vertex": "1", "point": [0, 0, 0]})", "got \"1\""},
      {R"({"type": "grab", "vertex": 1, "point": [0, 0]})", "got [0,0]"},
      {R"({"type": "grab", "vertex": 1, "point": [0, 0, null]})", "got [0,0,null]"},
      {R"({"type": "grab", "vertex": 1, "point": [0, 0, NaN]})", "no JSON"},
      {R"({"type": "grab", "vertex": 1, "point": [0, 0, 1e999]})", "no JSON"},
      {R"({"type": "grab", "vertex": 1, "point": [0, 0, 0], "force": 3})",
       "expected the keys type, vertex, point"},
      {R"({"type": "release", "hand": 1})", "got \"hand\""},
      {R"({"type": "poke", "center": [0, 0, 0], "radius": 0})", "radius: expected a positive number, got 0"},
      {R"({"type": "poke", "center": [0, 0, 0], "radius": -1})", "got -1"},
      {R"({"type": "set", "key": "youngs_modulos", "value": 1})", "did you mean \"youngs_modulus\"?"},
      {R"({"type": "set", "key": "paused", "value": true})",
       "message \"set\": key: expected one of law, youngs_modulus"},
      {R"({"type": "set", "key": "law", "value": 3})", "a text, got 3"},
      {R"({"type": "set", "key": "ground", "value": 1})", "true or false, got 1"},
      {R"({"type": "set", "key": "gravity", "value": -9.81})", "three finite numbers, got -9.81"},
      {R"({"type": "set", "key": "speed"})", "\"set\": value: expected a finite number, got none"},
      {R"({"type": "field", "name": 3})", "a text, got 3"},
      {R"({"type": "field", "name": "", "arrows": 3})", "arrows: expected a text, got 3"},
  };
  for (const auto& [text, expected] : cases) {
    const std::string why = refusal(text);
    EXPECT_THAT(why, HasSubstr(expected)) << text;
    EXPECT_EQ(std::ranges::count(why, '\n'), 0) << why;
  }
}

TEST(PageMessage, IsQuotedShortAndOnOneLineWhateverItHolds) {
  const std::string long_text(3000, 'x');
  EXPECT_LT(refusal(R"({"type": ")" + long_text + R"("})").size(), 400U);
  EXPECT_LT(refusal(R"({"type": "set", "key": "law", "value": [")" + long_text + R"("]})").size(), 200U);
  const std::string why = refusal(R"({"type": "a\nb\u0000\u001b[31m"})");
  EXPECT_EQ(why.find_first_of("\n\x1b"), std::string::npos) << why;
  EXPECT_EQ(why.find('\0'), std::string::npos);
  EXPECT_NE(refusal(std::string(4096, '[')), "");
}

TEST(BinaryMessage, IsAnAcknowledgementOrADrag) {
  EXPECT_EQ(std::get<Acknowledge>(read_binary_message(std::string_view("\1\0\0\0\7\1\0\0", 8))).frame, 263U);
  const auto drag = std::get<Drag>(read_binary_message(drag_bytes(9, 1, 2, -3)));
  EXPECT_EQ(drag.number, 9U);
  EXPECT_EQ(drag.target, Vector3(1, 2, -3));
}

TEST(BinaryMessage, OfAnotherSizeOrWithoutNumbersIsRefused) {
  const std::string good = drag_bytes(1, 0, 0, 0);
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_NE(refusal_of([&] { read_binary_message(std::string_view(good).substr(0, size)); }), "") << size;
  }
  EXPECT_NE(refusal_of([&] { read_binary_message(good + '\0'); }), "");
  std::string padded = good;
  padded[2] = 1;
  EXPECT_NE(refusal_of([&] { read_binary_message(padded); }), "");
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    EXPECT_THAT(refusal_of([&] { read_binary_message(drag_bytes(1, 0, bad, 0)); }),
                HasSubstr("three finite numbers"));
  }
}

}  // namespace
}  // namespace resilin::viewer
