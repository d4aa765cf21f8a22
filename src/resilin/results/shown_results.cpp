#include "resilin/results/shown_results.hpp"

#include <algorithm>
#include <ostream>

#include "resilin/core/log.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/results/file_names.hpp"
#include "resilin/results/frame_fields.hpp"
#include "resilin/results/saved_run.hpp"
#include "resilin/view/page.hpp"

namespace resilin {
namespace {

constexpr const char* page_name = "result.html";
constexpr const char* stage_name = "result.usda";
constexpr const char* points_name =
    "result.usda.points";  ///< points name of the stage, while there is more to come

Vector3 up_of(const World& world) {
  if (world.dimension == 2) return Vector3::UnitY();
  return world.gravity.norm() > 0 ? Vector3(-world.gravity.normalized()) : Vector3(Vector3::UnitZ());
}

/// A ground that stands still and lies flat.
struct Ground {
  std::size_t number;  ///< number of the collider
  double height;       ///< along up [m]
};
std::optional<Ground> ground_of(const World& world) {
  const Vector3 up = up_of(world);
  for (std::size_t i = 0; i < world.colliders.size(); ++i) {
    const ColliderBarrier& collider = *world.colliders[i];
    const Vector3 point = collider.place({});
    const Vector3 normal = collider.motion().place(0).turned(collider.shape().normal(point));
    if (collider.shape().is_flat() && collider.motion().is_at_rest() && normal.dot(up) > 0.9999)
      return Ground{i, point.dot(up)};
  }
  return std::nullopt;
}

ViewHeader header_of(const World& world) {
  ViewHeader header{.title = world.title,
                    .version = std::string(version()),
                    .up = up_of(world),
                    .gravity = world.gravity,
                    .colliders = shown_colliders(world)};
  if (const std::optional<Ground> ground = ground_of(world)) {
    header.ground = ground->height;
    header.colliders.erase(header.colliders.begin() + static_cast<std::ptrdiff_t>(ground->number));
  }
  return header;
}

void remove_file(const std::filesystem::path& path) {
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

std::uintmax_t size_of(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  return error ? 0 : size;
}

}  // namespace

std::string escaped_for_page(std::string_view json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? letters[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string page_with_recording(std::string_view recording, std::string_view report, std::string_view fields,
                                std::string_view more) {
  return page_with(source_script("embedded") + "\n<script id=\"recording\" type=\"text/plain\">" +
                       base64(recording) + "</script>\n<script id=\"report\" type=\"application/json\">" +
                       escaped_for_page(report) +
                       "</script>\n<script id=\"fields\" type=\"application/json\">" +
                       escaped_for_page(fields) + "</script>" + std::string(more),
                   "");
}

std::string fields_beside_recording(const std::filesystem::path& folder, const World& world,
                                    std::size_t num_frames) {
  std::vector<std::filesystem::path> files = frame_files(folder);
  if (!world.output.writes(OutputFormat::vtu) || num_frames > ShownResults::most_values_of_a_field ||
      files.size() < num_frames)
    return "[]";
  files.resize(num_frames);
  FrameFields frames(world, std::move(files));
  if (frames.num_values() > ShownResults::most_values_of_a_field) return "[]";
  const std::vector<ScalarField> fields = SurfaceFields::quick(world.dimension);
  const std::vector<std::string> values = frames.values(fields, [] { return true; });
  std::string list;
  for (std::size_t i = 0; i < fields.size(); ++i)
    list += (i > 0 ? ",\n" : "") + ("{\"field\": " + encode_field_info(fields[i], world)) +
            ", \"values\": \"" + base64(deflated(values[i])) + "\"}";
  return "[" + list + "]";
}

std::string recorded_page(const std::filesystem::path& folder, const World& world,
                          std::span<const NumberedState> frames, std::string_view report) {
  const std::filesystem::path path = folder / recording_name;
  Recorder recorder(path, world, header_of(world));
  recorder.keep(0);
  for (const auto& [number, state] : frames) recorder.record(static_cast<std::uint32_t>(number), *state);
  return page_with_recording(read_file(path), report);
}

ShownResults::ShownResults(std::filesystem::path folder, const World& world)
    : folder_(std::move(folder)), world_(world), title_(world.title), counts_frames_(!world.is_dynamic) {
  if (world.output.writes(OutputFormat::html)) {
    recorder_ = std::make_unique<Recorder>(folder_ / recording_name, world, header_of(world));
  } else {
    remove_file(folder_ / recording_name);
    remove_file(folder_ / page_name);
  }
  if (world.output.writes(OutputFormat::usda)) {
    usda_ = std::make_unique<UsdaWriter>(folder_ / points_name, world, up_of(world));
    if (world.is_dynamic && !world.adaptive) codes_per_second_ = 1 / (world.time_step * world.output.every);
  } else {
    remove_file(folder_ / stage_name);
    remove_file(folder_ / points_name);
  }
}

/// Keeps as much of the files as agrees with a report of so many frames.
void ShownResults::keep(std::size_t num_frames) {
  const auto end = static_cast<std::uint32_t>(num_frames);
  if (recorder_ && (end == 0 || recorder_->next_number() != end)) recorder_->keep(end);
  if (usda_ && (end == 0 || usda_->num_frames() != num_frames)) usda_->keep(num_frames);
}

void ShownResults::record(std::size_t number, const State& state) {
  keep(number);
  if (recorder_) recorder_->record(static_cast<std::uint32_t>(number), state);
  const double time = counts_frames_ ? static_cast<double>(number) / codes_per_second_ : state.time;
  if (usda_) usda_->record(state.positions, time);
}

std::vector<std::pair<std::string, std::uintmax_t>> ShownResults::finish(std::size_t num_frames,
                                                                         const std::string& report) {
  keep(num_frames);
  std::vector<std::pair<std::string, std::uintmax_t>> files;
  const std::filesystem::path recording = folder_ / recording_name;
  if (recorder_ && size_of(recording) > largest_embedded) {
    remove_file(folder_ / page_name);
    log_warning(
        recording.string() + " has " + format_bytes(size_of(recording)) +
        ", too much for one page: \"resilin view\" shows the folder; output.every writes fewer frames");
  } else if (recorder_) {
    const std::string page = page_with_recording(read_file(recording), report,
                                                 fields_beside_recording(folder_, world_, num_frames));
    write_atomically(folder_ / page_name, [&page](std::ostream& stream) { stream << page; });
    files.emplace_back(page_name, page.size());
  }
  // A run that was complete already has its stage, and its points are gone.
  if (usda_ && (usda_->num_frames() > 0 || !std::filesystem::exists(folder_ / stage_name))) {
    write_atomically(folder_ / stage_name,
                     [this](std::ostream& stream) { usda_->write(stream, title_, codes_per_second_); });
  }
  if (usda_) files.emplace_back(stage_name, size_of(folder_ / stage_name));
  return files;
}

void ShownResults::remove_leftovers() {
  if (usda_) usda_->remove_points();
}

}  // namespace resilin
