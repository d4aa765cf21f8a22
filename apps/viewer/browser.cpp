#include "browser.hpp"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>  // mkdtemp
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>
#include <system_error>

namespace resilin::viewer {
namespace {

/// The value of a variable of the environment; empty when it is not set.
std::string_view variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string_view{} : std::string_view{value};
}

/// Leads on without a click, and, where a browser does not do that by itself, with one. `address` has no
/// character that means something to HTML.
std::string leading_to(const std::string& address) {
  return "<!doctype html><meta charset=\"utf-8\"><meta name=\"referrer\" "
         "content=\"no-referrer\"><title>Resilin</title>"
         "<meta http-equiv=\"refresh\" content=\"0; url=" +
         address + "\"><p><a href=\"" + address + "\">Resilin</a></p>\n";
}

/// A new folder that this user alone may enter; empty when there is none to be had.
std::filesystem::path make_private_folder() {
  std::error_code error;
  for (const std::filesystem::path& parent :
       {std::filesystem::path(variable("XDG_RUNTIME_DIR")), std::filesystem::temp_directory_path(error)}) {
    if (parent.empty()) continue;
    std::string name = (parent / "resilin-page-").string() + std::string(6, 'X');
    if (mkdtemp(name.data()) != nullptr) return name;  // with mode 0700
  }
  return {};
}

/// Starts the command of the desktop and does not wait for it.
void show(const std::string& file) {
  const std::string command = browser_command() + " \"$0\"";
  const pid_t child = fork();
  if (child > 0) waitpid(child, nullptr, 0);
  if (child != 0) return;
  // A grandchild in a session of its own: Ctrl-C here does not end the browser, and nobody waits for it.
  setsid();
  if (fork() != 0) _exit(0);
  const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  for (const int number : {SIGPIPE, SIGXFSZ}) signal(number, SIG_DFL);  // the browser's own
  sigset_t none;  // the program itself blocks those that it waits for
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  execl("/bin/sh", "sh", "-c", command.c_str(), file.c_str(), static_cast<char*>(nullptr));
  _exit(127);
}

}  // namespace

bool write_private_file(const std::filesystem::path& path, const std::string& text) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) return false;
  const bool is_whole = write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  return close(file) == 0 && is_whole;
}

bool has_display() { return !variable("DISPLAY").empty() || !variable("WAYLAND_DISPLAY").empty(); }

std::string browser_command() {
  const std::string_view listed = variable("BROWSER");  // a list with colons between the commands
  return std::string(listed.empty() ? "xdg-open" : listed.substr(0, listed.find(':')));
}

OpenedBrowser::OpenedBrowser(const std::string& address) {
  if (!has_display()) return;
  folder_ = make_private_folder();
  if (folder_.empty()) return;
  const std::filesystem::path file = folder_ / "page.html";
  if (write_private_file(file, leading_to(address))) show(file.string());
}

OpenedBrowser::~OpenedBrowser() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

}  // namespace resilin::viewer
