#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bindings.hpp"
#include "resilin/picture/picture.hpp"
#include "resilin/results/summary.hpp"
#include "resilin/simulation/simulation.hpp"

namespace resilin::python {

/// A field of fields/catalog.hpp in each of the states: (T, N or M), for vectors (T, ..., 3), displacement
/// and velocity (T, N, dim), tensors (T, ..., 3, 3).
NumpyArray<double> field_array(const World& world, std::span<const State> states, const std::string& name);

/// The same places in the scene's coordinates [m].
VectorX scene_places(const World& world, VectorX positions);

/// (N, dim) [m], in the scene's coordinates.
inline NumpyArray<double> place_array(const World& world, const VectorX& positions) {
  return node_array(scene_places(world, positions), world.dimension);
}

/// The recorded states of a run.
class History {
 public:
  explicit History(const std::shared_ptr<const Simulation>& simulation)
      : world_(simulation, &simulation->world()) {}

  /// All of it as bytes, and back, perhaps in another process.
  std::string image() const;
  static History from_image(std::string_view image);

  /// Keeps the present state when it is due (each `output.every` steps), or when `is_last`.
  void record(const Simulation& simulation, bool is_last);
  void finish(const Simulation& simulation, const RunOutcome& outcome, double total_seconds,
              double output_seconds);

  /// Writes the folder that the run would have left.
  void save(const std::filesystem::path& folder) const;
  /// As in report.json. Made when it is first asked for: ranges of fields cost as much as a light step.
  const std::string& report() const;
  const std::vector<std::string>& warnings() const { return summary_.outcome.warnings; }
  /// @param frame  from 0, or from the end: -1 is the last
  /// (N, dim) [m]; (N or M, ...), vectors with three components.
  NumpyArray<double> positions_of_frame(int frame) const;
  NumpyArray<double> field_of_frame(const std::string& name, int frame) const;
  Image draw(int frame, const PictureOptions& options) const;
  /// The page result.html of these frames, with the fields of a recording. @param folder  for what is made on
  /// the way
  std::string page(const std::filesystem::path& folder, const std::vector<int>& frames) const;

  const World& world() const { return *world_; }
  NumpyArray<double> positions() const;   ///< (T, N, dim) [m]
  NumpyArray<double> velocities() const;  ///< (T, N, dim) [m/s]
  NumpyArray<double> times() const { return scalar(&State::time); }
  NumpyArray<double> loads() const { return scalar(&State::load); }
  NumpyArray<double> field(const std::string& name) const { return field_array(world(), states_, name); }

 private:
  explicit History(std::shared_ptr<const World> world) : world_(std::move(world)) {}
  const State& state_of(int frame) const;
  NumpyArray<double> scalar(double State::* member) const;

  std::shared_ptr<const World> world_;  // no step changes it
  std::vector<State> states_;
  std::vector<Frame> frames_;
  RunSummary summary_;
  mutable std::string report_;  // empty until it is asked for
};

void bind_history(nb::module_& module);
void bind_live(nb::module_& module);

}  // namespace resilin::python
