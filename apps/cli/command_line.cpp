#include "command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/catalog.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

/// A file in the place of a command is run, or shown where it is a mesh.
std::string cure_of_command(const std::string& word, const std::vector<std::string>& commands) {
  const std::string extension = MeshSource{word, {}, {}}.extension();
  const bool is_mesh = std::ranges::any_of(mesh_formats(), [&](const MeshFormat& format) {
    return std::ranges::find(format.extensions, extension) != format.extensions.end();
  });
  if (extension == "toml") return "did you mean \"resilin run " + word + "\"?";
  if (is_mesh) return "did you mean \"resilin view " + word + "\"?";
  return did_you_mean(word, commands);
}

/// A first word that is no command; empty when there is none.
std::string unknown_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return {};
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == argv[1]) return {};
    names.push_back(command->get_name());
  }
  const std::string cure = cure_of_command(argv[1], names);
  return InputError("command", "one of " + join(names), '"' + std::string(argv[1]) + '"',
                    cure.empty() ? "see resilin --help" : cure)
      .what();
}

std::string help_hint(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return "; see " + app.get_name() + " " + (chosen.empty() ? "" : chosen.front()->get_name() + " ") +
         "--help";
}

OptionText text_of(const CLI::Option& option, const Offers& offers) {
  OptionText text = {.name = option.get_positional() ? option.get_name() : "--" + option.get_lnames().front(),
                     .value = "",
                     .help = option.get_description(),
                     .group = option.get_group(),
                     .is_argument = option.get_positional(),
                     .is_required = option.get_required(),
                     .is_repeatable = option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll,
                     .least_values = option.get_items_expected_min(),
                     .most_values = option.get_items_expected_max(),
                     .completion = {}};
  if (text.most_values > 0) text.value = option.get_type_name();
  if (const auto known = offers.find(&option); known != offers.end()) {
    text.completion = known->second.completion;
    if (known->second.words) text.completion.words = known->second.words();
  }
  return text;
}

}  // namespace

Option Option::required() const {
  option_->required();
  return *this;
}

Option Option::type_name(const std::string& name) const {
  option_->type_name(name);
  return *this;
}

Option Option::shows_default() const {
  option_->capture_default_str();
  return *this;
}

Option Option::values(int least, int most) const {
  option_->expected(least, most);
  return *this;
}

Option Option::repeatable() const {
  option_->expected(1)->take_all()->allow_extra_args(false);
  return *this;
}

Option Option::joins_repeats() const {
  option_->take_all();
  return *this;
}

Option Option::separated_by(char separator) const {
  option_->delimiter(separator);
  return *this;
}

Option Option::one_of(const std::vector<std::string>& words) const {
  option_->check(CLI::IsMember(words));
  return offers([words] { return words; });
}

Option Option::group(const std::string& heading) const {
  option_->group(heading);
  return *this;
}

Option Option::is_file(const std::vector<std::string>& extensions) const {
  (*offers_)[option_].completion.kind = Completion::Kind::file;
  (*offers_)[option_].completion.extensions = extensions;
  return *this;
}

Option Option::is_folder() const {
  (*offers_)[option_].completion.kind = Completion::Kind::folder;
  return *this;
}

Option Option::is_file_or_folder(const std::vector<std::string>& extensions) const {
  (*offers_)[option_].completion.kind = Completion::Kind::file_or_folder;
  (*offers_)[option_].completion.extensions = extensions;
  return *this;
}

Option Option::offers(std::function<std::vector<std::string>()> words) const {
  (*offers_)[option_].words = std::move(words);
  return *this;
}

Option Option::between(int least, int most) const {
  option_->check(CLI::Range(least, most));
  return *this;
}

Option Option::positive() const {
  option_->check(CLI::PositiveNumber);
  return *this;
}

Option Option::excludes(const Option& other) const {
  option_->excludes(other.option_);
  return *this;
}

bool Option::is_given() const { return option_->count() > 0; }

Option Command::option(const std::string& name, std::string& value, const std::string& help) const {
  return handle(*app_->add_option(name, value, help));
}

Option Command::option(const std::string& name, int& value, const std::string& help) const {
  return handle(*app_->add_option(name, value, help));
}

Option Command::option(const std::string& name, double& value, const std::string& help) const {
  return handle(*app_->add_option(name, value, help));
}

Option Command::option(const std::string& name, std::optional<double>& value, const std::string& help) const {
  return handle(*app_->add_option(name, value, help));
}

Option Command::option(const std::string& name, std::vector<std::string>& values,
                       const std::string& help) const {
  return handle(*app_->add_option(name, values, help));
}

Option Command::option(const std::string& name, std::vector<int>& values, const std::string& help) const {
  return handle(*app_->add_option(name, values, help));
}

Option Command::option(const std::string& name, std::vector<double>& values, const std::string& help) const {
  return handle(*app_->add_option(name, values, help));
}

Option Command::flag(const std::string& name, bool& value, const std::string& help) const {
  return handle(*app_->add_flag(name, value, help));
}

Option Command::flag_with_word(const std::string& name, std::string& value, const std::string& word,
                               const std::string& help) const {
  return handle(*app_->add_flag(name + "{" + word + "}", value, help));
}

void Command::footer(const std::string& text) const { app_->footer(text); }

void Command::takes_everything() const {
  app_->prefix_command();
  app_->set_help_flag();
}

std::vector<std::string> Command::remaining() const { return app_->remaining(); }

void Command::on_chosen(std::function<void()> call) const { app_->callback(std::move(call)); }

CommandLine::CommandLine(const Text& text)
    : app_(std::make_unique<CLI::App>(text.help, text.program)), version_(text.version) {
  app_->set_version_flag("--version", text.version);
  app_->require_subcommand(1);
  app_->footer(text.footer);
}

CommandLine::~CommandLine() = default;

Command CommandLine::command(const std::string& name, const std::string& help) {
  return {*app_->add_subcommand(name, help), offers_};
}

ProgramText CommandLine::text() const {
  const auto options_of = [this](const CLI::App& app) {
    std::vector<OptionText> options;
    for (const CLI::Option* option : app.get_options()) options.push_back(text_of(*option, offers_));
    return options;
  };
  ProgramText program = {.name = app_->get_name(),
                         .help = app_->get_description(),
                         .footer = app_->get_footer(),
                         .version = version_,
                         .options = options_of(*app_),
                         .commands = {}};
  for (const CLI::App* app : app_->get_subcommands([](const CLI::App*) { return true; }))
    program.commands.push_back({.name = app->get_name(),
                                .help = app->get_description(),
                                .footer = app->get_footer(),
                                .takes_everything = app->get_prefix_command(),
                                .options = options_of(*app)});
  return program;
}

std::optional<int> CommandLine::read(int argc, char** argv) {
  if (const std::string message = unknown_command(*app_, argc, argv); !message.empty())
    throw CommandLineError(message);
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help, --version
    std::ostringstream text;
    const int code = app_->exit(success, text, text);
    print_text(text.str());
    return code;
  } catch (const CLI::ParseError& error) {
    throw CommandLineError(error.what() + help_hint(*app_));
  }
  return std::nullopt;
}

}  // namespace resilin::cli
