#include "mailbox.hpp"

#include <utility>

namespace resilin::viewer {

bool Mailbox::post(ClientId client, const LoopMessage& message) {
  const std::lock_guard lock(mutex_);
  std::vector<Command>& commands = requests_.commands;
  const auto is_drag = [](const std::optional<LoopMessage>& m) {
    return m && std::holds_alternative<Drag>(*m);
  };
  if (!commands.empty() && commands.back().client == client && is_drag(commands.back().message) &&
      std::holds_alternative<Drag>(message)) {
    commands.back().message = message;
    return true;
  }
  if (commands.size() >= max_commands) return false;
  commands.push_back({client, message});
  changed_.notify_one();
  return true;
}

void Mailbox::post_leaving(ClientId client) {
  const std::lock_guard lock(mutex_);
  requests_.commands.push_back({client, std::nullopt});
  words_.erase(client);
  changed_.notify_one();
}

void Mailbox::set_wanted_fields(std::set<FieldChoice> fields) {
  const std::lock_guard lock(mutex_);
  if (fields == requests_.wanted_fields) return;
  requests_.wanted_fields = std::move(fields);
  wanted_fields_changed_ = true;
  changed_.notify_one();
}

News Mailbox::news() const {
  const std::lock_guard lock(mutex_);
  return news_;
}

std::map<ClientId, std::vector<Word>> Mailbox::take_words() {
  const std::lock_guard lock(mutex_);
  return std::exchange(words_, {});
}

Requests Mailbox::wait(Clock::time_point earliest, std::optional<Clock::time_point> latest) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, earliest, [this] { return requests_.is_stopping; });
  const auto has_news = [this] { return is_called(); };
  if (latest) {
    changed_.wait_until(lock, *latest, has_news);
  } else {
    changed_.wait(lock, has_news);
  }
  return take_locked();
}

Requests Mailbox::take() {
  const std::lock_guard lock(mutex_);
  return take_locked();
}

bool Mailbox::has_requests() const {
  const std::lock_guard lock(mutex_);
  return is_called();
}

bool Mailbox::is_called() const {
  return requests_.is_stopping || wanted_fields_changed_ || !requests_.commands.empty();
}

Requests Mailbox::take_locked() {
  wanted_fields_changed_ = false;
  Requests found = requests_;
  requests_.commands.clear();
  return found;
}

void Mailbox::publish(const std::function<void(News&)>& change) {
  const std::lock_guard lock(mutex_);
  change(news_);
}

void Mailbox::refuse(ClientId client, std::string why) {
  const std::lock_guard lock(mutex_);
  words_[client].push_back({std::move(why), /*is_refusal=*/true});
}

void Mailbox::tell(ClientId client, std::string text) {
  const std::lock_guard lock(mutex_);
  words_[client].push_back({std::move(text), /*is_refusal=*/false});
}

void Mailbox::refuse_all(const std::string& why) { refuse(0, why); }

void Mailbox::stop() {
  const std::lock_guard lock(mutex_);
  requests_.is_stopping = true;
  changed_.notify_one();
}

}  // namespace resilin::viewer
