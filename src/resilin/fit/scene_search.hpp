#pragma once

#include <memory>
#include <string>
#include <vector>

#include "resilin/fit/field_fit.hpp"
#include "resilin/fit/least_squares_search.hpp"
#include "resilin/fit/scene_fit.hpp"

namespace resilin {

/// Residuals of scenes, over the sigmas where there are any.
class SceneResiduals : public Residuals {
 public:
  /// All kept by reference.
  SceneResiduals(const SceneModel& model, const SceneFitDescription& description,
                 const SceneFitOptions& options);

  bool evaluate(const VectorX& values, VectorX& r) override;
  void accept() override;
  /// @throws InputError  for a parameter of its own that no datum feels, the first time
  bool linearise(DenseMatrix& slopes) override;
  const SceneModel::Solved& solved() const { return here_; }

 private:
  void refuse_what_is_not_felt(const DenseMatrix& slopes) const;

  const SceneModel& model_;
  const SceneFitDescription& description_;
  const SceneFitOptions& options_;
  VectorX weights_, values_here_, values_there_;
  SceneModel::Solved here_, there_;
  bool is_first_ = true;
};

/// The search for the unknowns of scenes from one start: in logarithms of what is positive. With fields all
/// that has two bounds stays between them without reaching one.
class SceneSearch {
 public:
  /// All kept by reference.
  SceneSearch(const SceneModel& model, const SceneFitDescription& description,
              const SceneFitOptions& options);

  /// Numbers of a start: the parameters that are no cells, and for a field its middle, the mean of z. A field
  /// starts as the file has it, moved as a whole: its constant is what a smooth prior does not feel, and
  /// local minima are those of how stiff a body is.
  std::vector<SceneUnknown> sought() const;
  VectorX sought_values() const;  ///< where the search has ended

  /// @param start  of these
  void run(const VectorX& start);

  const LeastSquaresSearch& search() const { return search_; }
  const SceneModel::Solved& solved() const { return residuals_.solved(); }
  const FieldTerm* fields() const { return fields_.get(); }  ///< null without fields
  std::string why_not() const;                               ///< converged

 private:
  SearchSettings settings(const SceneFitOptions& options);
  void tell(const SearchTrial& trial, const SceneFitOptions& options) const;
  template <class Use>
  void for_each_sought(const Use& use) const;

  const SceneModel& model_;
  const SceneFitDescription& description_;
  std::vector<ParameterTransform> transforms_;
  VectorX start_;  ///< z of the file
  SceneResiduals residuals_;
  std::unique_ptr<FieldTerm> fields_;
  LeastSquaresSearch search_;
};

}  // namespace resilin
