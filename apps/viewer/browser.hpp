#pragma once

#include <filesystem>
#include <string>

namespace resilin::viewer {

/// Whether there is a display that a browser could come up on: DISPLAY or WAYLAND_DISPLAY is set.
bool has_display();

/// The first command of $BROWSER, else xdg-open.
std::string browser_command();

/// A browser that was asked to show an address with a secret in it, and what that needs on disk, which goes
/// with this object.
///
/// Arguments of processes are seen by every user of the machine. The browser is therefore given the name of a
/// file that this user alone may read, and which leads to the address.
class OpenedBrowser {
 public:
  /// Asks the desktop: by $BROWSER, else by xdg-open. Does nothing without a display, or where no private
  /// file can be made; whether a browser came up is not known.
  explicit OpenedBrowser(const std::string& address);
  ~OpenedBrowser();
  OpenedBrowser(const OpenedBrowser&) = delete;
  OpenedBrowser& operator=(const OpenedBrowser&) = delete;

 private:
  std::filesystem::path folder_;  ///< empty: none was made
};

/// A new file that this user alone may read; false when it is there already or cannot be written.
bool write_private_file(const std::filesystem::path& path, const std::string& text);

}  // namespace resilin::viewer
