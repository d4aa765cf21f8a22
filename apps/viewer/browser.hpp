#pragma once

#include <string>

namespace resilin::viewer {

/// Asks the desktop to show an address: by $BROWSER, else by xdg-open. Does nothing without a display;
/// whether a browser came up is not known.
void open_browser(const std::string& address);

}  // namespace resilin::viewer
