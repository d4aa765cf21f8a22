#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "resilin/fit/predicted_values.hpp"
#include "resilin/fit/scene_experiment.hpp"
#include "resilin/sensitivity/derivatives.hpp"

namespace resilin {

/// One number that is sought.
struct SceneUnknown {
  std::string name, unit;
  std::size_t parameter = 0;  ///< of the description
  double start = 0;
  double lower = 0, upper = 0;
  bool is_positive = false;    ///< sought by its logarithm
  double scene_value = 0;      ///< of a constant that the scene has for each cell: where it has this value
  Eigen::Index component = 0;  ///< of a vector
};

/// All measured numbers, one after another: those of each table of each experiment.
struct SceneData {
  struct Table {
    std::size_t experiment;
    MeasuredKind kind;
    std::string name;  ///< "pull: markers", "pull: reaction of grip"
    Eigen::Index first, count;
  };
  std::vector<Table> tables;
  std::vector<std::string> places;  ///< "markers.csv, row 3"
  VectorX measured, sigma;          ///< sigma: empty where none are given
};

/// The scenes of a fit as a function of the unknowns.
class SceneModel {
 public:
  /// Reads off what is measured and what is sought. Throws InputError for markers outside their body,
  /// names and keys that are none, and sigmas that are given here and not there.
  /// @param description  kept by reference
  explicit SceneModel(const SceneFitDescription& description);
  ~SceneModel();
  SceneModel(const SceneModel&) = delete;
  SceneModel& operator=(const SceneModel&) = delete;

  const std::vector<SceneUnknown>& unknowns() const { return unknowns_; }
  const SceneData& data() const { return data_; }

  /// The scenes, solved: values there, and slopes as long as they are asked for.
  struct Solved {
    std::vector<std::unique_ptr<Derivatives>> runs;  ///< of the experiments
    VectorX values;
  };
  /// Throws InputError where a scene has no solution, and Interrupted.
  Solved solve(const VectorX& unknowns, const std::function<bool()>& goes_on) const;
  /// By the unknowns, a column each: tangent solves with the factors of the solution.
  DenseMatrix slopes(const Solved& solved) const;

  /// The scene of an experiment with these unknowns, and the elements of the start.
  Description description_with(std::size_t experiment, const VectorX& unknowns) const;
  /// Bodies for which `element = "auto"` would choose others with these unknowns, in words with the cure.
  std::vector<std::string> other_elements(const VectorX& unknowns) const;

 private:
  struct OfExperiment;

  void find_unknowns();
  void add_unknowns(std::size_t parameter);
  void collect_data();
  Description changed(std::size_t experiment, const VectorX& unknowns) const;

  const SceneFitDescription& description_;
  std::vector<OfExperiment> experiments_;
  std::vector<SceneUnknown> unknowns_;
  SceneData data_;
};

}  // namespace resilin
