#include "resilin/results/results.hpp"

#include <algorithm>
#include <chrono>
#include <string_view>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/output_file.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/vtu.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/results/folder_lock.hpp"
#include "resilin/results/frame_file.hpp"
#include "resilin/results/report.hpp"
#include "resilin/results/saved_report.hpp"
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
constexpr std::string_view partial_ending = ".partial";  ///< of a file that is not whole yet

void write_text(const std::filesystem::path& path, const std::string& text) {
  write_atomically(path, [&text](std::ostream& stream) { stream << text; });
}

/// Removes what a run that was killed has left half-written; nobody else writes into the folder.
void sweep_partial_files(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const std::size_t at = name.rfind(partial_ending);
    if (at == std::string::npos ||
        name.find_first_not_of("0123456789.", at + partial_ending.size()) != std::string::npos)
      continue;
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) std::filesystem::remove(entry->path(), ignored);
  }
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
  Contents(std::filesystem::path path, double seconds)
      : folder(std::move(path)), lock(folder), seconds_before(seconds) {}

  std::filesystem::path folder;
  FolderLock lock;
  Json frames = Json::array();
  Clock::time_point start = Clock::now();
  Clock::time_point next_save = Clock::now();
  std::optional<FieldEvaluator> evaluator;  ///< of the world whose states are recorded
  std::optional<ShownResults> shown;        ///< of the same
  std::vector<std::pair<std::string, std::uintmax_t>> shown_files;
  double output_seconds = 0;
  double seconds_before;  ///< until the folder was made, and of the run that this one resumes
  int resumed_step = -1;  ///< whose frame was measured anew, without the numbers of the step that led to it

  /// Beside and renamed, so that the file is whole even when the program is killed. Report and checkpoint
  /// also wait for the disk; a frame does not, for that takes longer than a step of a small body: a power cut
  /// may take the last frames, never the way to go on.
  void write_frame(std::size_t number, const World& world, const State& state,
                   std::span<const FieldValues> fields) {
    const std::filesystem::path path = folder / frame_name(number);
    std::filesystem::path partial = path;
    partial += partial_ending;
    try {
      OutputFile file(partial, OutputFile::Mode::truncate, path);
      resilin::write_frame(file.stream(), frame_content(world, state, fields));
      file.close();
      std::error_code error;
      std::filesystem::rename(partial, path, error);
      if (error)
        throw FileError(path.string(), "cannot be written: " + reason_of_failed_write(error.value()));
    } catch (...) {
      std::error_code ignored;
      std::filesystem::remove(partial, ignored);
      throw;
    }
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
    const auto keep = [&names](const char* name) {
      if (std::ranges::find(names, name) == names.end()) names.emplace_back(name);
    };
    if (world.is_dynamic) keep("velocity");
    if (!world.origin.isZero(0)) keep("displacement");  // which has digits that far places lose
    std::vector<FieldValues> fields = evaluator->evaluate(state, names);
    if (writes_vtu(world)) write_frame(frames.size(), world, state, fields);
    shown_of(world).record(frames.size(), state);
    fields.erase(fields.begin() + static_cast<std::ptrdiff_t>(num_asked), fields.end());
    return fields;
  }

  RunSummary summary(const Simulation& simulation, const RunOutcome& outcome) const {
    return {.outcome = outcome,
            .solver = std::string(simulation.solver_name()),
            .failed_steps = simulation.failed_steps(),
            .most_strained = simulation.most_strained(),
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
    write_text(folder / checkpoint_name, serialize(Checkpoint{.version = std::string(version()),
                                                              .fingerprint = world.fingerprint,
                                                              .failed_steps = summary.failed_steps,
                                                              .most_strained = summary.most_strained,
                                                              .state = state}));
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

ResultFolder::ResultFolder(std::filesystem::path folder, double seconds_before) {
  std::error_code error;
  std::filesystem::create_directories(folder / "frames", error);
  if (error)
    throw FileError(folder.string(), "the folder for the results cannot be made (" + error.message() + ")");
  contents_ = std::make_unique<Contents>(std::move(folder), seconds_before);
  for (const char* part : {".", "frames"}) sweep_partial_files(contents_->folder / part);
  write_text(contents_->folder / "frames" / ".probe", "");
  std::filesystem::remove(contents_->folder / "frames" / ".probe", error);
}

ResultFolder::~ResultFolder() = default;

const std::filesystem::path& ResultFolder::path() const { return contents_->folder; }

double ResultFolder::output_seconds() const { return contents_->output_seconds; }

const std::vector<std::pair<std::string, std::uintmax_t>>& ResultFolder::shown_files() const {
  return contents_->shown_files;
}

const std::string& ResultFolder::previous_holder() const { return contents_->lock.previous_holder(); }

ResultFolder::Resumed ResultFolder::resume(Simulation& simulation, Resume rule) {
  const std::filesystem::path path = contents_->folder / checkpoint_name;
  if (!std::filesystem::exists(path)) return {};
  Checkpoint checkpoint = parse_checkpoint(read_file(path), path.string());
  Resumed resumed{.has_checkpoint = true,
                  .difference = check_scene(checkpoint, simulation.world().fingerprint, rule, path.string())};
  // Those of the scene as it was.
  if (resumed.difference) checkpoint.state.accelerations.resize(0);
  SavedReport report = read_report(contents_->folder / report_name);
  // Of another scene the strain then is none of this one's.
  simulation.resume_from(checkpoint.state, path.string(), checkpoint.failed_steps,
                         resumed.difference ? MostStrained{} : checkpoint.most_strained);
  for (Json& frame : report.frames)
    if (frame["step"].get<int>() <= checkpoint.state.step) contents_->frames.push_back(std::move(frame));
  contents_->seconds_before += report.total_seconds;
  contents_->resumed_step = checkpoint.state.step;
  return resumed;
}

void ResultFolder::record(const Simulation& simulation, bool is_last) {
  record(simulation.world(), simulation.state(), simulation.frame(), is_last);
  if (Clock::now() >= contents_->next_save) {
    contents_->save(
        simulation.world(), simulation.state(),
        contents_->summary(simulation, {RunStatus::running, "the run had not ended when this was written"}),
        false);
  }
}

void ResultFolder::record(const World& world, const State& state, const Frame& frame, bool is_last) {
  Json& frames = contents_->frames;
  const bool is_new = frame.step != contents_->resumed_step &&
                      (frames.empty() || frames.back()["step"].get<int>() < frame.step);
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

void ResultFolder::finish(const Simulation& simulation, const RunOutcome& outcome) {
  finish(simulation.world(), simulation.state(), contents_->summary(simulation, outcome));
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
