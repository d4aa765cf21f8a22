#pragma once

#include <string>
#include <vector>

/// The commands of a program and their options as text: what completions of shells and man pages are made of.
namespace resilin::cli {

/// Completions of a value.
struct Completion {
  enum class Kind {
    nothing,  ///< words alone, if any
    file,
    folder,
    file_or_folder
  };
  Kind kind = Kind::nothing;
  std::vector<std::string> extensions;  ///< extensions of files, such as "toml"; empty: any
  std::vector<std::string> words;       ///< "a=" goes on with a value, "a=b" is whole
};

struct OptionText {
  std::string name;   ///< "--out"; of an argument that is known by its place "scene"
  std::string value;  ///< placeholder of the value in the help, "KEY=VALUE"; empty for a flag
  std::string help, group;
  bool is_argument = false;  ///< known by its place
  bool is_required = false;
  bool is_repeatable = false;
  int least_values = 0, most_values = 0;  ///< numbers of values that follow it
  Completion completion;
};

struct CommandText {
  std::string name, help, footer;
  bool takes_everything = false;  ///< another program reads what stands behind its name
  std::vector<OptionText> options;
};

struct ProgramText {
  std::string name, help, footer, version;
  std::vector<OptionText> options;  ///< without a command
  std::vector<CommandText> commands;
};

/// The shells that completions are written for.
std::vector<std::string> shell_names();

/// A script that makes `shell`, one of `shell_names`, complete the program's command line.
std::string completion_script(const ProgramText& program, const std::string& shell);

/// A page for man, section 1.
std::string man_page(const ProgramText& program);

}  // namespace resilin::cli
