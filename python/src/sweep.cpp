#include "resilin/sweep/sweep.hpp"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "history.hpp"
#include "interruptible.hpp"
#include "resilin/core/error.hpp"
#include "resilin/io/vtu.hpp"
#include "resilin/results/saved_run.hpp"
#include "resilin/sweep/scene_run.hpp"
#include "resilin/sweep/sweep_folder.hpp"
#include "resilin/sweep/sweep_run.hpp"
#include "scene_value.hpp"

namespace resilin::python {
namespace {

SceneHash hash_of_text(const std::string& text) {
  if (const std::optional<SceneHash> hash = SceneHash::from_text(text)) return *hash;
  throw InputError("hash", "32 digits", '"' + text + '"');
}

/// (scenes, done, failed)
using Counts = std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>;

Counts counts(const SweepCount& count) { return {count.scenes, count.done, count.failed}; }

/// A run in this process: `progress` is called with (done, failed, scenes, seconds left or None). Gives
/// the number of scenes that other processes are at work on.
std::uint64_t run_in_pool(SweepFolder& folder, const std::string& shard, bool retries_failed, int jobs,
                          int threads, const nb::object& progress) {
  Interruptible interruptible;
  SweepProgress end;
  {
    const nb::gil_scoped_release release;
    end = run_sweep(folder, {.queue = {.shard = parse_shard(shard), .retries_failed = retries_failed},
                             .jobs = jobs,
                             .threads = threads,
                             .is_stopped = [&] { return interruptible.is_stopped(); },
                             .progress =
                                 [&](const SweepProgress& now) {
                                   if (!progress.is_none())
                                     interruptible.call(progress, now.count.done, now.count.failed,
                                                        now.count.scenes, now.seconds_left());
                                 }});
  }
  interruptible.rethrow();
  return end.others;
}

/// The world of a kept run and the state of one of its frames; -1 is the last.
std::pair<std::shared_ptr<const World>, State> kept_state(const std::filesystem::path& folder, int frame) {
  const std::shared_ptr<const World> world = saved_world(folder);
  const std::vector<std::filesystem::path> files = frame_files(folder);
  if (!world || files.empty())
    throw InputError(folder.string(), "the results of a run with frames for ParaView", "none",
                     "keep = \"all\" keeps them, and the base scene's output.formats needs vtu");
  const int count = static_cast<int>(files.size()), number = frame < 0 ? count + frame : frame;
  if (number < 0 || number >= count)
    throw InputError("frame", "0 to " + std::to_string(count - 1) + ", or -1 for the last",
                     std::to_string(frame));
  const std::filesystem::path& file = files[static_cast<std::size_t>(number)];
  return {world, state_of_frame(*world, read_vtu(file), file)};
}

NumpyArray<double> kept_field(const std::filesystem::path& folder, const std::string& name, int frame) {
  const auto [world, state] = kept_state(folder, frame);
  return field_array(*world, {&state, 1}, name);
}

NumpyArray<double> kept_rest_positions(const std::filesystem::path& folder) {
  const auto [world, state] = kept_state(folder, 0);
  return node_array(scene_places(*world, world->rest_positions), world->dimension);
}

}  // namespace

void bind_sweep(nb::module_& module) {
  nb::class_<Sweep>(module, "Sweep")
      .def("__len__", &Sweep::size)
      .def(
          "hash", [](const Sweep& sweep, std::uint64_t scene) { return sweep.hash(scene).text(); },
          nb::arg("scene"), nb::call_guard<nb::gil_scoped_release>())
      .def("name_of", &Sweep::name_of, nb::arg("scene"))
      .def_prop_ro("parameter_names",
                   [](const Sweep& sweep) {
                     std::vector<std::string> names;
                     for (const SweepParameter& parameter : sweep.parameters())
                       names.push_back(parameter.name);
                     return names;
                   })
      .def_prop_ro("quantity_names", [](const Sweep& sweep) {
        std::vector<std::string> names;
        for (const Quantity& quantity : sweep.quantities()) names.push_back(quantity.name);
        return names;
      });
  module.def(
      "read_sweep",
      [](const std::filesystem::path& path) { return std::make_shared<Sweep>(read_sweep(path)); },
      nb::arg("path"), nb::call_guard<nb::gil_scoped_release>());
  module.def(
      "read_sweep_from_values",
      [](const nb::typed<nb::dict, nb::str, nb::object>& values, const std::string& name,
         const std::filesystem::path& folder) {
        return std::make_shared<Sweep>(read_sweep_from_values(scene_value(values), name, folder));
      },
      nb::arg("values"), nb::arg("name"), nb::arg("folder"));

  nb::class_<SweepFolder>(module, "SweepFolder")
      .def(
          "__init__",
          [](SweepFolder* self, const std::filesystem::path& path, const std::shared_ptr<Sweep>& sweep,
             bool update) {
            const nb::gil_scoped_release release;
            new (self) SweepFolder(path, *sweep, update);
          },
          nb::arg("path"), nb::arg("sweep"), nb::arg("update"), nb::keep_alive<1, 3>())
      .def(
          "count",
          [](const SweepFolder& folder, const std::string& shard) {
            return counts(folder.count(parse_shard(shard)));
          },
          nb::arg("shard"), nb::call_guard<nb::gil_scoped_release>())
      .def(
          "append",
          [](SweepFolder& folder, const std::string& hash, const std::string& line) {
            folder.append(hash_of_text(hash), line);
          },
          nb::arg("hash"), nb::arg("line"), nb::call_guard<nb::gil_scoped_release>())
      .def(
          "release", [](SweepFolder& folder, const std::string& hash) { folder.release(hash_of_text(hash)); },
          nb::arg("hash"))
      .def("write_table", &SweepFolder::write_table, nb::call_guard<nb::gil_scoped_release>())
      .def("run", &run_in_pool, nb::arg("shard"), nb::arg("retries_failed"), nb::arg("jobs"),
           nb::arg("threads"), nb::arg("progress").none());

  nb::class_<SceneQueue>(module, "SceneQueue")
      .def(
          "__init__",
          [](SceneQueue* self, SweepFolder& folder, const std::string& shard, bool retries_failed) {
            new (self) SceneQueue(folder, {.shard = parse_shard(shard), .retries_failed = retries_failed});
          },
          nb::arg("folder"), nb::arg("shard"), nb::arg("retries_failed"), nb::keep_alive<1, 2>())
      .def(
          "next",
          [](SceneQueue& queue) -> std::optional<std::pair<std::uint64_t, std::string>> {
            const std::optional<SceneQueue::Task> task = queue.next();
            if (!task) return std::nullopt;
            return std::pair(task->scene, task->hash.text());
          },
          nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("num_others", &SceneQueue::num_others);

  module.def(
      "run_scene",
      [](const Sweep& sweep, std::uint64_t scene, const std::filesystem::path& folder) {
        const std::optional<SceneRow> row = run_scene(sweep, scene, folder);
        return std::tuple(row_line(*row, sweep), row->status == SceneStatus::done, row->seconds);
      },
      nb::arg("sweep"), nb::arg("scene"), nb::arg("folder"), nb::call_guard<nb::gil_scoped_release>());
  module.def(
      "failed_row",
      [](const Sweep& sweep, std::uint64_t scene, const std::string& reason) {
        return row_line(failed_row(sweep, scene, SceneStatus::failed, reason), sweep);
      },
      nb::arg("sweep"), nb::arg("scene"), nb::arg("reason"));
  module.def("kept_field", &kept_field, nb::arg("folder"), nb::arg("name"), nb::arg("frame"));
  module.def("kept_rest_positions", &kept_rest_positions, nb::arg("folder"));
}

}  // namespace resilin::python
