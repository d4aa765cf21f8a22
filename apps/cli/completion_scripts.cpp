#include "completion_scripts.hpp"

#include <algorithm>
#include <map>

namespace resilin::cli {
namespace {

using Writer = std::string (*)(const ProgramText&);

const std::map<std::string, Writer>& writers() {
  static const std::map<std::string, Writer> table = {
      {"bash", bash_completion}, {"fish", fish_completion}, {"zsh", zsh_completion}};
  return table;
}

}  // namespace

std::vector<std::string> shell_names() {
  std::vector<std::string> names;
  for (const auto& [name, writer] : writers()) names.push_back(name);
  return names;
}

std::string completion_script(const ProgramText& program, const std::string& shell) {
  return writers().at(shell)(program);
}

std::vector<std::string> option_words(const std::vector<OptionText>& options) {
  std::vector<std::string> words;
  for (const OptionText& option : options) {
    if (option.is_argument) continue;
    words.push_back(option.name);
    if (option.most_values == 0)
      for (const std::string& word : option.completion.words) words.push_back(option.name + "=" + word);
  }
  return words;
}

std::string escaped(const std::string& text, const std::string& special, const std::string& escape) {
  std::string result;
  for (const char c : text) {
    if (special.find(c) != special.npos) result += escape;
    result += c;
  }
  return result;
}

std::string quoted_for_shell(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string first_sentence(const std::string& help) { return help.substr(0, help.find_first_of(";\n")); }

bool has_pairs(const std::vector<std::string>& words) {
  return std::ranges::any_of(words, [](const std::string& word) { return word.find('=') != word.npos; });
}

}  // namespace resilin::cli
