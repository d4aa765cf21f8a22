#include "resilin/petsc/shared_results.hpp"

#include <algorithm>
#include <chrono>
#include <string_view>
#include <type_traits>

#include "resilin/core/archive.hpp"
#include "resilin/core/error.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/vtu.hpp"
#include "resilin/results/build_info.hpp"
#include "resilin/results/file_names.hpp"
#include "resilin/results/folder_lock.hpp"
#include "resilin/results/frame_file.hpp"
#include "resilin/results/report.hpp"
#include "resilin/results/saved_report.hpp"

namespace resilin {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// "0007": the folder of a frame's pieces; the frame itself ends with .pvtu.
std::string frame_stem(std::size_t number) {
  return std::filesystem::path(numbered_vtu(number)).stem().string();
}

/// The vectors of a state with one number per unknown each, some of them empty. There is no history:
/// viscoelastic materials are refused (require_distributable).
std::vector<VectorX*> state_vectors(State& state) {
  std::vector<VectorX*> vectors;
  visit_members(state, [&vectors](std::string_view name, auto& value) {
    if constexpr (std::is_same_v<decltype(value), VectorX&>)
      if (name != "history") vectors.push_back(&value);
  });
  return vectors;
}

/// The smaller, or larger, of two entries of "extremes"; by number where they are alike.
bool is_better(const Json& a, const Json& b, bool is_min, const char* number) {
  if (a["value"] == b["value"]) return a[number] < b[number];
  return is_min ? a["value"] < b["value"] : a["value"] > b["value"];
}

void merge_extremes(const Json& theirs, Json& all) {
  for (const auto& [field, ends] : theirs.items()) {
    if (!all.contains(field)) {
      all[field] = ends;
      continue;
    }
    for (const char* end : {"min", "max"}) {
      const char* number = ends[end].contains("vertex") ? "vertex" : "cell";
      if (is_better(ends[end], all[field][end], std::string(end) == "min", number))
        all[field][end] = ends[end];
    }
  }
}

}  // namespace

struct SharedResults::Contents {
  Contents(std::filesystem::path path, const SharedScene& shared, double seconds)
      : folder(std::move(path)), scene(shared), evaluator(*shared.world), seconds_before(seconds) {}

  const World& world() const { return *scene.world; }
  const ProcessGroup& share() const { return scene.world->share; }
  bool is_first() const { return share().is_first(); }

  std::filesystem::path folder;
  const SharedScene& scene;
  std::optional<FolderLock> lock;  ///< the first process has it
  Json frames = Json::array();     ///< likewise
  int last_step = -1;              ///< last step of the last frame
  std::size_t num_frames = 0;
  FieldEvaluator evaluator;
  Clock::time_point start = Clock::now(), next_save = Clock::now();
  double output_seconds = 0, seconds_before;
  int resumed_step = -1;

  /// The extremes of all processes, by numbers of the whole scene; on the first.
  Json extremes(Json own) const {
    for (auto& [field, ends] : own.items())
      for (auto& [end, entry] : ends.items()) {
        const auto is_it = [&](const Body& body) { return body.name == entry["body"].get<std::string>(); };
        const auto b =
            static_cast<std::size_t>(std::ranges::find_if(world().bodies, is_it) - world().bodies.begin());
        if (entry.contains("cell")) {
          entry["cell"] = world().cell_number(b, entry["cell"].get<Index>());
        } else {
          entry["vertex"] = share().number_of(world().bodies[b].first_node + entry["vertex"].get<Index>());
        }
      }
    Json all = Json::object();
    for (const std::string& theirs : share().exchange().gather(own.dump()))
      merge_extremes(Json::parse(theirs), all);
    // Vertices are numbered body by body.
    for (auto& [field, ends] : all.items())
      for (auto& [end, entry] : ends.items())
        if (entry.contains("vertex"))
          for (std::size_t b = 0; b < world().bodies.size(); ++b)
            if (world().bodies[b].name == entry["body"].get<std::string>())
              entry["vertex"] = entry["vertex"].get<Index>() - scene.whole.first_nodes[b];
    return all;
  }

