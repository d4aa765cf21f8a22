#include <memory>
#include <string>

#include "command.hpp"
#include "resilin/core/text.hpp"
#include "terminal.hpp"

namespace resilin::cli {

void add_completion(CommandLine& line, Action& action) {
  auto shell = std::make_shared<std::string>();
  const Command command =
      line.command("completion", "Print a completion script for commands, options and their values");
  command.option("shell", *shell, join(shell_names())).required().one_of(shell_names());
  command.footer(
      "Examples:\n"
      "  source <(resilin completion bash)      now; for good, this line in ~/.bashrc\n"
      "  source <(resilin completion zsh)       the same in ~/.zshrc, behind compinit\n"
      "  resilin completion fish > ~/.config/fish/completions/resilin.fish");
  command.on_chosen([&line, shell, &action] {
    action = [&line, shell] {
      print_text(completion_script(line.text(), *shell));
      return static_cast<int>(done);
    };
  });
}

}  // namespace resilin::cli
