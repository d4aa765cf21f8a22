#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <variant>

#include "resilin/core/error.hpp"
#include "resilin/scene/value.hpp"
#include "shared_data.hpp"

namespace resilin {
namespace {

/// All but the places where the values came from.
bool is_same(const SceneValue& a, const SceneValue& b) {
  if (a.data.index() != b.data.index()) return false;
  if (a.is_array()) {
    if (a.array().size() != b.array().size()) return false;
    for (std::size_t i = 0; i < a.array().size(); ++i)
      if (!is_same(a.array()[i], b.array()[i])) return false;
    return true;
  }
  if (a.is_table()) {
    if (a.table().size() != b.table().size()) return false;
    for (const SceneMember& member : a.table()) {
      const SceneValue* other = b.find(member.key);
      if (other == nullptr || !is_same(member.value, *other)) return false;
    }
    return true;
  }
  const auto has_same = [&]<class Plain>(Plain) {
    const auto *mine = std::get_if<Plain>(&a.data), *other = std::get_if<Plain>(&b.data);
    return mine != nullptr && *mine == *other;
  };
  return has_same(bool()) || has_same(std::int64_t()) || has_same(double()) || has_same(std::string());
}

void expect_survives(const std::string& text) {
  const SceneValue scene = parse_toml(text, "first.toml");
  const std::string written = toml_text(scene);
  EXPECT_TRUE(is_same(scene, parse_toml(written, "second.toml"))) << written;
}

TEST(TomlWriter, WritesValuesThatReadBackTheSame) {
  expect_survives(R"(title = "quotes \" and \\ and \u0007 and é"
empty = []
[a."key with blanks"]
x = [1, 2.0, -0.0, 1e300, 123456789.125, true]
y = { z = "in", w = [{ a = 1 }, { b = [[1, 2], [3, 4]] }] }
[[body]]
mesh = { box = { size = [1, 1, 1], cells = [2, 2, 2] } }
[[body]]
)");
  std::string many = "[[fix]]\nwhere = { vertices = [";
  for (int i = 0; i < 1000; ++i) many += std::to_string(i * 97) + ", ";
  expect_survives(many + "] }\n");
  for (const char* folder : {"examples", "tests/scene/scenes"})
    for (const auto& entry : std::filesystem::directory_iterator(testing::source_folder() / folder)) {
      if (entry.path().extension() != ".toml") continue;
      std::ifstream stream(entry.path());
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      try {
        parse_toml(text, "any");
      } catch (const InputError&) {
        continue;  // one that is broken on purpose
      }
      expect_survives(text);
    }
}

TEST(TomlWriter, KeepsLinesShortAndSectionsInTheirUsualOrder) {
  const std::string text =
      toml_text(parse_toml("fix = [{ where = \"all\" }]\nbody = [{ name = \"b\", mesh = \"m\" }]\ntitle = "
                           "\"T\"\nsimulation = {}\n",
                           "s"));
  EXPECT_EQ(
      text,
      "title = \"T\"\n\n[simulation]\n\n[[body]]\nname = \"b\"\nmesh = \"m\"\n\n[[fix]]\nwhere = \"all\"\n");
}

}  // namespace
}  // namespace resilin