  void write_frame_of_all(const State& state, const std::vector<FieldValues>& fields) {
    const std::string stem = frame_stem(num_frames);
    const std::filesystem::path pieces = folder / "frames" / stem;
    std::error_code error;
    if (is_first()) std::filesystem::create_directories(pieces, error);
    share().any(false);  // the folder is there
    const VtuContent content = frame_content(world(), state, fields);
    write_frame(pieces / (std::to_string(share().exchange().rank()) + ".vtu"), content);
    share().any(false);  // the pieces are there
    if (!is_first()) return;
    VtuData names;
    for (const VtuValues& array : content.point_data)
      names.point_data.push_back({.name = array.name, .components = array.components, .values = {}});
    for (const VtuValues& array : content.cell_data)
      names.cell_data.push_back({.name = array.name, .components = array.components, .values = {}});
    std::vector<std::string> sources;
    for (int rank = 0; rank < share().exchange().num_ranks(); ++rank)
      sources.push_back(stem + "/" + std::to_string(rank) + ".vtu");
    write_pvtu(folder / "frames" / (stem + ".pvtu"), names, sources);
  }

  /// The whole state, on the first process.
  State whole_state(const State& own) const {
    State whole = own;
    for (VectorX* vector : state_vectors(whole))
      if (vector->size() > 0) *vector = gathered(share(), *vector, scene.whole.num_nodes);
    return whole;
  }

  void save(const Simulation& simulation, const RunOutcome& outcome) {
    const Clock::time_point begin = Clock::now();
    const State state = whole_state(simulation.state());
    MostStrained strained = simulation.most_strained();
    if (strained.positions.size() > 0)
      strained.positions = gathered(share(), strained.positions, scene.whole.num_nodes);
    if (is_first()) {
      write_frame_list();
      RunSummary summary =
          summary_of(simulation, outcome, seconds_before + seconds_since(start), output_seconds);
      Json report = report_json(world(), frames, summary);
      report["bodies"] = Json::parse(scene.whole.bodies_json);
      for (Json& body : report["bodies"])
        body["discretisation_error"] = body["discretisation_error_by"] = body["mesh_volume_ratio"] = nullptr;
      report["processes"] = share().exchange().num_ranks();
      write_text(folder / report_name, report_text(report));
      write_text(folder / checkpoint_name, serialize(Checkpoint{.version = std::string(version()),
                                                                .fingerprint = world().fingerprint,
                                                                .failed_steps = simulation.failed_steps(),
                                                                .most_strained = std::move(strained),
                                                                .state = state}));
    }
    const double cost = seconds_since(begin);
    output_seconds += cost;
    next_save = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(std::max(1.0, 10 * cost)));
  }

  void write_frame_list() const {
    if (!world().output.writes(OutputFormat::vtu)) return;
    std::vector<PvdEntry> entries;
    for (std::size_t i = 0; i < frames.size(); ++i)
      entries.push_back({frames[i][world().is_dynamic ? "time" : "load"].get<double>(),
                         "frames/" + frame_stem(i) + ".pvtu"});
    write_pvd(folder / "frames.pvd", entries);
  }

  void drop_last_frame() {
    --num_frames;
    if (is_first()) frames.erase(frames.size() - 1);
  }
};

SharedResults::SharedResults(std::filesystem::path folder, const SharedScene& scene, double seconds_before)
    : contents_(std::make_unique<Contents>(std::move(folder), scene, seconds_before)) {
  on_first_process(contents_->share(), [this] {
    std::error_code error;
    std::filesystem::create_directories(contents_->folder / "frames", error);
    if (error)
      throw FileError(contents_->folder.string(),
                      "the folder for the results cannot be made (" + error.message() + ")");
    contents_->lock.emplace(contents_->folder);
    for (const char* part : {".", "frames"}) remove_partial_files(contents_->folder / part);
  });
}

SharedResults::~SharedResults() = default;

double SharedResults::output_seconds() const { return contents_->output_seconds; }

