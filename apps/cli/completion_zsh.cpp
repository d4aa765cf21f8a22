#include "completion_scripts.hpp"
#include "resilin/core/text.hpp"

namespace resilin::cli {
namespace {

/// Offers KEY= first, and the values of that key once it is there.
constexpr const char* zsh_functions = R"(
_resilin_pairs() {
  local -a known keys
  known=("$@")
  if compset -P '*='; then
    compadd -- "${(@)${(@M)known:#${IPREFIX##*--*=}?*}#${IPREFIX##*--*=}}"
  else
    keys=("${(@u)${(@)known%%=*}}")
    compadd -S '' -- "${(@)keys/%/=}"
  fi
}
)";

std::string action_of(const Completion& completion) {
  if (has_pairs(completion.words)) return "_resilin_pairs " + join(completion.words, " ");
  if (!completion.words.empty()) return "(" + join(completion.words, " ") + ")";
  if (completion.kind == Completion::Kind::folder) return "_files -/";
  if (completion.kind == Completion::Kind::nothing) return " ";
  if (completion.extensions.empty()) return "_files";
  const std::string endings = join(completion.extensions, "|");  // in brackets one alone would be a qualifier
  return "_files -g \"*." + (completion.extensions.size() == 1 ? endings : "(" + endings + ")") + "\"";
}

std::string message_of(const OptionText& option) {
  return escaped(option.is_argument ? option.name : option.value.substr(0, option.value.find(':')), ":\\");
}

/// As _arguments wants it: "--out[Folder]:DIR:_files -/".
std::string spec_of(const OptionText& option) {
  std::string spec = option.is_argument ? "" : (option.is_repeatable ? "*" : "") + option.name;
  if (!option.is_argument) spec += "[" + escaped(first_sentence(option.help), "[]:\\") + "]";
  const std::string value = ":" + message_of(option) + ":" + action_of(option.completion);
  const int count = option.is_argument ? 1 : option.most_values;
  for (int i = 0; i < count; ++i) spec += value;
  return quoted_for_shell(option.is_argument && option.most_values > 1 ? "*" + spec : spec);
}

std::string arguments_call(const std::vector<OptionText>& options) {
  std::string text = "_arguments";
  for (const OptionText& option : options) {
    constexpr int many = 8;  // an option without a limit takes one value each time
    OptionText limited = option;
    if (limited.most_values > many && !option.is_argument) limited.most_values = 1;
    text += " \\\n        " + spec_of(limited);
    if (option.most_values == 0)
      for (const std::string& word : option.completion.words)
        text += " \\\n        " + quoted_for_shell(option.name + "=" + word);
  }
  return text;
}

}  // namespace

std::string zsh_completion(const ProgramText& program) {
  std::string commands, cases;
  for (const CommandText& command : program.commands) {
    commands += "      " + quoted_for_shell(command.name + ":" + escaped(command.help, ":\\")) + "\n";
    cases += "      " + command.name + ")\n        " +
             (command.takes_everything ? "_default" : arguments_call(command.options)) + "\n        ;;\n";
  }
  return "#compdef " + program.name + "\n# Completion for zsh, printed by `" + program.name +
         " completion zsh`.\n" + zsh_functions +
         "\n_resilin() {\n"
         "  local curcontext=$curcontext state line\n  typeset -A opt_args\n"
         "  _arguments -C '--help' '--version' '1:command:->command' '*::argument:->arguments'\n"
         "  case $state in\n  command)\n    local -a commands\n    commands=(\n" +
         commands +
         "    )\n    _describe -t commands command commands\n    ;;\n  arguments)\n    case $words[1] in\n" +
         cases +
         "    esac\n    ;;\n  esac\n}\n\n"
         "if [[ $funcstack[1] == _resilin ]]; then _resilin \"$@\"; else compdef _resilin resilin; fi\n";
}

}  // namespace resilin::cli
