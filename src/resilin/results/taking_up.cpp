#include "resilin/results/taking_up.hpp"

#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/results/file_names.hpp"
#include "resilin/results/frame_file.hpp"
#include "resilin/results/moment.hpp"
#include "resilin/results/playable_page.hpp"
#include "resilin/results/saved_report.hpp"
#include "resilin/results/saved_run.hpp"
#include "resilin/results/shown_results.hpp"
#include "resilin/view/recording.hpp"

namespace resilin {
namespace {

constexpr const char* cure = "run the scene again with formats = [\"vtu\", \"html\"] in [output]";

/// Head of a frame's record before its numbers (docs/view_protocol.md, "Recording").
struct RecordedMoment {
  std::uint32_t number, step;
  double time, load;
};

RecordedMoment moment_of(std::string_view payload, const std::string& place) {
  static_assert(sizeof(RecordedMoment) == 24);
  RecordedMoment moment{};
  if (payload.size() < sizeof moment) throw InputError(place, "whole frames", "one of a few bytes", cure);
  std::memcpy(&moment, payload.data(), sizeof moment);
  return moment;
}

std::string words_of(const World& world, const State& state) {
  const std::string words = words_of_moment(world, state);
  return words.empty() ? "load 1" : words;
}

}  // namespace

RecordedFiles::RecordedFiles(const std::filesystem::path& folder)
    : recording(folder / recording_name), report(folder / report_name) {
  for (const std::filesystem::path& file : {recording, report})
    if (!std::filesystem::is_regular_file(file))
      throw InputError(folder.string(), "a folder of results with " + file.filename().string(), "one without",
                       cure);
  read_report(report);  // reports damage here, not in the browser
}

std::shared_ptr<const World> world_to_take_up(const std::filesystem::path& folder) {
  const RecordedFiles both_are_there(folder);
  std::shared_ptr<const World> world = saved_world(folder);
  if (!world) throw InputError(folder.string(), "a folder of results with scene.bin", "one without", cure);
  if (world->modes)
    throw InputError(folder.string(), "a static or dynamic run",
                     "a modal analysis, whose frames are mode shapes and not states",
                     "export the scene itself");
  return world;
}

State state_to_take_up(const std::filesystem::path& folder, const World& world, std::size_t number) {
  const std::filesystem::path file = folder / "frames" / numbered_vtu(number);
  if (!std::filesystem::is_regular_file(file))
    throw InputError(folder.string(), "the frame " + file.filename().string(), "none", cure);
  return state_of_frame(world, read_vtu(file), file);
}

std::string recorded_page_to_take_up(std::string_view engine, const std::filesystem::path& folder,
                                     const World& world, std::span<const std::string> notes) {
  const RecordedFiles files(folder);
  const std::string bytes = read_file(files.recording);
  const Recording recording = parse_recording(bytes, files.recording.string());
  nlohmann::json frames = nlohmann::json::array();
  std::string states;
  for (const Recording::Record& record : recording.records) {
    const RecordedMoment moment = moment_of(record.payload, files.recording.string());
    const State state = state_to_take_up(folder, world, moment.number);
    if (world.is_dynamic ? state.time != moment.time : state.load != moment.load)
      throw InputError((folder / "frames" / numbered_vtu(moment.number)).string(),
                       "the frame that was recorded", "one of another run: " + words_of(world, state), cure);
    states += packed_script("state-" + std::to_string(moment.number), serialize(state));
    frames.push_back({{"number", moment.number}, {"words", words_of(world, state)}});
    const std::uintmax_t size = bytes.size() + states.size();
    if (size > ShownResults::largest_embedded)
      throw InputError(folder.string(),
                       "frames of at most " + format_bytes(ShownResults::largest_embedded) + " together",
                       "more, which is too much for one page",
                       "write fewer (output.every), or show the folder by \"resilin view\"");
  }
  const nlohmann::json taking_up = {{"frames", std::move(frames)},
                                    {"notes", std::vector<std::string>(notes.begin(), notes.end())}};
  return page_with_recording(
      bytes, read_file(files.report), fields_beside_recording(folder, world, recording.records.size()),
      solver_scripts(engine, *world.made_from, {}) + json_script("taking_up", taking_up) + states);
}

}  // namespace resilin
