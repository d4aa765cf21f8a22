#include "resilin/results/results.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/vtu.hpp"
#include "resilin/results/frame_file.hpp"
#include "resilin/results/report.hpp"
#include "resilin/results/saved_run.hpp"
#include "resilin/results/shown_results.hpp"

namespace resilin {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr const char* checkpoint_name = "checkpoint.bin";
constexpr const char* report_name = "report.json";

void write_text(const std::filesystem::path& path, const std::string& text) {
  write_atomically(path, [&text](std::ostream& stream) { stream << text; });
}

std::string frame_name(std::size_t number) {
  const std::string digits = std::to_string(number);
  return "frames/" + std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits + ".vtu";
}

/// The list of frames that ParaView opens; statics count in load factors, or in steps where the load falls
/// or where they show vibrations.
void write_frame_list(const std::filesystem::path& path, const Json& frames, bool is_dynamic) {
  const char* counter = is_dynamic ? "time" : "load";
  const auto is_behind = [](const Json& a, const Json& b) { return b["load"] <= a["load"]; };
  if (!is_dynamic && std::adjacent_find(frames.begin(), frames.end(), is_behind) != frames.end())
    counter = "step";
  std::vector<PvdEntry> entries;
  for (std::size_t i = 0; i < frames.size(); ++i)
    entries.push_back({frames[i][counter].get<double>(), frame_name(i)});
  write_pvd(path, entries);
}

}  // namespace

struct ResultFolder::Contents {
  std::filesystem::path folder;
  Json frames = Json::array();
  Clock::time_point start = Clock::now();
  Clock::time_point next_save = Clock::now();
  std::optional<FieldEvaluator> evaluator;  ///< of the world whose states are recorded
  std::optional<ShownResults> shown;        ///< of the same
  std::vector<std::pair<std::string, std::uintmax_t>> shown_files;
  double output_seconds = 0;
  double seconds_before = 0;  ///< until the folder was made, and of the run that this one resumes

  /// Beside and renamed, so that the file is whole even when the program is killed. Report and checkpoint
  /// also wait for the disk; a frame does not, for that takes longer than a step of a small body: a power cut
  /// may take the last frames, never the way to go on.
  void write_frame(std::size_t number, const World& world, const State& state,
                   std::span<const FieldValues> fields) {
    const std::filesystem::path path = folder / frame_name(number);
    std::filesystem::path partial = path;
    partial += ".partial";
    std::ofstream stream(partial, std::ios::binary | std::ios::trunc);
    resilin::write_frame(stream, frame_content(world, state, fields));
    stream.close();
    std::error_code error;
    if (stream) std::filesystem::rename(partial, path, error);
    if (!stream || error) throw FileError(path.string(), "cannot be written; is the disk full?");
  }

  /// Writes a state as the next frame of all formats; gives the fields that the scene asks for.
  std::vector<FieldValues> write(const World& world, const State& state) {
    if (!evaluator) {
      evaluator.emplace(world);
      if (writes_vtu(world)) save_scene(folder, world);
    }
    std::vector<std::string> names = world.output.fields;
    const std::size_t num_asked = names.size();
    // What other fields are computed from, beside the places (`state_of_frame`).
    if (world.is_dynamic && std::ranges::find(names, "velocity") == names.end()) names.push_back("velocity");
    std::vector<FieldValues> fields = evaluator->evaluate(state, names);
    if (writes_vtu(world)) write_frame(frames.size(), world, state, fields);
    shown_of(world).record(frames.size(), state);
    fields.erase(fields.begin() + static_cast<std::ptrdiff_t>(num_asked), fields.end());
    return fields;
  }

  RunSummary summary(const Simulation& simulation, RunStatus status, const std::string& reason) const {
    return {.outcome = {status, reason},
            .solver = std::string(simulation.solver_name()),
            .timing = simulation.timing(),
            .total_seconds = seconds_before + seconds_since(start),
            .output_seconds = output_seconds};
  }

