#include "live_room.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/overloaded.hpp"
#include "resilin/core/text.hpp"

namespace resilin::viewer {
namespace {

using Json = nlohmann::json;

constexpr std::size_t max_message_bytes = 64;  // maximum message bytes of a binary one
constexpr std::size_t max_words = 8;           // words that wait for a page that does not read

std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

void LiveRoom::opened(ClientId client) {
  pages_[client] = {};
  announce_wanted_fields();
}

void LiveRoom::closed(ClientId client) {
  pages_.erase(client);
  announce_wanted_fields();
  mailbox_->post_leaving(client);
}

void LiveRoom::received(ClientId client, bool is_text, std::string_view bytes) {
  Page& page = pages_.at(client);
  try {
    if (!is_text && bytes.size() > max_message_bytes) {
      throw InputError("binary message", "at most " + std::to_string(max_message_bytes) + " bytes",
                       std::to_string(bytes.size()));
    }
    handle(client, page, is_text ? read_text_message(bytes) : read_binary_message(bytes));
  } catch (const InputError& error) {
    tell(page, {error.what()});
  }
}

void LiveRoom::handle(ClientId client, Page& page, const PageMessage& message) {
  std::visit(Overloaded{
                 [&page](const Acknowledge& acknowledged) {
                   if (page.unacknowledged == acknowledged.frame) page.unacknowledged.reset();
                 },
                 [this, &page](const ChooseField& chosen) { choose_field(page, chosen); },
                 [this, client](const auto& for_the_loop) {
                   if (mailbox_->post(client, for_the_loop)) return;
                   throw InputError(
                       "message",
                       "a page sends faster than the simulation can process; the message is dropped");
                 },
             },
             message);
}

void LiveRoom::choose_field(Page& page, const ChooseField& chosen) {
  const News news = mailbox_->news();
  const std::vector<std::string> names = news.scene ? news.scene->field_names : std::vector<std::string>{};
  std::vector<std::string> vectors;
  for (const std::string& name : names)
    if (std::ranges::find(names, name + ".x") != names.end()) vectors.push_back(name);
  const auto index_of = [&names](const std::string& name, const std::vector<std::string>& known,
                                 const char* key) -> std::optional<std::size_t> {
    if (name.empty()) return std::nullopt;
    if (std::ranges::find(known, name) == known.end())
      throw InputError("message \"field\": " + std::string(key), "\"\" or one of " + join(known),
                       Json(name.substr(0, 40)).dump());
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  const FieldChoice choice{index_of(chosen.name, names, "name"), index_of(chosen.arrows, vectors, "arrows")};
  if (page.shown == choice) return;
  page.shown = choice;
  page.last_frame = 0;  // the same state is sent again with the other field
  announce_wanted_fields();
}

void LiveRoom::announce_wanted_fields() {
  std::set<FieldChoice> wanted;
  for (const auto& [client, page] : pages_) wanted.insert(page.shown);
  mailbox_->set_wanted_fields(std::move(wanted));
}

void LiveRoom::tell(Page& page, Word word) {
  if (page.words.size() < max_words) page.words.push_back(std::move(word));
}

void LiveRoom::take_words() {
  for (const auto& [meant, words] : mailbox_->take_words()) {
    for (auto& [client, page] : pages_) {
      if (meant != client && meant != 0) continue;
      for (const Word& word : words) tell(page, word);
    }
  }
}

std::optional<Outgoing> LiveRoom::next(ClientId client) {
  take_words();
  Page& page = pages_.at(client);
  const News news = mailbox_->news();
  if (!news.scene) return std::nullopt;
  if (page.generation != news.scene->generation) return Outgoing{true, shared(hello(client, page, news))};
  if (std::exchange(page.needs_topology, false)) return Outgoing{false, news.scene->topology};
  if (!page.words.empty()) {
    const Word word = std::move(page.words.front());
    page.words.pop_front();
    const Json said = {{"type", word.is_refusal ? "error" : "note"}, {"message", word.text}};
    return Outgoing{true, shared(dump(said))};
  }
  if (page.state_version != news.state.version) {
    page.state_version = news.state.version;
    return Outgoing{true, news.state.text};
  }
  if (std::optional<Outgoing> frame = next_frame(page, news)) return frame;
  if (page.status_version != news.status.version) {
    page.status_version = news.status.version;
    return Outgoing{true, news.status.text};
  }
  return std::nullopt;
}

std::string LiveRoom::hello(ClientId client, Page& page, const News& news) {
  page.generation = news.scene->generation;
  page.needs_topology = true;
  page.unacknowledged.reset();
  page.last_frame = 0;
  const std::size_t num_fields = news.scene->field_names.size();
  if (page.shown.field >= num_fields || page.shown.arrows >= num_fields) {
    page.shown = {};
    announce_wanted_fields();
  }
  page.state_version = news.state.version;
  Json header = news.scene->header;
  header["type"] = "hello";
  header["client"] = client;
  header["state"] = Json::parse(*news.state.text);
  return dump(header);
}

std::optional<Outgoing> LiveRoom::next_frame(Page& page, const News& news) {
  if (page.unacknowledged || !news.snapshot) return std::nullopt;
  const Snapshot& snapshot = *news.snapshot;
  if (snapshot.generation != page.generation || snapshot.number == page.last_frame) return std::nullopt;
  const auto frame = snapshot.frames.find(page.shown);
  if (frame == snapshot.frames.end())
    return std::nullopt;  // chosen a moment ago; it comes with the next snapshot
  page.unacknowledged = page.last_frame = snapshot.number;
  return Outgoing{false, frame->second};
}

}  // namespace resilin::viewer
