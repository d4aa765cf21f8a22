#include "resilin/view/recording.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include "resilin/core/error.hpp"
#include "resilin/core/output_file.hpp"
#include "resilin/fields/quantities.hpp"

namespace resilin {
namespace {

constexpr std::string_view mark = "RSR1";

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string number_bytes(std::size_t value) {
  const auto number = static_cast<std::uint32_t>(value);
  return {reinterpret_cast<const char*>(&number), sizeof(number)};
}

/// A number that stands there; nothing when the bytes end before.
std::optional<std::uint32_t> number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  if (bytes.size() < at + sizeof(number)) return std::nullopt;
  std::memcpy(&number, bytes.data() + at, sizeof(number));
  return number;
}

std::string encoded(ViewHeader header, const World& world, const ShownSurface& surface,
                    const std::vector<ScalarField>& fields) {
  header.fields = fields;
  return encode_header(header, world, surface);
}

/// Fields by cell are recorded as averages.
bool is_recorded(const FieldInfo& field, const std::vector<std::string>& asked) {
  const auto is_asked = [&asked](std::string_view name) {
    return std::ranges::find(asked, name) != asked.end();
  };
  std::string_view of_cells = field.name;
  if (field.source == FieldInfo::Source::averages) of_cells.remove_prefix(averaged_prefix.size());
  return is_asked(field.name) || is_asked(of_cells);
}

}  // namespace

std::vector<ScalarField> recorded_fields(const World& world) {
  constexpr std::array<std::string_view, 3> always = {"nodal_von_mises", "averaged_volume_ratio",
                                                      "averaged_energy_density"};
  std::vector<ScalarField> recorded;
  const bool has_stress =
      std::ranges::any_of(world.bodies, [](const Body& body) { return body.rigid == nullptr; });
  for (const std::string_view name : always)
    if (has_stress) recorded.push_back(require_vertex_field(name, world.dimension, "recording"));
  const std::vector<std::string>& asked = world.output.fields;
  for (ScalarField& field : vertex_fields(world.dimension)) {
    const bool is_there = std::ranges::find(always, field.name) != always.end();
    if (!is_there && field.field->name != "displacement" && is_recorded(*field.field, asked))
      recorded.push_back(std::move(field));
  }
  return recorded;
}

Recorder::Recorder(std::filesystem::path path, const World& world, ViewHeader header)
    : path_(std::move(path)),
      world_(world),
      surface_(world),
      colliders_(header.colliders),
      recorded_(recorded_fields(world)),
      fields_(world, surface_),
      evaluator_(world),
      header_(encoded(std::move(header), world, surface_, recorded_)),
      codec_(new_codec()) {}

RecordingCodec Recorder::new_codec() const {
  return {surface_, recorded_.size(), world_.largest_extent(), colliders_.size()};
}

void Recorder::begin() {
  const std::string topology = encode_topology(surface_, colliders_);
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  next_number_ = 0;
  codec_ = new_codec();
  append(std::string(mark) + number_bytes(header_.size()) + header_ + number_bytes(topology.size()) +
         topology);
}

void Recorder::keep(std::uint32_t end) {
  std::ifstream stream(path_, std::ios::binary);
  if (end == 0 || !stream) return begin();
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  stream.close();
  try {
    const Recording recording = parse_recording(bytes, path_.string());
    if (recording.header != header_ || recording.topology != encode_topology(surface_, colliders_))
      return begin();
    codec_ = new_codec();
    next_number_ = 0;
    std::size_t kept = recording.records.empty() ? recording.end : recording.records.front().begin - 8;
    for (const auto& [at, payload] : recording.records) {
      if (number_at(payload, 0).value_or(end) >= end) break;
      next_number_ = codec_.decode(payload).number + 1;
      kept = at + payload.size();
    }
    std::filesystem::resize_file(path_, kept);
  } catch (const InputError&) {
    begin();  // not a recording, or not of this scene
  } catch (const std::filesystem::filesystem_error& error) {
    throw FileError(path_.string(), "cannot be written: " + reason_of_failed_write(error.code().value()));
  }
}

void Recorder::record(std::uint32_t number, const State& state) {
  RecordedFrame frame{.number = number,
                      .step = static_cast<std::uint32_t>(state.step),
                      .time = state.time,
                      .load = state.load};
  const auto n = static_cast<std::size_t>(surface_.num_vertices());
  frame.displacements.resize(3 * n);
  // Places are linear in those of the nodes; of displacements the small ones keep their digits.
  surface_.positions(state.positions - world_.rest_positions, frame.displacements);
  frame.fields.resize(recorded_.size());
  fields_.evaluate(evaluator_, state, recorded_, frame.fields);
  frame.colliders = collider_places(colliders_, conditions_of(state));
  const std::string payload = codec_.encode(frame);
  append(number_bytes(payload.size()) + number_bytes(checksum(payload)) + payload);
  next_number_ = number + 1;
}

void Recorder::append(std::string_view bytes) {
  OutputFile file(path_, OutputFile::Mode::append);
  file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
}

Recording parse_recording(std::string_view bytes, const std::string& place) {
  if (!bytes.starts_with(mark))
    throw InputError(place, "a recording, which begins with RSR1", "something else");
  Recording recording;
  std::size_t at = mark.size();
  for (std::string* part : {&recording.header, &recording.topology}) {
    const std::optional<std::uint32_t> size = number_at(bytes, at);
    if (!size || bytes.size() - at - 4 < *size)
      throw InputError(place, "a whole recording", "one that ends before its first frame");
    *part = bytes.substr(at + 4, *size);
    at += 4 + *size;
  }
  recording.end = at;
  while (true) {
    const std::optional<std::uint32_t> size = number_at(bytes, at), sum = number_at(bytes, at + 4);
    if (!size || !sum || bytes.size() - at - 8 < *size) return recording;
    const std::string_view payload = bytes.substr(at + 8, *size);
    if (checksum(payload) != *sum) return recording;
    recording.records.push_back({at + 8, payload});
    at = recording.end = at + 8 + *size;
  }
}

}  // namespace resilin
