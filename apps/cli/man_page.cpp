#include <algorithm>
#include <sstream>

#include "command_text.hpp"
#include "completion_scripts.hpp"
#include "resilin/core/text.hpp"

namespace resilin::cli {
namespace {

/// Text as it stands, for roff: no character means anything to it.
std::string plain(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
  }
  if (result.starts_with('.') || result.starts_with('\'')) result.insert(0, "\\&");
  return result;
}

/// Line by line, as it stands.
std::string block(const std::string& text) {
  std::string result = ".PP\n.nf\n";
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) result += plain(line) + "\n";
  return result + ".fi\n";
}

std::string value_name(const OptionText& option) { return option.value.substr(0, option.value.find(':')); }

std::string entry(const OptionText& option) {
  std::string text = ".TP\n";
  if (option.is_argument) {
    text += "\\fI" + plain(option.name) + "\\fR\n";
  } else {
    text += "\\fB" + plain(option.name) + "\\fR";
    if (!option.value.empty()) text += " \\fI" + plain(value_name(option)) + "\\fR";
    text += "\n";
  }
  text += plain(option.help) + "\n";
  const std::vector<std::string>& words = option.completion.words;
  if (!words.empty() && !has_pairs(words)) text += "(" + plain(join(words)) + ")\n";
  return text;
}

/// In the order of their groups, under the names of these.
std::string entries(const std::vector<OptionText>& options) {
  std::vector<std::string> groups;
  for (const OptionText& option : options)
    if (std::ranges::find(groups, option.group) == groups.end()) groups.push_back(option.group);
  std::string text;
  for (const OptionText& option : options)
    if (option.is_argument) text += entry(option);
  for (const std::string& group : groups) {
    if (groups.size() > 1 && group != groups.front()) text += ".PP\n" + plain(group) + ":\n";
    for (const OptionText& option : options)
      if (!option.is_argument && option.group == group) text += entry(option);
  }
  return text;
}

std::string synopsis(const std::string& program, const CommandText& command) {
  std::string text = ".B " + program + " " + command.name + "\n";
  for (const OptionText& option : command.options) {
    if (!option.is_argument) continue;
    const std::string name = "\\fI" + plain(option.name) + "\\fR";
    text += (option.is_required ? name : "[" + name + "]") + "\n";
  }
  return text + (command.options.empty() ? "[\\fIarguments\\fR]\n" : "[\\fIoptions\\fR]\n");
}

}  // namespace

std::string man_page(const ProgramText& program) {
  std::string text = ".TH RESILIN 1 \"\" \"" + program.name + " " + program.version +
                     "\" \"User Commands\"\n" + ".SH NAME\n" + program.name +
                     " \\- hyperelastic solids with finite elements\n" + ".SH SYNOPSIS\n";
  for (const CommandText& command : program.commands)
    text += (&command == &program.commands.front() ? "" : ".br\n") + synopsis(program.name, command);
  text += ".SH DESCRIPTION\n" + plain(program.help) + "\n" + block(program.footer) + ".SH OPTIONS\n" +
          entries(program.options) + ".SH COMMANDS\n";
  for (const CommandText& command : program.commands) {
    text += ".SS " + program.name + " " + command.name + "\n" + plain(command.help) + "\n" +
            entries(command.options);
    if (!command.footer.empty()) text += block(command.footer);
  }
  return text;
}

}  // namespace resilin::cli
