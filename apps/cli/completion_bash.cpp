#include <algorithm>

#include "completion_scripts.hpp"
#include "resilin/core/text.hpp"

namespace resilin::cli {
namespace {

/// Functions that all commands share.
constexpr const char* bash_functions = R"bash(
_resilin() {
  # bash takes words apart at '='; here they are whole
  local word i line=${COMP_LINE:0:COMP_POINT} merged=()
  for ((i = 0; i <= COMP_CWORD; ++i)); do
    word=${COMP_WORDS[i]}
    if ((i > 0)) && [[ $word == = ]]; then
      merged[-1]+=$word
    elif ((i > 0)) && [[ ${COMP_WORDS[i - 1]} == = ]] && ! { ((i == COMP_CWORD)) && [[ $line == *[[:space:]] ]]; }; then
      merged[-1]+=$word
    else
      merged+=("$word")
    fi
  done

  local cur=${merged[-1]} command= option= left=0 place=0
  local count= kind= extensions= list=
  for word in "${merged[@]:1:${#merged[@]}-2}"; do
    if [[ -z $command ]]; then
      [[ $word == -* ]] || command=$word
    elif ((left > 0)) && [[ $word != --* ]]; then
      left=$((left - 1))
    elif [[ $word == -* ]]; then
      option=${word%%=*} left=0
      if [[ $word != *=* ]]; then
        _resilin_about "$command $option"
        left=$count
      fi
    else
      place=$((place + 1))
    fi
  done

  local start=
  if [[ $cur == --*=* ]]; then
    start=${cur%%=*}=
    _resilin_about "$command ${cur%%=*}"
  elif ((left > 0)) && [[ $cur != --* ]]; then
    _resilin_about "$command $option"
  else
    _resilin_about "$command $((place + 1))"
    [[ $cur != -* && -n $kind$list ]] || _resilin_about "$command options"
  fi

  COMPREPLY=()
  local value=${cur#"$start"} before= file
  [[ $value == *,* && $value != *=* ]] && before=${value%,*},
  for word in $list; do
    word=$before$word
    [[ $value == *=* || $word == -* ]] || word=${word/%=*/=}
    [[ $word == "$value"* && " ${COMPREPLY[*]} " != *" $word "* ]] && COMPREPLY+=("$word")
  done
  if [[ -n $kind ]]; then
    compopt -o filenames 2>/dev/null
    while IFS= read -r file; do
      if [[ -d ${file/#\~/$HOME} ]]; then
        COMPREPLY+=("$file")
      elif [[ $kind == file && ( -z $extensions || " $extensions " == *" ${file##*.} "* ) ]]; then
        COMPREPLY+=("$file")
      fi
    done < <(compgen -f -- "$value")
  fi
  # What is before the last '=' stays where it is.
  [[ -n $start || $cur != *=* ]] || COMPREPLY=("${COMPREPLY[@]#"${cur%"${cur##*=}"}"}")
  [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *= ]] && compopt -o nospace 2>/dev/null
  return 0
}

complete -F _resilin resilin
)bash";

std::string case_of(const std::string& place, const OptionText& option) {
  const Completion& completion = option.completion;
  std::string text = "    '" + place + "') count=" + std::to_string(option.most_values);
  if (completion.kind == Completion::Kind::folder) text += " kind=folder";
  if (completion.kind == Completion::Kind::file || completion.kind == Completion::Kind::file_or_folder)
    text += " kind=file";
  if (!completion.extensions.empty()) text += " extensions='" + join(completion.extensions, " ") + "'";
  if (!completion.words.empty()) text += " list='" + join(completion.words, " ") + "'";
  return text + " ;;\n";
}

std::string list_of(const std::string& place, const std::vector<std::string>& words) {
  return "    '" + place + "') list='" + join(words, " ") + "' ;;\n";
}

}  // namespace

std::string bash_completion(const ProgramText& program) {
  std::string text =
      "# Completion for bash, printed by `" + program.name + " completion bash`.\n\n" +
      "# What may stand at a place: \"COMMAND --OPTION\", \"COMMAND 1\" or \"COMMAND options\".\n"
      "_resilin_about() {\n  count=0 kind= extensions= list=\n  case $1 in\n";
  std::vector<std::string> names;
  for (const CommandText& command : program.commands) {
    names.push_back(command.name);
    int place = 0;
    for (const OptionText& option : command.options) {
      if (!option.is_argument) {
        if (option.most_values > 0 || !option.completion.words.empty())
          text += case_of(command.name + " " + option.name, option);
        continue;
      }
      constexpr int most_places = 4;  // maximum number of places of one argument that takes any number
      for (int i = 0; i < std::min(option.most_values, most_places); ++i)
        text += case_of(command.name + " " + std::to_string(++place), option);
    }
    text += list_of(command.name + " options", option_words(command.options));
  }
  text += list_of(" 1", names) + list_of(" options", option_words(program.options));
  return text + "  esac\n}\n" + bash_functions;
}

}  // namespace resilin::cli
