#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <functional>
#include <thread>

#include "access.hpp"
#include "fault_words.hpp"
#include "page_server.hpp"

/// The connections of the page server, each from its first byte to its last. A part of page_server.cpp, the
/// only file that includes it: Beast takes half a minute to compile.
namespace resilin::viewer {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using boost::system::error_code;

/// For calls that fail only when the other end has gone already, which the next read tells.
void ignore(const error_code&) {}

using Request = http::request<http::empty_body>;

class LivePage;
class Connection;

/// State that all connections share; used on the server's thread alone, except for `wake_is_posted`.
struct Shared {
  ServerOptions options;
  std::map<std::string, Resource> resources;
  PageService* service = nullptr;
  std::string token;
  std::uint16_t port = 0;
  int num_connections = 0;
  std::deque<std::weak_ptr<Connection>> silent;  ///< connections without a request so far, the oldest first
  ClientId last_client = 0;
  std::map<ClientId, std::weak_ptr<LivePage>> pages;
  std::atomic<bool> wake_is_posted = false;
  asio::thread_pool makers{1};          ///< thread for answers that take their time
  std::atomic<bool> is_ending = false;  ///< they are no longer wanted
  bool is_stopping = false;
  std::function<void()> when_all_are_closed;  ///< called once the last page has gone while stopping
};

/// Counts a connection from its beginning to its end.
class ConnectionCount {
 public:
  explicit ConnectionCount(Shared& shared) : shared_(&shared) { ++shared.num_connections; }
  ~ConnectionCount() { --shared_->num_connections; }
  ConnectionCount(const ConnectionCount&) = delete;
  ConnectionCount& operator=(const ConnectionCount&) = delete;

 private:
  Shared* shared_;
};

/// Scripts run only with the page's nonce, nothing is loaded from elsewhere, and nobody may frame the page.
/// Styles are set from scripts by the page's libraries.
std::string content_security_policy(const Shared& shared, const std::string& nonce) {
  const std::string port = std::to_string(shared.port);
  return "default-src 'none'; script-src " + (nonce.empty() ? "'none'" : "'nonce-" + nonce + "'") +
         "; style-src 'unsafe-inline'; img-src data: blob:; font-src data:; connect-src 'self' "
         "ws://127.0.0.1:" +
         port + " ws://localhost:" + port + "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
}

template <class Response>
void set_common_headers(Response& response, const Shared& shared, const std::string& nonce) {
  response.set("Content-Security-Policy", content_security_policy(shared, nonce));
  response.set(http::field::cache_control, "no-store");
  response.set("Referrer-Policy", "no-referrer");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.keep_alive(false);
}

/// One page at the other end of a WebSocket.
class LivePage : public std::enable_shared_from_this<LivePage> {
 public:
  LivePage(beast::tcp_stream&& stream, Shared& shared, std::shared_ptr<ConnectionCount> count)
      : socket_(std::move(stream)),
        send_deadline_(socket_.get_executor()),
        shared_(&shared),
        count_(std::move(count)) {}

  void start(const Request& request) {
    const ServerOptions& options = shared_->options;
    beast::get_lowest_layer(socket_).expires_never();
    socket_.set_option(websocket::stream_base::timeout{options.request_timeout, options.idle_timeout,
                                                       /*keep_alive_pings=*/true});
    socket_.read_message_max(options.max_message_bytes);
    socket_.auto_fragment(false);
    socket_.async_accept(request, [self = shared_from_this()](error_code error) { self->accepted(error); });
  }

  /// Sends what the service has to say, unless a message is under way.
  void pump() {
    if (!is_open_ || is_sending_ || shared_->is_stopping) return;
    std::optional<Outgoing> message = shared_->service->next(client_);
    if (!message) return;
    is_sending_ = true;
    sending_ = std::move(message->bytes);
    socket_.text(message->is_text);
    send_deadline_.expires_after(shared_->options.send_timeout);
    send_deadline_.async_wait([self = shared_from_this()](error_code error) {
      if (!error) self->drop();
    });
    socket_.async_write(asio::buffer(*sending_), [self = shared_from_this()](error_code error, std::size_t) {
      self->send_deadline_.cancel();
      self->is_sending_ = false;
      self->sending_.reset();
      if (error) return self->drop();
      self->pump();
    });
  }

  /// Says goodbye; what is under way is still sent.
  void close() {
    if (!is_open_) return drop();
    socket_.async_close({websocket::close_code::going_away, "the program ends"},
                        [self = shared_from_this()](error_code) { self->drop(); });
  }

 private:
  void accepted(error_code error) {
    if (error || shared_->is_stopping) return drop();
    is_open_ = true;
    client_ = ++shared_->last_client;
    shared_->pages[client_] = weak_from_this();
    shared_->service->opened(client_);
    read();
    pump();
  }

