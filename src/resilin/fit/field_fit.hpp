#pragma once

#include <memory>
#include <vector>

#include "resilin/fit/least_squares_search.hpp"
#include "resilin/fit/regularised_problem.hpp"
#include "resilin/fit/scene_fit.hpp"

namespace resilin {

/// The prior of fields of cells beside the sum of squares. Its weight is chosen anew at each place until it
/// hardly changes (Haber & Oldenburg 2000).
class FieldTerm : public Prior {
 public:
  /// @param origin  z of the file, from which the prior counts
  /// @throws InputError  for the discrepancy principle without sigmas
  FieldTerm(const SceneModel& model, const SceneFitDescription& description, VectorX origin);

  double value(const VectorX& z) const override { return strength_ * roughness(z); }
  SearchStep best_step(const VectorX& z, const VectorX& r, const DenseMatrix& J) override;

  double roughness(const VectorX& z) const { return (z - origin_).dot(prior_.times(z - origin_)); }
  double strength() const { return strength_; }
  /// Variance of a weighted residual: 1 by the sigmas, unless residuals are larger than these allow.
  double variance(double sum_of_squares) const;
  const RegularisedProblem& problem() const { return *problem_; }  ///< around the place linearised last
  const std::vector<FieldCells>& cells() const { return cells_; }  ///< cells of the fields, in their order

 private:
  void choose_strength();

  Regularisation regularise_;
  bool has_sigma_;
  std::vector<FieldCells> cells_;
  FieldPrior prior_;
  VectorX origin_;
  std::unique_ptr<RegularisedProblem> problem_;
  double strength_ = 0;
  bool is_chosen_ = false;  ///< the weight stays
  int rounds_ = 0;
};

class SceneSearch;
/// Fields, intervals of all that was sought, how the weight was chosen and what is to be said.
void tell_fields(const SceneModel& model, const SceneSearch& search, SceneFitReport& report);

}  // namespace resilin
