#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

/// The server of the page: HTTP and WebSocket on 127.0.0.1, on one thread of its own.
namespace resilin::viewer {

using ClientId = std::uint32_t;
using SharedBytes = std::shared_ptr<const std::string>;
inline SharedBytes shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

/// One WebSocket message to a page.
struct Outgoing {
  bool is_text = true;
  SharedBytes bytes;
};

/// Partner of the pages at the other ends of WebSockets. The server calls all of it from its own thread.
///
/// The server pulls: it asks for a page's next message when the page has taken the one before, so nothing
/// piles up for a page that is slow, and a page that takes nothing is asked nothing.
class PageService {
 public:
  virtual ~PageService() = default;
  virtual void opened(ClientId client) = 0;
  virtual void received(ClientId client, bool is_text, std::string_view bytes) = 0;
  /// Returns the next message; nothing until `PageServer::wake` when there is none.
  virtual std::optional<Outgoing> next(ClientId client) = 0;
  virtual void closed(ClientId client) = 0;
};

/// Makes the bytes of an answer when it is asked for, on a thread beside the server's, one answer at a time.
/// `is_wanted` says no once the server ends. An InputError becomes an answer with status 404.
using MakeBytes = std::function<std::string(std::string_view target, const std::function<bool()>& is_wanted)>;

/// Takes the bytes that a page has sent by `POST`, on the same thread; the answer is a text. An InputError
/// becomes an answer with status 422.
using TakeBytes = std::function<std::string(std::string_view target, std::string bytes)>;

/// Answer to `GET` of a path: bytes in memory, a file that is read while it is sent, or bytes made from the
/// target; or what takes a `POST`.
struct Resource {
  std::string content_type;
  std::variant<SharedBytes, std::filesystem::path, MakeBytes, TakeBytes> content;
  std::string script_nonce;  ///< script nonce of a page: scripts that carry it may run, and no others
};

struct ServerOptions {
  std::uint16_t port = 0;    ///< 0: any free one
  std::string token;         ///< secret in the address; empty: a new one
  int max_connections = 32;  ///< most pages at once; the oldest idle one makes room
  std::size_t max_header_bytes = 8192;
  std::size_t max_message_bytes =
      4096;  ///< maximum message bytes of a page; a longer one ends its connection
  std::size_t max_sent_bytes = std::size_t{256} << 20;  ///< maximum sent bytes of a file that a page sends
  std::chrono::milliseconds request_timeout{10000};     ///< for a request and for the WebSocket handshake
  std::chrono::milliseconds send_timeout{10000};        ///< a page that takes a message for longer is dropped
  std::chrono::milliseconds body_timeout{
      120000};                                    ///< for all of an answer of HTTP, and for a file that comes
  std::chrono::milliseconds idle_timeout{60000};  ///< a page that no longer answers a ping is dropped
};

/// Listens from its construction to its destruction, which closes all connections.
class PageServer {
 public:
  /// `resources` by path. `service` (may be null) answers WebSockets at /live and outlives the server.
  /// @throws InputError  when the port cannot be had
  PageServer(const ServerOptions& options, std::map<std::string, Resource> resources, PageService* service);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  std::uint16_t port() const;
  const std::string& token() const;
  std::string address() const;  ///< "http://127.0.0.1:PORT/?token=..."

  /// Asks the service for news to every page that waits for some. From any thread; cheap.
  void wake();

 private:
  struct Contents;
  std::unique_ptr<Contents> contents_;
};

}  // namespace resilin::viewer
