#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "resilin/fit/scene_experiment.hpp"
#include "resilin/fit/scene_keys.hpp"
#include "resilin/sensitivity/derivatives.hpp"
#include "resilin/sensitivity/markers.hpp"
#include "resilin/sensitivity/measured_number.hpp"

namespace resilin {

/// A parameter of the description in one scene.
struct SoughtParameter {
  FoundKey key;
  /// Index of each number of the parameter among the sought numbers; -1: it stays constant.
  std::vector<int> which;
  Eigen::Index count = 0;  ///< number of parameters that are sought
};

/// One scene of a fit: what is sought in it and what was measured.
class ExperimentModel {
 public:
  /// @param experiment  kept by reference
  explicit ExperimentModel(const SceneExperiment& experiment);

  const SceneExperiment& experiment() const { return *experiment_; }
  const World& world() const { return *world_; }

  /// Makes a constant that the scene has once one of each cell, as it is.
  void spread_over_cells(const SceneParameter& sought);
  /// By the number of the parameter in the description.
  std::map<std::size_t, SoughtParameter>& parameters() { return parameters_; }
  const std::map<std::size_t, SoughtParameter>& parameters() const { return parameters_; }
  std::vector<std::string> parameter_keys() const;

  /// Takes a table as measured: the numbers of its rows follow.
  /// @throws InputError  for markers outside the body and names that are none
  void measure(const MeasuredTable& table);
  Eigen::Index num_values() const { return static_cast<Eigen::Index>(numbers_.size()); }

  /// The scene with other numbers, by the parameter of the description: all that are sought of it.
  Description changed(const std::function<const double*(std::size_t)>& values) const;

  /// Values of a run for all measured quantities.
  struct Outcome {
    VectorX values;
    std::vector<int> frames;                ///< frames of each number
    std::vector<MeasuredNumber> nonlinear;  ///< numbers that are not linear in the frame; else empty
  };
  Outcome outcome_of(Derivatives& run) const;

  /// Slopes of all numbers by the parameters of the run, the sought ones of each one after another: forward
  /// along each, or transposed from each number, whatever are fewer.
  DenseMatrix slopes(Derivatives& run, const Outcome& outcome) const;

 private:
  struct Number {
    const MeasuredTable* table;
    const MeasuredRow* row;
    Marker marker{};          ///< marker of markers and probes
    std::size_t support = 0;  ///< boundary condition of a reaction
    Eigen::Index component = 0;
    bool is_linear = false;  ///< in the places and the reactions of supports
  };
  std::vector<Marker> markers_of(const MeasuredTable& table) const;
  int frame_of(const MeasuredRow& row, const Derivatives& run) const;
  double linear_value(const Number& number, const FrameChange& frame) const;
  FrameChange linear_slopes(const Number& number) const;
  std::vector<MeasuredNumber> measured_at(Derivatives& run, const Number& number, int frame) const;
  Eigen::Index num_sought() const;
  void add_forward_slopes(Derivatives& run, const Outcome& outcome, DenseMatrix& J) const;
  void add_transposed_slopes(Derivatives& run, const Outcome& outcome, DenseMatrix& J) const;

  const SceneExperiment* experiment_;
  Description description_;  ///< with constants of cells where these are sought
  std::unique_ptr<World> world_;
  std::map<std::size_t, SoughtParameter> parameters_;
  std::vector<Number> numbers_;
};

}  // namespace resilin
