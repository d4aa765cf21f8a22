#include "resilin/results/checkpoint.hpp"

#include <cstring>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/core/hash.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/results/build_info.hpp"

namespace resilin {
namespace {

// The format: this line; version, fingerprint, failed steps and the image of the state, each number in 8
// bytes, each text behind its length; the hash of all that.
constexpr std::string_view magic = "resilin checkpoint 1\n";
constexpr std::string_view magic_of_any_format = "resilin ";
constexpr const char* cure = "run without --resume to begin again";
constexpr const char* kind_key = "simulation.kind";

template <class T>
void put(std::string& bytes, const T& value) {
  static_assert(sizeof(T) == 8);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

void put_text(std::string& bytes, std::string_view text) {
  put(bytes, std::uint64_t{text.size()});
  bytes += text;
}

/// Takes no length that the bytes give on trust.
class Reader {
 public:
  Reader(std::string_view bytes, const std::string& place) : rest_(bytes), place_(place) {}

  template <class T>
  T get() {
    static_assert(sizeof(T) == 8);
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }

  std::string_view get_text() {
    const auto size = get<std::uint64_t>();
    return take(size);
  }

  int get_count() {
    const auto value = get<std::int64_t>();
    if (value < 0 || value > std::numeric_limits<int>::max())
      throw InputError(place_, "a number of steps", std::to_string(value), cure);
    return static_cast<int>(value);
  }

  void end() const {
    if (!rest_.empty()) fail();
  }

 private:
  [[noreturn]] void fail() const {
    throw InputError(place_, "a checkpoint as it was written", "a truncated or damaged one", cure);
  }

  std::string_view take(std::uint64_t size) {
    if (size > rest_.size()) fail();
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }

  std::string_view rest_;
  const std::string& place_;
};

std::string value_of(const Fingerprint& fingerprint, std::string_view key) {
  for (const auto& [name, value] : fingerprint)
    if (name == key) return value;
  return "";
}

}  // namespace

std::string serialize(const Checkpoint& checkpoint) {
  std::string bytes(magic);
  put_text(bytes, checkpoint.version);
  put(bytes, std::uint64_t{checkpoint.fingerprint.size()});
  for (const auto& [name, value] : checkpoint.fingerprint) {
    put_text(bytes, name);
    put_text(bytes, value);
  }
  put(bytes, std::int64_t{checkpoint.failed_steps.count});
  put(bytes, std::int64_t{checkpoint.failed_steps.first_step});
  put(bytes, checkpoint.failed_steps.first_time);
  put_text(bytes, checkpoint.failed_steps.first_reason);
  put_text(bytes, serialize(checkpoint.state));
  put(bytes, hash_of(bytes));
  return bytes;
}

Checkpoint parse_checkpoint(std::string_view bytes, const std::string& place) {
  if (!bytes.starts_with(magic)) {
    const bool is_of_another_format = bytes.starts_with(magic_of_any_format);
    throw InputError(place, "a checkpoint of Resilin " + std::string(version()),
                     is_of_another_format ? "one of another format" : "something else", cure);
  }
  constexpr std::size_t sum_size = sizeof(std::uint64_t);
  const std::size_t end = bytes.size() < magic.size() + sum_size ? magic.size() : bytes.size() - sum_size;
  Reader sum(bytes.substr(end), place);
  if (sum.get<std::uint64_t>() != hash_of(bytes.substr(0, end)))
    throw InputError(place, "a checkpoint as it was written", "a truncated or damaged one", cure);

  Reader reader(bytes.substr(magic.size(), end - magic.size()), place);
  Checkpoint checkpoint;
  checkpoint.version = reader.get_text();
  for (auto count = reader.get<std::uint64_t>(); count > 0; --count) {
    const std::string_view name = reader.get_text();
    checkpoint.fingerprint.emplace_back(name, reader.get_text());
  }
  checkpoint.failed_steps.count = reader.get_count();
  checkpoint.failed_steps.first_step = reader.get_count();
  checkpoint.failed_steps.first_time = reader.get<double>();
  checkpoint.failed_steps.first_reason = reader.get_text();
  checkpoint.state = deserialize_state(reader.get_text(), place);
  reader.end();
  return checkpoint;
}

std::optional<std::string> check_scene(const Checkpoint& checkpoint, const Fingerprint& scene, Resume resume,
                                       const std::string& place) {
  const std::string kind_before = value_of(checkpoint.fingerprint, kind_key),
                    kind = value_of(scene, kind_key);
  if (kind_before != kind) {
    throw InputError(place, "a checkpoint with " + std::string(kind_key) + " " + kind,
                     kind_before.empty() ? "one without" : printable(kind_before), cure);
  }
  std::string difference;
  if (checkpoint.version != version()) {
    difference = "it was written by version " + printable(checkpoint.version) + ", not by this one, " +
                 std::string(version());
  } else if (const auto found = first_difference(checkpoint.fingerprint, scene)) {
    difference = describe(*found);
  }
  if (difference.empty()) return std::nullopt;
  if (resume == Resume::anyway) return difference;
  throw InputError(place, "a checkpoint of this scene", "one of another: " + difference,
                   std::string(cure) + ", or with --resume=anyway to go on in the scene as it is now");
}

}  // namespace resilin
