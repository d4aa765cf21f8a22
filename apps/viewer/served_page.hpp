#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "live_loop.hpp"
#include "live_room.hpp"
#include "mailbox.hpp"
#include "page_server.hpp"
#include "served_scene.hpp"

/// The two things that the page can be served with: docs/view_protocol.md, "Addresses".
namespace resilin::viewer {

/// The scene of a file that a page has sent: its name as the page has it, and its bytes. Throws InputError.
using OpenFile = std::function<std::unique_ptr<ServedScene>(const std::string& name, std::string bytes)>;

/// A scene that runs from construction to destruction while pages play with it.
class LiveServer {
 public:
  /// @param open  makes a scene of a file that a page sends; null: pages may send none
  /// @throws InputError  when the port cannot be had
  LiveServer(std::unique_ptr<ServedScene> scene, const ServerOptions& options, OpenFile open = {});

  const PageServer& server() const { return server_; }

 private:
  Mailbox mailbox_;
  LiveRoom room_;
  PageServer server_;
  LiveLoop loop_;
};

/// The page over the recording and the report of a result folder.
/// @throws InputError  when the folder has no recording
std::map<std::string, Resource> recorded_resources(const std::filesystem::path& folder);

}  // namespace resilin::viewer
