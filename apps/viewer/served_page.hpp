#pragma once

#include <filesystem>
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

/// A scene that runs from construction to destruction while pages play with it.
class LiveServer {
 public:
  /// @throws InputError  when the port cannot be had
  LiveServer(std::unique_ptr<ServedScene> scene, const ServerOptions& options);

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
