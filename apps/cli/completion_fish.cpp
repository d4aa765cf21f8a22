#include "completion_scripts.hpp"
#include "resilin/core/text.hpp"

namespace resilin::cli {
namespace {

/// fish knows \' and \\ between single quotes.
std::string quoted_for_fish(const std::string& text) { return "'" + escaped(text, "'\\") + "'"; }

/// Arguments of `complete` for a value: nothing else than this is offered.
std::string value_of(const Completion& completion) {
  if (!completion.words.empty()) return " -x -a " + quoted_for_fish(join(completion.words, " "));
  if (completion.kind == Completion::Kind::folder) return " -x -a '(__fish_complete_directories)'";
  if (completion.kind == Completion::Kind::nothing) return " -x";
  std::string suffixes;
  for (const std::string& extension : completion.extensions) suffixes += " ." + extension;
  return completion.extensions.empty() ? " -r -F" : " -x -k -a '(__fish_complete_suffix" + suffixes + ")'";
}

std::string line_of(const std::string& program, const std::string& condition, const OptionText& option) {
  std::string line = "complete -c " + program + " -n " + quoted_for_fish(condition);
  if (!option.is_argument)
    line += " -l " + option.name.substr(2) + " -d " + quoted_for_fish(first_sentence(option.help));
  if (option.is_argument || option.most_values > 0) line += value_of(option.completion);
  return line + "\n";
}

}  // namespace

std::string fish_completion(const ProgramText& program) {
  std::string text = "# Completion for fish, printed by `" + program.name +
                     " completion fish`.\n\ncomplete -c " + program.name + " -f\n";
  for (const OptionText& option : program.options)
    text += line_of(program.name, "__fish_use_subcommand", option);
  for (const CommandText& command : program.commands) {
    text += "complete -c " + program.name + " -n __fish_use_subcommand -a " + command.name + " -d " +
            quoted_for_fish(command.help) + "\n";
  }
  for (const CommandText& command : program.commands) {
    const std::string condition = "__fish_seen_subcommand_from " + command.name;
    for (const OptionText& option : command.options) {
      text += line_of(program.name, condition, option);
      if (option.most_values == 0 && !option.completion.words.empty())
        text += "complete -c " + program.name + " -n " + quoted_for_fish(condition) + " -a " +
                quoted_for_fish(option.name + "=" + join(option.completion.words, " " + option.name + "=")) +
                "\n";
    }
  }
  return text;
}

}  // namespace resilin::cli
