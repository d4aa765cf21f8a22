#include "resilin/results/checkpoint.hpp"

#include <cstdint>
#include <limits>
#include <type_traits>

#include "resilin/core/archive.hpp"
#include "resilin/core/error.hpp"
#include "resilin/io/text_scanner.hpp"
#include "resilin/results/build_info.hpp"

namespace resilin {
namespace {

// The format: this line; version, fingerprint, failed steps, most strained state and the image of the state,
// each number in 8 bytes, each text behind its length; the hash of all that.
constexpr std::string_view magic = "resilin checkpoint 3\n";
constexpr std::string_view magic_of_any_format = "resilin ";
constexpr const char* cure = "run without --resume to start from the beginning";
constexpr const char* kind_key = "simulation.kind";

int count_of_steps(std::int64_t value, const std::string& place) {
  if (value < 0 || value > std::numeric_limits<int>::max())
    throw InputError(place, "a number of steps", std::to_string(value), cure);
  return static_cast<int>(value);
}

std::string value_of(const Fingerprint& fingerprint, std::string_view key) {
  for (const auto& [name, value] : fingerprint)
    if (name == key) return value;
  return "";
}

/// Each number in 8 bytes.
void write_failed_steps(ArchiveWriter& archive, const FailedSteps& failed) {
  visit_members(failed, [&](std::string_view, const auto& value) {
    if constexpr (std::is_same_v<decltype(value), const int&>) {
      archive(std::int64_t{value});
    } else {
      archive(value);
    }
  });
}

void read_failed_steps(ArchiveReader& archive, const std::string& place, FailedSteps& failed) {
  visit_members(failed, [&](std::string_view, auto& value) {
    if constexpr (std::is_same_v<decltype(value), int&>) {
      std::int64_t number = 0;
      archive(number);
      value = count_of_steps(number, place);
    } else {
      archive(value);
    }
  });
}

}  // namespace

std::string serialize(const Checkpoint& checkpoint) {
  ArchiveWriter archive;
  archive(checkpoint.version, checkpoint.fingerprint);
  write_failed_steps(archive, checkpoint.failed_steps);
  archive(checkpoint.most_strained, serialize(checkpoint.state));
  return sealed(magic, archive.take());
}

Checkpoint parse_checkpoint(std::string_view bytes, const std::string& place) {
  if (!bytes.starts_with(magic)) {
    const bool is_of_another_format = bytes.starts_with(magic_of_any_format);
    throw InputError(place, "a checkpoint of Resilin " + std::string(version()),
                     is_of_another_format ? "one of another format" : "something else", cure);
  }
  Checkpoint checkpoint;
  std::string state;
  ArchiveReader archive(unsealed(bytes, magic, place, cure), place, cure);
  archive(checkpoint.version, checkpoint.fingerprint);
  read_failed_steps(archive, place, checkpoint.failed_steps);
  archive(checkpoint.most_strained, state);
  archive.end();
  checkpoint.state = deserialize_state(state, place);
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
                   std::string(cure) + ", or with --resume=anyway to continue with the present scene");
}

}  // namespace resilin