  /// @param is_end  the run has ended for now: what is made of all frames is made, too
  void save(const World& world, const State& state, const RunSummary& summary, bool is_end) {
    const Clock::time_point begin = Clock::now();
    if (!frames.empty() && writes_vtu(world))
      write_frame_list(folder / "frames.pvd", frames, world.is_dynamic);
    Json report = report_json(world, std::move(frames), summary);
    // The report first: a checkpoint never runs ahead of the frames that go with it.
    if (is_end) {
      shown_files = shown_of(world).finish(report["frames"].size(), report_text(report),
                                           summary.outcome.status == RunStatus::done);
      report["files"] = Json::object();
      for (const auto& [name, size] : shown_files) report["files"][name] = size;
    }
    write_text(folder / report_name, report_text(report));
    frames = std::move(report["frames"]);
    write_text(folder / checkpoint_name, serialize(state));
    const double cost = seconds_since(begin);
    output_seconds += cost;
    // At most a tenth of the time goes into saving, however long the report has grown.
    next_save = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(std::max(1.0, 10 * cost)));
  }

  ShownResults& shown_of(const World& world) {
    if (!shown) shown.emplace(folder, world);
    return *shown;
  }

  static bool writes_vtu(const World& world) { return world.output.writes(OutputFormat::vtu); }
};

ResultFolder::ResultFolder(std::filesystem::path folder, double seconds_before)
    : contents_(std::make_unique<Contents>()) {
  std::error_code error;
  std::filesystem::create_directories(folder / "frames", error);
  if (error)
    throw FileError(folder.string(), "the folder for the results cannot be made (" + error.message() + ")");
  write_text(folder / "frames" / ".probe", "");
  std::filesystem::remove(folder / "frames" / ".probe", error);
  contents_->folder = std::move(folder);
  contents_->seconds_before = seconds_before;
}

ResultFolder::~ResultFolder() = default;

const std::filesystem::path& ResultFolder::path() const { return contents_->folder; }

double ResultFolder::output_seconds() const { return contents_->output_seconds; }

const std::vector<std::pair<std::string, std::uintmax_t>>& ResultFolder::shown_files() const {
  return contents_->shown_files;
}

std::optional<State> ResultFolder::resume() {
  const std::filesystem::path checkpoint = contents_->folder / checkpoint_name;
  if (!std::filesystem::exists(checkpoint)) return std::nullopt;
  State state = deserialize_state(read_file(checkpoint), checkpoint.string());
  const std::filesystem::path report_path = contents_->folder / report_name;
  const Json report = Json::parse(read_file(report_path), nullptr, false);
  if (!report.is_object() || !report.contains("frames") || !report["frames"].is_array()) {
    throw InputError(report_path.string(), "the report of the run to go on with", "something else",
                     "run without --resume to begin again");
  }
  for (const Json& frame : report["frames"]) {
    if (frame.value("step", 0) <= state.step) contents_->frames.push_back(frame);
  }
  if (report.contains("timing")) contents_->seconds_before += report["timing"].value("total", 0.0);
  return state;
}

void ResultFolder::record(const Simulation& simulation, bool is_last) {
  record(simulation.world(), simulation.state(), simulation.frame(), is_last);
  if (Clock::now() >= contents_->next_save) {
    contents_->save(
        simulation.world(), simulation.state(),
        contents_->summary(simulation, RunStatus::running, "the run had not ended when this was written"),
        false);
  }
}

void ResultFolder::record(const World& world, const State& state, const Frame& frame, bool is_last) {
  Json& frames = contents_->frames;
  const bool is_new = frames.empty() || frames.back()["step"].get<int>() < frame.step;
  if (is_new && (is_last || frame.step % world.output.every == 0)) {
    const Clock::time_point begin = Clock::now();
    // The last frame of a run that was broken off is not one of the unbroken run, unless it was due.
    if (!frames.empty() && frames.back()["step"].get<int>() % world.output.every != 0)
      frames.erase(frames.size() - 1);
    const std::vector<FieldValues> fields = contents_->write(world, state);
    frames.push_back(frame_json(frame, world, state, fields));
    contents_->output_seconds += seconds_since(begin);
  }
}

void ResultFolder::add(const World& world, const State& state, const std::string& frame) {
  contents_->write(world, state);
  contents_->frames.push_back(Json::parse(frame));
}

void ResultFolder::finish(const Simulation& simulation, RunStatus status, const std::string& reason) {
  finish(simulation.world(), simulation.state(), contents_->summary(simulation, status, reason));
}

void ResultFolder::finish(const World& world, const State& state, const RunSummary& summary) {
  contents_->save(world, state, summary, true);
  // Frames of an earlier, longer run into the same folder are not part of this one.
  std::error_code error;
  for (std::size_t i = contents_->frames.size();
       std::filesystem::remove(contents_->folder / frame_name(i), error);)
    ++i;
}

}  // namespace resilin
