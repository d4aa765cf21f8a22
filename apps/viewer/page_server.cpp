#include "page_server.hpp"

#include <thread>

#include "page_connections.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/log.hpp"

namespace resilin::viewer {
namespace {

[[noreturn]] void refuse_port(std::uint16_t port, const error_code& error) {
  const bool is_taken = error == asio::error::address_in_use;
  throw InputError("port " + std::to_string(port), "a free one on 127.0.0.1",
                   is_taken ? "one that another program listens on" : error.message(),
                   is_taken ? "end that program, choose another port, or let --port 0 find a free one"
                            : "choose one above 1023, or let --port 0 find a free one");
}

}  // namespace

struct PageServer::Contents {
  Shared shared;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  asio::steady_timer retry{context};
  std::thread thread;

  void listen() {
    const tcp::endpoint endpoint(asio::ip::address_v4::loopback(), shared.options.port);
    try {
      acceptor.open(endpoint.protocol());
      acceptor.set_option(asio::socket_base::reuse_address(true));
      acceptor.bind(endpoint);
      acceptor.listen();
    } catch (const boost::system::system_error& error) {
      refuse_port(shared.options.port, error.code());
    }
    shared.port = acceptor.local_endpoint().port();
  }

  void accept() {
    acceptor.async_accept([this](error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) {  // no more file descriptors, say: later there may be
        retry.expires_after(std::chrono::milliseconds(100));
        retry.async_wait([this](error_code stopped) {
          if (!stopped) accept();
        });
        return;
      }
      accept();
      begin(std::move(socket));
    });
  }

  void begin(tcp::socket socket) {
    error_code ignored;
    ignore(socket.set_option(tcp::no_delay(true), ignored));
    const auto connection = std::make_shared<Connection>(std::move(socket), shared);
    if (shared.num_connections > shared.options.max_connections && !drop_oldest_silent()) {
      connection->refuse(http::status::service_unavailable, "Too many pages are open; close one and reload.");
    } else {
      connection->start();
    }
  }

  /// Who says nothing does not keep out who does. False when all connections are those of pages.
  bool drop_oldest_silent() {
    std::erase_if(shared.silent, [](const auto& entry) {
      const auto connection = entry.lock();
      return !connection || !connection->is_silent();
    });
    if (shared.silent.empty()) return false;
    if (const auto oldest = shared.silent.front().lock()) oldest->drop();
    shared.silent.pop_front();
    return true;
  }

  void run() {
    for (;;) {
      try {
        context.run();
        return;
      } catch (const std::exception& error) {  // one connection's trouble is not that of the others
        log_warning(std::string("page server: ") + error.what());
      }
    }
  }

  void stop() {
    shared.is_stopping = true;
    shared.when_all_are_closed = [this] { context.stop(); };
    if (shared.pages.empty()) return context.stop();
    error_code ignored;
    ignore(acceptor.close(ignored));
    retry.cancel();
    const auto pages = shared.pages;
    for (const auto& [client, page] : pages) {
      if (const auto open = page.lock()) open->close();
    }
    // Whoever has not said goodbye by then is left.
    retry.expires_after(std::chrono::milliseconds(500));
    retry.async_wait([this](error_code) { context.stop(); });
  }
};

PageServer::PageServer(const ServerOptions& options, std::map<std::string, Resource> resources,
                       PageService* service)
    : contents_(std::make_unique<Contents>()) {
  contents_->shared.options = options;
  contents_->shared.resources = std::move(resources);
  contents_->shared.service = service;
  contents_->shared.token = options.token.empty() ? make_token() : options.token;
  contents_->listen();
  contents_->accept();
  contents_->thread = std::thread([contents = contents_.get()] { contents->run(); });
}

PageServer::~PageServer() {
  contents_->shared.is_ending = true;
  asio::post(contents_->context, [contents = contents_.get()] { contents->stop(); });
  contents_->thread.join();
  contents_->shared.makers.join();
}

std::uint16_t PageServer::port() const { return contents_->shared.port; }

const std::string& PageServer::token() const { return contents_->shared.token; }

std::string PageServer::address() const {
  return "http://127.0.0.1:" + std::to_string(port()) + "/?token=" + token();
}

void PageServer::wake() {
  Shared& shared = contents_->shared;
  if (shared.wake_is_posted.exchange(true)) return;
  asio::post(contents_->context, [&shared] {
    shared.wake_is_posted = false;
    const auto pages = shared.pages;  // pumping may drop pages
    for (const auto& [client, page] : pages) {
      if (const auto open = page.lock()) open->pump();
    }
  });
}

}  // namespace resilin::viewer
