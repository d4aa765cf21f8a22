#include "browser.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace resilin::viewer {
namespace {

/// The value of a variable of the environment; empty when it is not set.
std::string_view variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string_view{} : std::string_view{value};
}

/// $BROWSER is a list of commands with colons between them.
std::string browser_command() {
  const std::string_view listed = variable("BROWSER");
  return std::string(listed.empty() ? "xdg-open" : listed.substr(0, listed.find(':'))) + " \"$0\"";
}

}  // namespace

void open_browser(const std::string& address) {
  if (variable("DISPLAY").empty() && variable("WAYLAND_DISPLAY").empty()) return;
  const std::string command = browser_command();
  const pid_t child = fork();
  if (child > 0) waitpid(child, nullptr, 0);
  if (child != 0) return;
  // A grandchild in a session of its own: Ctrl-C here does not end the browser, and nobody waits for it.
  setsid();
  if (fork() != 0) _exit(0);
  const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  for (const int number : {SIGPIPE, SIGXFSZ}) signal(number, SIG_DFL);  // the browser's own
  execl("/bin/sh", "sh", "-c", command.c_str(), address.c_str(), static_cast<char*>(nullptr));
  _exit(127);
}

}  // namespace resilin::viewer
