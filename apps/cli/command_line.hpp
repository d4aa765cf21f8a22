#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "command_text.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the name of that library
class App;
class Option;
}  // namespace CLI

/// The command line in the words of its commands. CLI11, which costs seconds in every file that sees it,
/// reads it in command_line.cpp.
namespace resilin::cli {

/// Completions that shells offer for the value of an option; words are made when they are asked for.
struct Offer {
  Completion completion;
  std::function<std::vector<std::string>()> words;
};
using Offers = std::map<const CLI::Option*, Offer>;

/// An option, or an argument that is known by its place. A handle: what made it owns it.
class Option {
 public:
  Option(CLI::Option& option, Offers& offers) : option_(&option), offers_(&offers) {}

  Option required() const;
  Option type_name(const std::string& name) const;  ///< placeholder of the value in the help
  Option shows_default() const;
  Option values(int least, int most) const;  ///< how many follow one another
  Option repeatable() const;                 ///< one value each time
  Option joins_repeats() const;              ///< the values of all times
  Option separated_by(char separator) const;
  Option one_of(const std::vector<std::string>& words) const;
  Option group(const std::string& heading) const;  ///< where the help lists it
  /// Shells complete the value with files of these extensions, or with words beside files and folders.
  Option is_file(const std::vector<std::string>& extensions = {}) const;
  Option is_folder() const;
  Option is_file_or_folder(const std::vector<std::string>& extensions = {}) const;
  Option offers(std::function<std::vector<std::string>()> words) const;
  Option between(int least, int most) const;
  Option positive() const;
  Option excludes(const Option& other) const;
  bool is_given() const;

 private:
  CLI::Option* option_;
  Offers* offers_;
};

/// A subcommand; a handle too. What the command line says ends up in the values that it was given.
class Command {
 public:
  Command(CLI::App& app, Offers& offers) : app_(&app), offers_(&offers) {}

  /// @param name  "--out", or "scene" for an argument that is known by its place
  Option option(const std::string& name, std::string& value, const std::string& help) const;
  Option option(const std::string& name, int& value, const std::string& help) const;
  Option option(const std::string& name, double& value, const std::string& help) const;
  Option option(const std::string& name, std::optional<double>& value, const std::string& help) const;
  Option option(const std::string& name, std::vector<std::string>& values, const std::string& help) const;
  Option option(const std::string& name, std::vector<int>& values, const std::string& help) const;
  Option option(const std::string& name, std::vector<double>& values, const std::string& help) const;
  Option flag(const std::string& name, bool& value, const std::string& help) const;
  /// `--name` or `--name=WORD`; the value becomes `word` for the former and never takes the word behind it.
  Option flag_with_word(const std::string& name, std::string& value, const std::string& word,
                        const std::string& help) const;
  void footer(const std::string& text) const;

  /// Leaves everything behind its name, --help too, to whoever asks for `remaining`.
  void takes_everything() const;
  std::vector<std::string> remaining() const;

  /// Called once the whole command line is read, when this is the command on it.
  void on_chosen(std::function<void()> call) const;

 private:
  Option handle(CLI::Option& option) const { return {option, *offers_}; }

  CLI::App* app_;
  Offers* offers_;
};

/// Error of a command line, in one line.
struct CommandLineError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class CommandLine {
 public:
  struct Text {
    std::string program, help, version, footer;
  };
  explicit CommandLine(const Text& text);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  Command command(const std::string& name, const std::string& help);

  /// All commands so far with their options.
  ProgramText text() const;

  /// The exit code when nothing is left to do: --help and --version print what was asked for.
  ///
  /// @throws CommandLineError
  std::optional<int> read(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> app_;
  std::string version_;
  Offers offers_;
};

}  // namespace resilin::cli
