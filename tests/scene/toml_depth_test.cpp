// Scenes that are nested deeper than any parser should go: refused before one sees them.

#include "resilin/scene/toml_depth.hpp"

#include <gtest/gtest.h>

#include <random>

#include "resilin/scene/value.hpp"
#include "scene_text.hpp"

namespace resilin::testing {
namespace {

std::string repeated(const std::string& part, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += part;
  return text;
}

/// A way of writing `depth` levels.
struct Form {
  std::string name;
  std::string (*text)(int depth);
};

const std::vector<Form> forms = {
    {"dotted_key", [](int n) { return repeated("a.", n - 1) + "a = 1\n"; }},
    {"dotted_key_with_blanks", [](int n) { return repeated("a . ", n - 1) + "a = 1\n"; }},
    {"quoted_parts", [](int n) { return repeated("\"x.y\".", n - 1) + "'#' = 1\n"; }},
    {"header", [](int n) { return "[" + repeated("a.", n - 1) + "a]\n"; }},
    {"header_of_list", [](int n) { return "[[" + repeated("a.", n - 1) + "a]]\n"; }},
    {"lists", [](int n) { return "a = " + repeated("[", n) + repeated("]", n) + "\n"; }},
    {"lists_over_lines", [](int n) { return "a = " + repeated("[ # [[[\n", n) + repeated("]", n) + "\n"; }},
    {"tables", [](int n) { return "a = " + repeated("{ a = ", n) + "1" + repeated(" }", n) + "\n"; }},
    {"tables_with_keys", [](int n) { return repeated("a.b.c = { ", n / 3) + repeated("}", n / 3) + "\n"; }},
    {"header_and_key",
     [](int n) { return "[" + repeated("a.", n / 2) + "a]\n" + repeated("b.", n / 2) + "b = 1\n"; }},
    {"lists_of_tables",
     [](int n) { return "a = " + repeated("[{ b = ", n / 2) + "1" + repeated("}]", n / 2) + "\n"; }},
};

class EveryForm : public ::testing::TestWithParam<Form> {};

TEST_P(EveryForm, IsReadWhereItIsShallowAndRefusedWhereItIsDeep) {
  for (const int depth : {1, 2, 3, 6, 12, 20}) {
    const std::string text = GetParam().text(depth);
    EXPECT_EQ(input_error([&] { parse_toml(text, "s.toml"); }), "") << text;
  }
  for (const int depth : {200, 1000, 40000, 300000}) {
    for (const std::string before : {"", "x = 1\n", "y = \"\"\"\n[[[\n\"\"\"\n"}) {
      const std::string message = input_error([&] { parse_toml(before + GetParam().text(depth), "s.toml"); });
      EXPECT_NE(message.find("expected at most 64 levels"), message.npos) << depth << message;
      EXPECT_EQ(message.find('\n'), message.npos);
    }
    const std::string cut = GetParam().text(depth).substr(0, static_cast<std::size_t>(depth));
    EXPECT_NE(input_error([&] { parse_toml(cut, "s.toml"); }), "");
  }
}

INSTANTIATE_TEST_SUITE_P(TomlDepth, EveryForm, ::testing::ValuesIn(forms),
                         [](const auto& instance) { return instance.param.name; });

TEST(TomlDepth, NamesTheLine) {
  EXPECT_EQ(
      input_error([] { parse_toml("a = 1\nb = '''\n\n'''\n" + repeated("c.", 99) + "c = 1", "s.toml"); }),
      "s.toml:5: expected at most 64 levels of tables, lists and parts of a dotted key, got more");
}

/// Random documents with strings, comments and numbers in which brackets and dots mean nothing.
TEST(TomlDepth, CountsOnlyWhatNests) {
  std::mt19937 random(5);
  const std::vector<std::string> harmless = {"\"[[[{{{.....\"",
                                             "'[[[{{{\\'",
                                             "\"\\\"[[[ \\\\\"",
                                             "\"\"\"[\n[\n[\"\"\\\"\"\"\"",
                                             "'''{\n{{'''",
                                             "1.5",
                                             "-1.25e-3",
                                             "true",
                                             "\"\"",
                                             "''",
                                             "\"\"\"\"\"\"",
                                             "[1.0, 2.0, # [[[[\n 3.0]",
                                             "{ a.b = 1.5, c = [] }"};
  for (int i = 0; i < 200; ++i) {
    std::string text;
    for (int line = 0; line < 100; ++line) {
      const std::string key = "k" + std::to_string(line);
      if (random() % 10 == 0) text += "[t" + key + ".\"a.b.[\".c] # ]]] ...\n";
      if (random() % 10 == 0) text += "[[l" + key + ".d]]\r\n";
      text += key + (random() % 2 == 0 ? ".'x'.y = " : " = ") + harmless[random() % harmless.size()];
      text += random() % 3 == 0 ? " # [[[ {{{ ...\n" : "\n";
    }
    EXPECT_EQ(input_error([&] { parse_toml(text, "s.toml"); }), "") << text;
  }
}

/// Headers, keys and brackets in random turns: refused exactly where their sum is beyond the limit.
TEST(TomlDepth, AddsUpHeadersKeysAndBrackets) {
  std::mt19937 random(6);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    int depth = 0;
    std::string text, end;
    const auto add_key = [&](unsigned most) {
      const int parts = 1 + static_cast<int>(random() % most);
      text += repeated("k.", parts - 1) + "k";
      depth += parts;
    };
    if (random() % 2 == 0) {
      text += "[";
      add_key(20);
      text += "]\n";
      ++depth;
    }
    add_key(20);
    text += " = ";
    for (std::size_t brackets = 5 + random() % 30; brackets > 0; --brackets) {
      ++depth;
      if (random() % 2 == 0) {
        text += "[";
        end.insert(0, "]");
      } else {
        text += "{ ";
        end.insert(0, " }");
        add_key(4);
        text += " = ";
      }
    }
    const std::string message = input_error([&] { parse_toml(text + "1" + end + "\n", "s.toml"); });
    if (depth > deepest_nesting) ++refused;
    EXPECT_EQ(message.find("at most 64 levels") != message.npos, depth > deepest_nesting) << depth << text;
    if (depth <= deepest_nesting) {
      EXPECT_EQ(message, "") << text;
    }
  }
  EXPECT_GT(refused, 50);
  EXPECT_LT(refused, 250);
}

TEST(TomlDepth, BindsOverridesToo) {
  const std::string deep = repeated("a.", 40000) + "a=1";
  const std::string message = error_with({deep});
  EXPECT_NE(message.find("expected at most 64 parts in KEY, got 40001"), message.npos) << message;
  EXPECT_NE(error_with({"title=" + repeated("[", 40000)}), "");
}

}  // namespace
}  // namespace resilin::testing
