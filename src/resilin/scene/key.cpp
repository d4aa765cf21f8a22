#include "resilin/scene/key.hpp"

#include <algorithm>
#include <array>
#include <regex>

#include "resilin/core/vocabulary.hpp"
#include "resilin/io/text_scanner.hpp"

namespace resilin {
namespace {

/// A type as docs/scene.md has it, without the marks of its links: "text or [box](#mesh)" becomes
/// "text or a table (docs/scene.md#mesh)".
std::string readable_type(const std::string& type) {
  static const std::regex link(R"(\[[^\]]*\]\((#[^)]*)\))");
  return std::regex_replace(type, link, "a table (docs/scene.md$1)");
}

std::string reference_row(const KeyDoc& key) {
  const std::string meaning = key.is_later ? "Not in this version. " + key.text : key.text;
  return "| `" + key.name + "` | " + key.type + " | " + key.unit + " | " + key.default_text + " | " +
         meaning + " |\n";
}

}  // namespace

std::string reference_text(const TableDoc& section) {
  std::string text = "\n## " + section.title + "\n" + section.text + "\n";
  if (section.keys.empty()) return text;
  text += "\n| key | type | unit | default | meaning |\n| --- | --- | --- | --- | --- |\n";
  for (const KeyDoc& key : section.keys) text += reference_row(key);
  return text;
}

void refuse_unknown_keys(const SceneNode& table, const std::vector<std::string>& known) {
  for (const SceneMember& member : table.value->table()) {
    if (std::ranges::find(known, member.key) != known.end()) continue;
    std::string cure = cure_of_word(member.key, known);
    // Its value says more: kind = "shell".
    const std::array choices = {"kind", "type", "mode", "model", "formulation", "analysis", "section"};
    const auto* value = std::get_if<std::string>(&member.value.data);
    if (value != nullptr && std::ranges::find(choices, member.key) != choices.end())
      if (const std::string other = foreign_word_cure(*value); !other.empty())
        cure = "\"" + printable(*value) + "\": " + other;
    SceneNode node{&member.value, table.path, table.context};
    if (!node.path.empty()) node.path += '.';
    node.path += printable(member.key);
    throw UnknownKeyError(node.place(), "unknown key \"" + printable(member.key) + "\"; " +
                                            (cure.empty() ? "known are " + join(known) : cure));
  }
}

void refuse_missing_key(const SceneNode& table, const KeyDoc& key) {
  table.fail_with("the key \"" + key.name + "\" is missing; give " + key.name + " = " +
                  readable_type(key.type) + ": " + key.text);
}

void refuse_later(const SceneNode& node, const std::string& cure) {
  node.fail_with("not part of this version; " + cure);
}

std::string default_text(double value) { return format_number(value); }
std::string default_text(int value) { return std::to_string(value); }
std::string default_text(bool value) { return value ? "true" : "false"; }
std::string default_text(const std::string& value) { return one_of({value}); }

std::string default_text(const Vector3& value) {
  if (value.isZero()) return "zero";
  const std::vector<std::string> numbers = {format_number(value[0]), format_number(value[1]),
                                            format_number(value[2])};
  std::string text(1, '[');
  return text.append(join(numbers)).append(1, ']');
}

std::string default_text(const Eigen::Matrix3d& value) { return value.isZero() ? "zero" : "not zero"; }

std::string default_text(const std::vector<std::string>& value) {
  std::vector<std::string> quoted;
  for (const std::string& word : value) quoted.push_back(default_text(word));
  std::string text(1, '[');
  return text.append(join(quoted)).append(1, ']');
}

std::string one_of(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text.append(1, '"').append(words[i]).append(1, '"');
  }
  return text;
}

std::string not_yet(const std::vector<std::string>& words) {
  return words.empty() ? "" : " Not in this version: " + join(words) + ".";
}

std::string read_choice(const SceneNode& node, const std::vector<std::string>& there_is,
                        const std::vector<std::string>& later) {
  const std::string word = read_text(node);
  if (std::ranges::find(there_is, word) != there_is.end()) return word;
  if (std::ranges::find(later, word) != later.end()) {
    node.fail_with("\"" + word + "\" is not part of this version; there is " + one_of(there_is));
  }
  node.fail(one_of(there_is), cure_of_word(word, there_is));
}

std::vector<std::string> read_choices(const SceneNode& node, const std::vector<std::string>& there_is,
                                      const std::vector<std::string>& later) {
  expect_list(node, "texts");
  std::vector<std::string> words;
  for (std::size_t i = 0; i < node.value->array().size(); ++i) {
    words.push_back(read_choice(node.element(i), there_is, later));
  }
  return words;
}

}  // namespace resilin
