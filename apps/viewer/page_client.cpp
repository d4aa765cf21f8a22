#include "viewer/page_client.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>
#include <utility>

namespace resilin::viewer {
namespace {

enum Opcode : unsigned char { text = 1, binary = 2, close_frame = 8, ping = 9, pong = 10 };

template <class Number>
void append(std::string& bytes, Number number) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof number);
}

std::uint32_t read_u32(std::string_view bytes, std::size_t offset) {
  std::uint32_t number = 0;
  std::memcpy(&number, bytes.substr(offset, 4).data(), 4);
  return number;
}

}  // namespace

Socket::Socket(std::uint16_t port) : descriptor_(::socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const timeval limit{patience.count(), 0};
  const int yes = 1;
  ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  ::setsockopt(descriptor_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
  ::setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  if (::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const std::string why = std::strerror(errno);
    close();
    throw std::runtime_error("connect: " + why);
  }
}

Socket::~Socket() { close(); }

Socket::Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

void Socket::close() {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

void Socket::finish_sending() { ::shutdown(descriptor_, SHUT_WR); }

bool Socket::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

std::string Socket::receive(std::size_t most) {
  std::string bytes(most, '\0');
  const ssize_t size = ::recv(descriptor_, bytes.data(), bytes.size(), 0);
  if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) throw std::runtime_error("the server is silent");
  bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return bytes;
}

std::string Socket::receive_all() {
  std::string all;
  for (std::string part = receive(); !part.empty(); part = receive()) all += part;
  return all;
}

std::string exchange(std::uint16_t port, std::string_view request) {
  Socket socket(port);
  socket.send(request);
  return socket.receive_all();
}

std::string request_text(std::uint16_t port, const std::string& target, const std::string& headers) {
  return "GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\n" + headers + "\r\n";
}

PageClient::PageClient(std::uint16_t port, const std::string& token) : socket_(port) {
  socket_.send(
      request_text(port, "/live?token=" + token,
                   "Origin: http://127.0.0.1:" + std::to_string(port) +
                       "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                       "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"));
  std::size_t end = std::string::npos;
  while ((end = buffer_.find("\r\n\r\n")) == std::string::npos) {
    const std::string part = socket_.receive();
    if (part.empty()) throw std::runtime_error("refused: " + buffer_);
    buffer_ += part;
  }
  if (!buffer_.starts_with("HTTP/1.1 101")) throw std::runtime_error("refused: " + buffer_);
  buffer_.erase(0, end + 4);
}

bool PageClient::send_frame(unsigned char opcode, std::string_view payload) {
  constexpr unsigned char last = 0x80, masked = 0x80;
  std::string frame(1, static_cast<char>(last | opcode));
  if (payload.size() < 126) {
    frame += static_cast<char>(masked | payload.size());
  } else {
    frame += static_cast<char>(masked | 126);
    frame += static_cast<char>(payload.size() >> 8);
    frame += static_cast<char>(payload.size() & 0xff);
  }
  frame.append(4, '\0');  // a mask of zeros leaves the payload as it is
  frame += payload;
  return socket_.send(frame);
}

bool PageClient::send_text(std::string_view json) { return send_frame(text, json); }

bool PageClient::send_binary(std::string_view bytes) { return send_frame(binary, bytes); }

bool PageClient::acknowledge(std::uint32_t frame) {
  std::string bytes("\1\0\0\0", 4);
  append(bytes, frame);
  return send_binary(bytes);
}

bool PageClient::drag(std::uint32_t number, float x, float y, float z) {
  std::string bytes("\2\0\0\0", 4);
  append(bytes, number);
  append(bytes, x);
  append(bytes, y);
  append(bytes, z);
  return send_binary(bytes);
}

bool PageClient::fill(std::size_t size) {
  while (buffer_.size() < size) {
    const std::string part = socket_.receive(1 << 20);
    if (part.empty()) return false;
    buffer_ += part;
  }
  return true;
}

std::optional<PageClient::Message> PageClient::receive() {
  for (;;) {
    if (!fill(2)) return std::nullopt;
    const auto byte = [this](std::size_t i) { return static_cast<unsigned char>(buffer_[i]); };
    const unsigned char opcode = byte(0) & 0x0f;
    std::size_t header = 2, size = byte(1) & 0x7f;
    if (size >= 126) {
      const std::size_t num_bytes = size == 126 ? 2 : 8;
      if (!fill(header + num_bytes)) return std::nullopt;
      size = 0;
      for (std::size_t i = 0; i < num_bytes; ++i) size = size << 8 | byte(header + i);
      header += num_bytes;
    }
    if (!fill(header + size)) return std::nullopt;
    std::string payload = buffer_.substr(header, size);
    buffer_.erase(0, header + size);
    if (opcode == close_frame) return std::nullopt;
    if (opcode == ping) send_frame(pong, payload);
    if (opcode == text || opcode == binary) return Message{opcode == text, std::move(payload)};
  }
}

std::string PageClient::receive_text(std::string_view type) {
  const std::string wanted = "\"type\":\"" + std::string(type) + '"';
  const auto end = std::chrono::steady_clock::now() + Socket::patience;
  while (const std::optional<Message> message = receive()) {
    if (std::chrono::steady_clock::now() > end)
      throw std::runtime_error("the server never said " + std::string(type));
    if (is_frame(*message)) acknowledge(frame_number(message->bytes));
    if (message->is_text && message->bytes.find(wanted) != std::string::npos) return message->bytes;
  }
  throw std::runtime_error("the server closed the connection before it said " + std::string(type));
}

std::string PageClient::receive_frame(bool acknowledges) {
  while (std::optional<Message> message = receive()) {
    if (!is_frame(*message)) continue;
    if (acknowledges) acknowledge(frame_number(message->bytes));
    return std::move(message->bytes);
  }
  throw std::runtime_error("the server closed the connection before it sent a frame");
}

std::uint32_t frame_number(std::string_view frame) { return read_u32(frame, 4); }

std::uint32_t answered_drag(std::string_view frame) { return read_u32(frame, 16); }

bool is_frame(const PageClient::Message& message) {
  return !message.is_text && message.bytes.starts_with("RSF1") && message.bytes.size() >= 64;
}

}  // namespace resilin::viewer
