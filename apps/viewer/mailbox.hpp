#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "page_message.hpp"
#include "page_server.hpp"

/// Messages between the server's thread and the simulation's thread.
namespace resilin::viewer {

/// The scene as it is described to a page; a new one after each reload.
struct SceneNews {
  std::uint64_t generation = 0;
  nlohmann::json header;
  SharedBytes topology;
  std::vector<std::string> field_names;
};

/// One state of the bodies, encoded once for each choice of field that some page has made.
struct Snapshot {
  std::uint64_t generation = 0;
  std::uint32_t number = 0;
  std::map<FieldChoice, SharedBytes> frames;
};

/// A text that is sent again whenever its version has risen.
struct VersionedText {
  std::uint64_t version = 0;
  SharedBytes text;
};

/// The newest of everything.
struct News {
  std::shared_ptr<const SceneNews> scene;
  std::shared_ptr<const Snapshot> snapshot;
  VersionedText state, status;
};

/// One line that answers the request of a page.
struct Word {
  std::string text;
  bool is_refusal = true;
};

struct Command {
  ClientId client = 0;
  std::optional<LoopMessage> message;  ///< none: the page has left
};

/// Requests that wait for the simulation's thread.
struct Requests {
  std::vector<Command> commands;
  std::set<FieldChoice> wanted_fields;  ///< by the pages that are open
  bool is_stopping = false;
};

class Mailbox {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t max_commands = 256;

  // For the server's thread.
  /// A drag replaces one of the same page that nobody has seen yet. False when the box is full.
  bool post(ClientId client, const LoopMessage& message);
  void post_leaving(ClientId client);
  void set_wanted_fields(std::set<FieldChoice> fields);
  News news() const;
  /// Takes the messages for pages, by page; 0 stands for all.
  std::map<ClientId, std::vector<Word>> take_words();

  // For the simulation's thread.
  /// Sleeps until `earliest`, then until there is a command, a change of wanted fields, or `latest` (none:
  /// for ever).
  Requests wait(Clock::time_point earliest, std::optional<Clock::time_point> latest);
  /// The same for who may not sleep: what there is now.
  Requests take();
  /// Whether a turn would find something to do.
  bool has_requests() const;
  void publish(const std::function<void(News&)>& change);
  void refuse(ClientId client, std::string why);
  void tell(ClientId client, std::string text);  ///< answers a request that is done
  void refuse_all(const std::string& why);       ///< tells it to every page

  /// From any thread: ends `wait`.
  void stop();

 private:
  bool is_called() const;
  Requests take_locked();

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Requests requests_;
  bool wanted_fields_changed_ = false;
  News news_;
  std::map<ClientId, std::vector<Word>> words_;
};

}  // namespace resilin::viewer
