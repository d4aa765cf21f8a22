#include "resilin/results/results.hpp"

#include <algorithm>
#include <chrono>
#include <future>
#include <iterator>
#include <vector>

#include "resilin/core/background.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/stopwatch.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/vtu.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/results/collider_file.hpp"
#include "resilin/results/file_names.hpp"
#include "resilin/results/folder_lock.hpp"
#include "resilin/results/frame_file.hpp"
#include "resilin/results/report.hpp"
#include "resilin/results/saved_report.hpp"
#include "resilin/results/saved_run.hpp"
#include "resilin/results/shown_results.hpp"
#include "resilin/world/shown_colliders.hpp"

namespace resilin {
std::vector<std::string> fields_of_report(const World& world) {
  std::vector<std::string> names = world.output.fields;
  if (!world.output.writes(OutputFormat::html)) return names;
  for (const ScalarField& shown : recorded_fields(world))
    if (std::ranges::find(names, shown.field->name) == names.end()) names.push_back(shown.field->name);
  return names;
}

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr Offset most_cells_beside = 200'000;
constexpr const char* collider_list_name = "colliders.pvd";

std::string frame_name(std::size_t number) { return "frames/" + numbered_vtu(number); }

/// The lists of frames that ParaView opens, of bodies and of colliders; statics count in load factors, or in
/// steps where the load falls or where they show vibrations.
void write_frame_lists(const std::filesystem::path& folder, const Json& frames, const World& world) {
  const char* counter = world.is_dynamic ? "time" : "load";
  const auto is_behind = [](const Json& a, const Json& b) { return b["load"] <= a["load"]; };
  if (!world.is_dynamic && std::adjacent_find(frames.begin(), frames.end(), is_behind) != frames.end())
    counter = "step";
  std::vector<PvdEntry> bodies, colliders;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto time = frames[i][counter].get<double>();
    bodies.push_back({time, frame_name(i)});
    colliders.push_back({time, collider_file_name(world, i)});
  }
  write_pvd(folder / "frames.pvd", bodies);
  if (has_colliders(world)) write_pvd(folder / collider_list_name, colliders);
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
  std::optional<FieldEvaluator> evaluator;  ///< evaluator of the world whose states are recorded
  std::optional<ShownResults> shown;        ///< shown surface of the same world
  std::vector<std::pair<std::string, std::uintmax_t>> shown_files;
  double output_seconds = 0;  ///< waiting time of the run
  double seconds_before;      ///< until the folder was made, and of the run that this one resumes
  int resumed_step =
      -1;  ///< step whose frame was measured again, without the numbers of the step that led to it

  /// Waits for what is written beside a step; throws what went wrong with it.
  void settle() {
    const Stopwatch waiting(output_seconds);
    if (writing.valid()) writing.get();
  }

  /// Writes a state as the next frame when it is due, and then, given a summary, report and checkpoint:
  /// beside the next step where that is safe.
  void record(const World& world, const State& state, const Frame& frame, bool is_last,
              const std::optional<RunSummary>& so_far) {
    const bool is_new =
        frame.step != resumed_step && (frames.empty() || frames.back()["step"].get<int>() < frame.step);
    const bool is_due = is_new && (is_last || frame.step % world.output.every == 0);
    if (!is_due && !so_far) return;
    const auto work = [this, &world, is_due, so_far](const State& of, const Frame& measured) {
      if (is_due) write_next(world, of, measured);
      if (so_far) save(world, of, *so_far, false);
    };
    const Stopwatch waiting(output_seconds);
    if (is_last || !can_write_beside(world)) return work(state, frame);
    writing = run_beside([work, state, frame] { work(state, frame); });
    if (writing.wait_for(std::chrono::seconds(0)) == std::future_status::ready) writing.get();
  }

  /// Fields of contact between bodies ask what the next step changes; of large bodies the fields of a frame
  /// take as much memory as a step.
  static bool can_write_beside(const World& world) {
    Offset num_cells = 0;
    for (const Body& body : world.bodies) num_cells += body.num_cells();
    return !world.contact && num_cells <= most_cells_beside;
  }

  void write_next(const World& world, const State& state, const Frame& frame) {
    // The last frame of a run that was broken off is not one of the unbroken run, unless it was due.
    if (!frames.empty() && frames.back()["step"].get<int>() % world.output.every != 0)
      frames.erase(frames.size() - 1);
    const std::vector<FieldValues> fields = write(world, state);
    frames.push_back(frame_json(frame, world, state, fields));
  }

  /// Writes a state as the next frame of all formats; gives the fields whose extremes the report has.
  std::vector<FieldValues> write(const World& world, const State& state) {
    if (!evaluator) {
      evaluator.emplace(world);
      if (writes_vtu(world)) save_scene(folder, world);
      begin_colliders(world);
    }
    std::vector<std::string> names = fields_of_report(world);
    const auto num_asked = static_cast<std::ptrdiff_t>(world.output.fields.size());
    const auto num_reported = static_cast<std::ptrdiff_t>(names.size());
    // Data from which other fields are computed, beside the places (`state_of_frame`).
    const auto keep = [&names](const char* name) {
      if (std::ranges::find(names, name) == names.end()) names.emplace_back(name);
    };
    if (world.is_dynamic) keep("velocity");
    if (!world.origin.isZero(0)) keep("displacement");  // it has digits that far places lose
    std::vector<FieldValues> fields = evaluator->evaluate(state, names);
    std::vector<FieldValues> shown_alone(std::make_move_iterator(fields.begin() + num_asked),
                                         std::make_move_iterator(fields.begin() + num_reported));
    fields.erase(fields.begin() + num_asked, fields.begin() + num_reported);
    if (writes_vtu(world)) {
      write_frame(folder / frame_name(frames.size()), frame_content(world, state, fields));
      write_colliders(world, state);
    }
    shown_of(world).record(frames.size(), state);
    fields.erase(fields.begin() + num_asked, fields.end());
    std::ranges::move(shown_alone, std::back_inserter(fields));
    return fields;
  }