SharedResults::Resumed SharedResults::resume(Simulation& simulation, Resume rule) {
  Contents& own = *contents_;
  const std::filesystem::path path = own.folder / checkpoint_name;
  Resumed resumed;
  Checkpoint checkpoint;
  ArchiveWriter told;
  on_first_process(own.share(), [&] {
    if (!std::filesystem::exists(path)) return;
    checkpoint = parse_checkpoint(read_file(path), path.string());
    resumed = {true, check_scene(checkpoint, own.world().fingerprint, rule, path.string())};
    check_state(checkpoint.state, Eigen::Index{own.scene.whole.num_nodes} * own.world().dimension, 0,
                path.string());
    if (resumed.difference) {
      checkpoint.state.accelerations.resize(0);
      checkpoint.most_strained = {};
    }
    SavedReport report = read_report(own.folder / report_name);
    for (Json& frame : report.frames)
      if (frame["step"].get<int>() <= checkpoint.state.step) own.frames.push_back(std::move(frame));
    own.seconds_before += report.total_seconds;
  });
  // Everything but the vectors goes to all processes, these part by part.
  Checkpoint small = checkpoint;
  std::vector<std::uint8_t> has_vector;
  for (VectorX* vector : state_vectors(small.state)) {
    has_vector.push_back(vector->size() > 0 ? 1 : 0);
    vector->resize(0);
  }
  has_vector.push_back(checkpoint.most_strained.positions.size() > 0 ? 1 : 0);
  small.most_strained.positions.resize(0);
  const int last_step = own.frames.empty() ? -1 : own.frames.back()["step"].get<int>();
  told(resumed.has_checkpoint, has_vector, own.frames.size(), last_step, serialize(small));
  const ProcessGroup& share = own.share();
  const std::string bytes = share.exchange().tell(0, told.take());
  std::string image;
  ArchiveReader reader(bytes, path.string());
  reader(resumed.has_checkpoint, has_vector, own.num_frames, own.last_step, image);
  if (!resumed.has_checkpoint) return resumed;
  small = parse_checkpoint(image, path.string());
  const std::vector<VectorX*> own_vectors = state_vectors(small.state),
                              whole_vectors = state_vectors(checkpoint.state);
  std::size_t i = 0;
  for (; i < own_vectors.size(); ++i)
    if (has_vector[i] != 0) *own_vectors[i] = scattered(share, *whole_vectors[i]);
  if (has_vector[i] != 0)
    small.most_strained.positions = scattered(share, checkpoint.most_strained.positions);
  own.resumed_step = small.state.step;
  on_all_processes(
      [&] { simulation.resume_from(small.state, path.string(), small.failed_steps, small.most_strained); });
  return resumed;
}

void SharedResults::record(const Simulation& simulation, bool is_last) {
  Contents& own = *contents_;
  const Frame& frame = simulation.frame();
  const int every = own.world().output.every;
  const bool is_new = frame.step != own.resumed_step && own.last_step < frame.step;
  if (is_new && (is_last || frame.step % every == 0)) {
    const Clock::time_point begin = Clock::now();
    if (own.num_frames > 0 && own.last_step % every != 0) own.drop_last_frame();
    const State& state = simulation.state();
    std::vector<std::string> names = own.world().output.fields;
    const std::size_t num_asked = names.size();
    if (own.world().is_dynamic && std::ranges::find(names, "velocity") == names.end())
      names.emplace_back("velocity");
    std::vector<FieldValues> fields = own.evaluator.evaluate(state, names);
    if (own.world().output.writes(OutputFormat::vtu)) own.write_frame_of_all(state, fields);
    fields.erase(fields.begin() + static_cast<std::ptrdiff_t>(num_asked), fields.end());
    Json entry = frame_json(frame, own.world(), state, fields);
    entry["extremes"] = own.extremes(std::move(entry["extremes"]));
    if (own.is_first()) own.frames.push_back(std::move(entry));
    ++own.num_frames;
    own.last_step = frame.step;
    own.output_seconds += seconds_since(begin);
  }
  const bool is_due = own.is_first() && Clock::now() >= own.next_save;
  if (own.share().any(is_due))
    own.save(simulation, {RunStatus::running, "the run had not ended when this was written"});
}

void SharedResults::finish(const Simulation& simulation, const RunOutcome& outcome) {
  Contents& own = *contents_;
  own.save(simulation, outcome);
  if (!own.is_first()) return;
  // Frames of an earlier, longer run into the same folder are not part of this one.
  std::error_code error;
  for (std::size_t i = own.num_frames;
       std::filesystem::remove(own.folder / "frames" / (frame_stem(i) + ".pvtu"), error); ++i)
    std::filesystem::remove_all(own.folder / "frames" / frame_stem(i), error);
}

}  // namespace resilin
