#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// A page that does not draw: the other end of the page server's sockets, for tests and measurements.
namespace resilin::viewer {

/// A TCP connection to 127.0.0.1, closed at the end. Nothing waits for longer than `patience`.
class Socket {
 public:
  static constexpr std::chrono::seconds patience{20};

  explicit Socket(std::uint16_t port);
  ~Socket();
  Socket(Socket&& other) noexcept;
  Socket& operator=(Socket&&) = delete;

  /// False when the other end has closed.
  bool send(std::string_view bytes);
  /// At most `most` bytes; empty at the end of the stream. Throws std::runtime_error when nothing comes.
  std::string receive(std::size_t most = 65536);
  std::string receive_all();
  void finish_sending();  ///< the other end sees the end of the stream
  void close();

 private:
  int descriptor_ = -1;
};

/// Sends a request as it stands and returns all that comes back.
std::string exchange(std::uint16_t port, std::string_view request);

/// `GET target` as a browser on 127.0.0.1 asks for it.
std::string request_text(std::uint16_t port, const std::string& target, const std::string& headers = {});

class PageClient {
 public:
  struct Message {
    bool is_text = true;
    std::string bytes;
  };

  /// Opens the WebSocket of a live scene. Throws std::runtime_error with the answer when it is refused.
  PageClient(std::uint16_t port, const std::string& token);

  bool send_text(std::string_view json);
  bool send_binary(std::string_view bytes);
  bool acknowledge(std::uint32_t frame);
  bool drag(std::uint32_t number, float x, float y, float z);

  /// The next message; none when the server has closed the connection. Pings are answered.
  std::optional<Message> receive();
  /// The next text whose `type` is this one; others are passed over and frames are acknowledged.
  /// @throws std::runtime_error  when the connection ends before
  std::string receive_text(std::string_view type);
  /// The next frame ("RSF1"); acknowledged unless told otherwise.
  std::string receive_frame(bool acknowledges = true);

  Socket& socket() { return socket_; }

 private:
  bool send_frame(unsigned char opcode, std::string_view payload);
  bool fill(std::size_t size);

  Socket socket_;
  std::string buffer_;  // received and not yet read
};

/// The parts of a frame's header that clients look at.
std::uint32_t frame_number(std::string_view frame);
std::uint32_t answered_drag(std::string_view frame);
bool is_frame(const PageClient::Message& message);

}  // namespace resilin::viewer