  void read() {
    socket_.async_read(received_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->drop();
      const auto data = self->received_.cdata();
      self->shared_->service->received(self->client_, self->socket_.got_text(),
                                       {static_cast<const char*>(data.data()), data.size()});
      self->received_.consume(self->received_.size());
      if (!self->is_open_) return;
      self->read();
      self->pump();
    });
  }

  /// The end, whatever the reason; calls of handlers that are still to come see it.
  void drop() {
    send_deadline_.cancel();
    beast::get_lowest_layer(socket_).close();
    if (!is_open_) return;
    is_open_ = false;
    shared_->pages.erase(client_);
    shared_->service->closed(client_);
    if (shared_->is_stopping && shared_->pages.empty()) shared_->when_all_are_closed();
  }

  websocket::stream<beast::tcp_stream> socket_;
  asio::steady_timer send_deadline_;
  Shared* shared_;
  std::shared_ptr<ConnectionCount> count_;
  beast::flat_buffer received_;
  SharedBytes sending_;
  ClientId client_ = 0;
  bool is_open_ = false;
  bool is_sending_ = false;
};

/// One connection until its first request is answered or becomes a WebSocket.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket&& socket, Shared& shared)
      : stream_(std::move(socket)), shared_(&shared), count_(std::make_shared<ConnectionCount>(shared)) {}

  /// Until its request is whole, anybody may be at the other end.
  bool is_silent() const { return is_silent_; }

  /// Ends one that is silent, to make room for another.
  void drop() { stream_.close(); }

  void start() {
    shared_->silent.push_back(weak_from_this());
    parser_.header_limit(static_cast<std::uint32_t>(shared_->options.max_header_bytes));
    stream_.expires_after(shared_->options.request_timeout);
    http::async_read_header(stream_, buffer_, parser_,
                            [self = shared_from_this()](error_code error, std::size_t) {
                              if (!error && self->is_for_taking()) return self->take();
                              if (error) return self->refuse_request(error);
                              http::async_read(self->stream_, self->buffer_, self->parser_,
                                               [self](error_code failure, std::size_t) {
                                                 self->is_silent_ = false;
                                                 if (failure) return self->refuse_request(failure);
                                                 self->answer();
                                               });
                            });
  }

  void refuse(http::status status, const std::string& words) {
    send_text(status, std::make_shared<const std::string>(words + "\n"), "text/plain; charset=utf-8", {});
  }

 private:
  void refuse_request(error_code error) {
    is_silent_ = false;
    if (error == http::error::header_limit || error == http::error::unexpected_body) {
      return refuse(http::status::request_header_fields_too_large,
                    "The request is larger than any that the page sends.");
    }
    if (error == http::error::body_limit) return refuse_length();
    const bool has_ended = error == http::error::end_of_stream || error == http::error::partial_message;
    if (!has_ended && error.category() == http::make_error_code(http::error::bad_method).category())
      refuse(http::status::bad_request, "Not an HTTP request: " + error.message() + ".");
  }

  std::string_view target() const { return {parser_.get().target().data(), parser_.get().target().size()}; }

  /// Why this request gets status 403; empty when it may pass. What changes something needs an `Origin`.
  std::string why_this_is_forbidden(bool needs_origin) const {
    const Request& request = parser_.get();
    const auto header = [&request](http::field field) -> std::optional<std::string_view> {
      const auto found = request.find(field);
      if (found == request.end()) return std::nullopt;
      if (request.count(field) > 1) return std::string_view();  // ambiguous
      return std::string_view(found->value().data(), found->value().size());
    };
    return why_forbidden({target(), header(http::field::host), header(http::field::origin), needs_origin},
                         shared_->port, shared_->token);
  }

  const TakeBytes* taker() const {
    const auto resource = shared_->resources.find(std::string(parse_target(target()).path));
    return resource == shared_->resources.end() ? nullptr : std::get_if<TakeBytes>(&resource->second.content);
  }

  bool is_for_taking() const { return parser_.get().method() == http::verb::post && taker() != nullptr; }

  void refuse_length() {
    refuse(http::status::payload_too_large,
           "The file is larger than " + std::to_string(shared_->options.max_sent_bytes >> 20) +
               " MiB, the most that a page may send; `resilin view FILE` opens it.");
  }

  /// Reads what is sent, once it is known who sends it.
  void take() {
    const std::string forbidden = why_this_is_forbidden(/*needs_origin=*/true);
    if (!forbidden.empty()) return refuse(http::status::forbidden, forbidden);
    is_silent_ = false;
    const auto length = parser_.content_length();
    if (length && *length > shared_->options.max_sent_bytes) return refuse_length();
    sent_.emplace(std::move(parser_));
    sent_->body_limit(shared_->options.max_sent_bytes);
    stream_.expires_after(shared_->options.body_timeout);
    http::async_read(stream_, buffer_, *sent_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->refuse_request(error);
      auto& request = self->sent_->get();
      const std::string path(request.target().data(), request.target().size());
      const auto& resource = self->shared_->resources.at(std::string(parse_target(path).path));
      const auto& take = std::get<TakeBytes>(resource.content);
      auto bytes = std::make_shared<std::string>(std::move(request.body()));
      self->answer_beside([&take, path, bytes] { return take(path, std::move(*bytes)); },
                          "text/plain; charset=utf-8", http::status::unprocessable_entity);
    });
  }

  void answer() {
    const Request& request = parser_.get();
    const bool is_websocket = websocket::is_upgrade(request);
    const std::string forbidden = why_this_is_forbidden(is_websocket);
    if (!forbidden.empty()) return refuse(http::status::forbidden, forbidden);
    const std::string path(parse_target(target()).path);
    if (path == "/live" && shared_->service != nullptr) {
      if (!is_websocket)
        return refuse(http::status::upgrade_required, "This address accepts only WebSocket connections.");
      return std::make_shared<LivePage>(std::move(stream_), *shared_, count_)->start(request);
    }
    if (is_websocket) return refuse(http::status::not_found, "There is no live scene here.");
    if (request.method() != http::verb::get) {
      return refuse(http::status::method_not_allowed, "Only GET is answered.");
    }
    const auto resource = shared_->resources.find(path);
    if (resource == shared_->resources.end())
      return refuse(http::status::not_found, "There is nothing at this address.");
    if (std::holds_alternative<TakeBytes>(resource->second.content))
      return refuse(http::status::method_not_allowed, "Only POST is answered.");
    send(resource->second);
  }

  void send(const Resource& resource) {
    if (const auto* bytes = std::get_if<SharedBytes>(&resource.content)) {
      return send_text(http::status::ok, *bytes, resource.content_type, resource.script_nonce);
    }
    if (const auto* make = std::get_if<MakeBytes>(&resource.content))
      return send_made(*make, resource.content_type);
    auto response = std::make_shared<http::response<http::file_body>>();
    error_code error;
    response->body().open(std::get<std::filesystem::path>(resource.content).c_str(), beast::file_mode::scan,
                          error);
    if (error)
      return refuse(http::status::not_found, "The file can no longer be read: " + error.message() + ".");
    response->set(http::field::content_type, resource.content_type);
    write(response);
  }

  void send_made(const MakeBytes& make, const std::string& content_type) {
    const auto is_wanted = [self = shared_from_this()] { return !self->shared_->is_ending; };
    answer_beside([&make, is_wanted, asked = std::string(target())] { return make(asked, is_wanted); },
                  content_type, http::status::not_found);
  }

  /// Answers with what `make` returns on a thread beside this one, or with what it throws.
  void answer_beside(std::function<std::string()> make, const std::string& content_type,
                     http::status when_refused) {
    stream_.expires_never();
    asio::post(shared_->makers,
               [self = shared_from_this(), make = std::move(make), content_type, when_refused] {
                 SharedBytes bytes;
                 std::string problem = "The answer could not be made.";
                 try {
                   bytes = viewer::shared(make());
                 } catch (const std::exception& error) {
                   problem = words_of(error);
                 }
                 asio::post(self->stream_.get_executor(), [self, bytes, problem, content_type, when_refused] {
                   if (!bytes) return self->refuse(when_refused, problem);
                   self->send_text(http::status::ok, bytes, content_type, {});
                 });
               });
  }

  void send_text(http::status status, SharedBytes text, const std::string& content_type,
                 const std::string& nonce) {
    using Body = http::span_body<const char>;
    auto response = std::make_shared<http::response<Body>>(status, 11);
    response->set(http::field::content_type, content_type);
    response->body() = {text->data(), text->size()};
    text_ = std::move(text);
    write(response, nonce);
  }

  template <class Response>
  void write(const std::shared_ptr<Response>& response, const std::string& nonce = {}) {
    set_common_headers(*response, *shared_, nonce);
    response->prepare_payload();
    stream_.expires_after(shared_->options.body_timeout);
    http::async_write(stream_, *response, [self = shared_from_this(), response](error_code, std::size_t) {
      error_code ignored;
      ignore(self->stream_.socket().shutdown(tcp::socket::shutdown_both, ignored));
    });
  }

  beast::tcp_stream stream_;
  Shared* shared_;
  std::shared_ptr<ConnectionCount> count_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  std::optional<http::request_parser<http::string_body>> sent_;
  SharedBytes text_;
  bool is_silent_ = true;
};

}  // namespace
}  // namespace resilin::viewer
