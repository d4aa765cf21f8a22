#include <nanobind/stl/unique_ptr.h>

#include <cstddef>
#include <exception>

#include "differentiated_run.hpp"
#include "resilin/core/error.hpp"
#include "resilin/linear/analysis_cache.hpp"
#include "resilin/sensitivity/side_by_side.hpp"

namespace resilin::python {
namespace {

using Runs = std::vector<DifferentiatedRun*>;

/// Does `work(i, stops)` for each of several scenes, at once and without the GIL. Ctrl-C ends it, and so does
/// an error, which says of which scene it is.
template <class Work>
void on_all_scenes(std::size_t count, const Work& work) {
  Interruptible interruptible;
  std::exception_ptr failure;
  {
    const nb::gil_scoped_release release;
    std::atomic<bool> stops = false;
    try {
      run_side_by_side(
          count,
          [&](std::size_t i) {
            try {
              work(i, stops);
            } catch (const InputError& error) {
              throw InputError("scene " + std::to_string(i + 1) + " of " + std::to_string(count),
                               error.what());
            }
          },
          [&] { return !interruptible.is_stopped(); }, stops);
    } catch (...) {
      failure = std::current_exception();
    }
  }
  interruptible.rethrow();
  if (failure) std::rethrow_exception(failure);
}

std::vector<std::unique_ptr<DifferentiatedRun>> run_all(
    const Scene& scene, const std::vector<std::string>& wrt,
    const std::vector<std::map<std::string, Vector1d<double>>>& values, int checkpoints) {
  std::vector<DifferentiatedRun::Numbers> numbers;
  for (const auto& of_scene : values) numbers.push_back(DifferentiatedRun::numbers_of(of_scene));
  const DerivativeOptions options{.checkpoints = checkpoints, .analyses = std::make_shared<AnalysisCache>()};
  std::vector<std::unique_ptr<DifferentiatedRun>> runs(numbers.size());
  std::unique_ptr<const World> as_it_is;
  {
    const nb::gil_scoped_release release;
    as_it_is = std::make_unique<World>(Description(scene.description));
  }
  on_all_scenes(runs.size(), [&](std::size_t i, const std::atomic<bool>& stops) {
    runs[i] = std::make_unique<DifferentiatedRun>(with_values(*as_it_is, numbers[i]), wrt, options, stops);
  });
  return runs;
}

std::vector<std::vector<NumpyArray<double>>> transposed_all(
    const Runs& runs, const std::vector<std::vector<FrameArrays>>& frames) {
  std::vector<std::vector<FrameChange>> slopes;
  for (std::size_t i = 0; i < runs.size(); ++i) slopes.push_back(runs[i]->slopes_of(frames.at(i)));
  std::vector<std::vector<VectorX>> found(runs.size());
  on_all_scenes(runs.size(), [&](std::size_t i, const std::atomic<bool>& stops) {
    runs[i]->stopped_by(stops, [&] { found[i] = runs[i]->derivatives().transposed(slopes[i]); });
  });
  std::vector<std::vector<NumpyArray<double>>> all;
  for (const std::vector<VectorX>& of_scene : found) all.push_back(DifferentiatedRun::arrays_of(of_scene));
  return all;
}

std::vector<DifferentiatedRun::ChangeArrays> forward_all(
    const Runs& runs, const std::vector<std::vector<Vector1d<double>>>& changes) {
  std::vector<std::vector<VectorX>> numbers;
  for (const auto& of_scene : changes) numbers.push_back(DifferentiatedRun::flat_all(of_scene));
  std::vector<std::vector<FrameChange>> found(runs.size());
  on_all_scenes(runs.size(), [&](std::size_t i, const std::atomic<bool>& stops) {
    runs[i]->stopped_by(stops, [&] { found[i] = runs[i]->derivatives().forward(numbers.at(i)); });
  });
  std::vector<DifferentiatedRun::ChangeArrays> all;
  for (std::size_t i = 0; i < runs.size(); ++i) all.push_back(runs[i]->change_arrays(found[i]));
  return all;
}

}  // namespace

void bind_derivatives_batch(nb::module_& module) {
  module.def("differentiated_runs", &run_all, nb::arg("scene"), nb::arg("wrt"), nb::arg("values"),
             nb::arg("checkpoints"));
  module.def("transposed_all", &transposed_all, nb::arg("runs"), nb::arg("frames"));
  module.def("forward_all", &forward_all, nb::arg("runs"), nb::arg("changes"));
}

}  // namespace resilin::python
