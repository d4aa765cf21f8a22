// Each kind of load has its own keys and no others.

#include <gtest/gtest.h>

#include <algorithm>

#include "resilin/scene/tables.hpp"
#include "resilin/world/load_catalog.hpp"
#include "scene_text.hpp"

namespace resilin::testing {
namespace {

/// A value that a key of a load may have, by the type in its reference.
std::string sample_value(const LoadKind& kind, const std::string& key) {
  if (key == "value") return kind.has_number(3) ? "1" : "[0, 0, 1]";
  for (const auto& row : load_keys())
    if (row.doc.name == key)
      return row.doc.type.starts_with("number") ? "1" : row.doc.type == "vector" ? "[0, 0, 1]" : "\"all\"";
  ADD_FAILURE() << kind.name << " has the key " << key << ", which is none of a load";
  return "1";
}

/// The message when the scene's load is of this kind, with these keys.
std::string error_of(const LoadKind& kind, const std::vector<std::string>& keys) {
  std::string load = "[[load]]\nkind = \"" + kind.name + "\"\n";
  for (const std::string& key : keys) load += key + " = " + sample_value(kind, key) + "\n";
  const std::size_t begin = good_scene.find("[[load]]"), end = good_scene.find("[[probe]]");
  const std::string text = good_scene.substr(0, begin) + load + good_scene.substr(end);
  return input_error([&] { read_text(text); });
}

bool has_key(const LoadKind& kind, const std::string& key) {
  const auto is_in = [&key](const std::vector<std::string>& keys) {
    return std::ranges::find(keys, key) != keys.end();
  };
  return is_in(kind.needs) || is_in(kind.has);
}

TEST(EveryLoadKind, IsReadWithTheKeysThatItNeeds) {
  for (const LoadKind& kind : load_kinds()) EXPECT_EQ(error_of(kind, kind.needs), "") << kind.name;
}

TEST(EveryLoadKind, NamesTheKeyThatIsMissing) {
  for (const LoadKind& kind : load_kinds()) {
    for (const std::string& missing : kind.needs) {
      std::vector<std::string> keys = kind.needs;
      std::erase(keys, missing);
      const std::string message = error_of(kind, keys);
      EXPECT_NE(message.find("load[0]: a " + kind.name + " needs the key \"" + missing + "\""), message.npos)
          << message;
    }
  }
}

TEST(EveryLoadKind, RefusesTheKeysOfOtherKinds) {
  for (const LoadKind& kind : load_kinds()) {
    for (const LoadKind& other : load_kinds()) {
      std::vector<std::string> foreign = other.needs;
      foreign.insert(foreign.end(), other.has.begin(), other.has.end());
      for (const std::string& key : foreign) {
        if (has_key(kind, key)) continue;
        std::vector<std::string> keys = kind.needs;
        keys.push_back(key);
        const std::string message = error_of(kind, keys),
                          expected = "load[0]." + key + ": a " + kind.name + " has no such key; it has ";
        EXPECT_NE(message.find(expected), message.npos) << message;
      }
    }
  }
}

}  // namespace
}  // namespace resilin::testing
