#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "resilin/fit/experiment_model.hpp"
#include "resilin/fit/predicted_values.hpp"
#include "resilin/fit/scene_experiment.hpp"

namespace resilin {

/// One number that is sought.
struct SceneUnknown {
  std::string name, unit;
  std::size_t parameter = 0;  ///< parameter of the description
  double start = 0;
  double lower = 0, upper = 0;
  bool is_positive = false;  ///< sought by its logarithm
};

/// The unknowns of one parameter of the description.
struct UnknownRange {
  Eigen::Index first = 0, count = 0;
  std::size_t experiment = 0;  ///< the first that has it
  bool is_field = false;       ///< one for each cell
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
  std::vector<MeasuredPlace> places;
  VectorX measured, sigma;  ///< sigma: empty where none are given
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
  const std::vector<UnknownRange>& ranges() const { return ranges_; }  ///< ranges of the parameters
  bool has_fields() const;
  const SceneData& data() const { return data_; }
  const World& world(std::size_t experiment) const { return experiments_[experiment].world(); }

  /// The scenes, solved: values there, and slopes as long as they are asked for.
  struct Solved {
    std::vector<std::unique_ptr<Derivatives>> runs;  ///< runs of the experiments
    std::vector<ExperimentModel::Outcome> outcomes;
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
  void find_unknowns();
  void collect_data();
  Description changed(std::size_t experiment, const VectorX& unknowns) const;

  const SceneFitDescription& description_;
  std::vector<ExperimentModel> experiments_;
  std::vector<SceneUnknown> unknowns_;
  std::vector<UnknownRange> ranges_;
  SceneData data_;
};

/// Adds the unknowns of a parameter of the description, and says in each scene which of
/// them each of its numbers is.
/// @throws InputError  for what is no number or no constant of cells, and for starts and bounds beyond the
/// law
UnknownRange add_unknowns(const SceneFitDescription& description, std::size_t parameter,
                          std::vector<ExperimentModel>& experiments, std::vector<SceneUnknown>& unknowns);

}  // namespace resilin
