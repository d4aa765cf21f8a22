#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "mailbox.hpp"
#include "page_server.hpp"

namespace resilin::viewer {

/// All pages that watch one live scene: hands their messages to the mailbox, and tells each what it has not
/// seen yet.
///
/// A page gets a frame only when it has acknowledged the one before, and then the newest: a page that is slow
/// sees fewer frames, never old ones, and one that is silent costs nothing.
class LiveRoom : public PageService {
 public:
  explicit LiveRoom(Mailbox& mailbox) : mailbox_(&mailbox) {}

  void opened(ClientId client) override;
  void received(ClientId client, bool is_text, std::string_view bytes) override;
  std::optional<Outgoing> next(ClientId client) override;
  void closed(ClientId client) override;

 private:
  /// Messages that one page has received.
  struct Page {
    std::uint64_t generation = 0;
    std::uint64_t state_version = 0, status_version = 0;
    bool needs_topology = false;
    std::uint32_t last_frame = 0;                 ///< the state that the page has; 0: none with its field
    std::optional<std::uint32_t> unacknowledged;  ///< number of the frame that is under way
    FieldChoice shown;
    std::deque<Word> words;
  };

  void handle(ClientId client, Page& page, const PageMessage& message);
  void choose_field(Page& page, const ChooseField& chosen);
  void announce_wanted_fields();
  void tell(Page& page, Word word);
  void take_words();
  std::string hello(ClientId client, Page& page, const News& news);
  std::optional<Outgoing> next_frame(Page& page, const News& news);

  Mailbox* mailbox_;
  std::map<ClientId, Page> pages_;
};

}  // namespace resilin::viewer