  /// Removes files of an earlier run for colliders that do not exist any more.
  void begin_colliders(const World& world) const {
    std::error_code error;
    if (writes_vtu(world) && has_colliders(world)) {
      std::filesystem::create_directories(folder / "colliders", error);
      return;
    }
    remove_collider_files(folder, 0);
    std::filesystem::remove(folder / "colliders", error);  // where nothing else is in it
    std::filesystem::remove(folder / collider_list_name, error);
  }

  /// Colliders that stand still have one file, that of the first frame, whichever run has written it.
  void write_colliders(const World& world, const State& state) {
    if (!has_colliders(world)) return;
    const std::filesystem::path file = folder / collider_file_name(world, frames.size());
    const bool is_first = frames.empty() || any_collider_moves(world);
    if (is_first || !std::filesystem::is_regular_file(file))
      write_frame(file, collider_content(world, state));
  }

  RunSummary summary(const Simulation& simulation, const RunOutcome& outcome) const {
    return summary_of(simulation, outcome, seconds_before + seconds_since(start), output_seconds);
  }

  /// @param is_end  the run has ended for now: what is made of all frames is made, too
  void save(const World& world, const State& state, const RunSummary& summary, bool is_end) {
    const Clock::time_point begin = Clock::now();
    if (!frames.empty() && writes_vtu(world)) write_frame_lists(folder, frames, world);
    Json report = report_json(world, std::move(frames), summary);
    // The report first: a checkpoint never runs ahead of the frames that go with it.
    if (is_end) {
      shown_files = shown_of(world).finish(report["frames"].size(), report_text(report));
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
    // Not before the checkpoint is there: a run that is killed in between goes on from the one before.
    if (is_end && summary.outcome.status == RunStatus::done) shown_of(world).remove_leftovers();
    const double cost = seconds_since(begin);
    // At most a tenth of the time goes into saving, however long the report has grown.
    next_save = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(std::max(1.0, 10 * cost)));
  }

  ShownResults& shown_of(const World& world) {
    if (!shown) shown.emplace(folder, world);
    return *shown;
  }

  static bool writes_vtu(const World& world) { return world.output.writes(OutputFormat::vtu); }

  /// Nobody reads its data before `settle`. The last member, so that it ends before others go.
  std::future<void> writing;
};

ResultFolder::ResultFolder(std::filesystem::path folder, double seconds_before) {
  std::error_code error;
  std::filesystem::create_directories(folder / "frames", error);
  if (error)
    throw FileError(folder.string(), "the folder for the results cannot be made (" + error.message() + ")");
  contents_ = std::make_unique<Contents>(std::move(folder), seconds_before);
  // Removes files that a killed run has left; the lock keeps others out.
  for (const char* part : {".", "frames", "colliders"}) remove_partial_files(contents_->folder / part);
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
  if (resumed.difference) {  // those of the scene as it was
    checkpoint.state.accelerations.resize(0);
    std::error_code error;
    if (!any_collider_moves(simulation.world()))
      std::filesystem::remove(contents_->folder / collider_file_name(simulation.world(), 0), error);
  }
  SavedReport report = read_report(contents_->folder / report_name);
  // In another scene the strain then is none of this one's.
  simulation.resume_from(checkpoint.state, path.string(), checkpoint.failed_steps,
                         resumed.difference ? MostStrained{} : checkpoint.most_strained);
  for (Json& frame : report.frames)
    if (frame["step"].get<int>() <= checkpoint.state.step) contents_->frames.push_back(std::move(frame));
  contents_->seconds_before += report.total_seconds;
  contents_->resumed_step = checkpoint.state.step;
  return resumed;
}

void ResultFolder::record(const Simulation& simulation, bool is_last) {
  contents_->settle();
  std::optional<RunSummary> so_far;
  if (Clock::now() >= contents_->next_save)
    so_far = contents_->summary(simulation, {RunStatus::running, std::string(running_reason)});
  contents_->record(simulation.world(), simulation.state(), simulation.frame(), is_last, so_far);
}

void ResultFolder::record(const World& world, const State& state, const Frame& frame, bool is_last) {
  contents_->settle();
  contents_->record(world, state, frame, is_last, std::nullopt);
}

void ResultFolder::add(const World& world, const State& state, const std::string& frame) {
  contents_->settle();
  contents_->write(world, state);
  contents_->frames.push_back(Json::parse(frame));
}

void ResultFolder::finish(const Simulation& simulation, const RunOutcome& outcome) {
  contents_->settle();
  finish(simulation.world(), simulation.state(), contents_->summary(simulation, outcome));
}

void ResultFolder::finish(const World& world, const State& state, const RunSummary& summary) {
  contents_->settle();
  const Stopwatch waiting(contents_->output_seconds);
  contents_->save(world, state, summary, true);
  // Frames of an earlier, longer run into the same folder are not part of this one.
  std::error_code error;
  for (std::size_t i = contents_->frames.size();
       std::filesystem::remove(contents_->folder / frame_name(i), error);)
    ++i;
  if (has_colliders(world))
    remove_collider_files(contents_->folder, any_collider_moves(world) ? contents_->frames.size() : 1);
}

}  // namespace resilin
