#pragma once

#include <memory>
#include <string>
#include <vector>

#include "resilin/fit/regularised_problem.hpp"
#include "resilin/fit/scene_fit.hpp"

namespace resilin {

/// How one number is sought where there are fields, so that it stays between its bounds without a limit: by
/// its logarithm where it is positive, and where it has two bounds by log((w - l) / (h - w)) of that.
class SoughtScale {
 public:
  /// @throws InputError  at `place` for a start on a bound
  SoughtScale(const SceneUnknown& unknown, const std::string& place);
  double to(double value) const;
  double from(double z) const;
  double slope(double z) const;  ///< slope of the value by z
  bool is_logarithm() const { return is_logarithm_; }

 private:
  bool is_logarithm_, is_bounded_;
  double low_ = 0, high_ = 0;  ///< low and high of the value or its logarithm
};

/// The search for fields of cells, and what else is sought with them: Gauss-Newton on the sum of squares and
/// the prior, whose weight is chosen anew at each place until it hardly changes (Haber & Oldenburg 2000).
class FieldSearch {
 public:
  /// All kept by reference.
  FieldSearch(const SceneModel& model, const SceneFitDescription& description,
              const SceneFitOptions& options);
  ~FieldSearch();

  /// Numbers of a start: the parameters that are no cells, and for a field its middle, the mean of what is
  /// sought. A field starts as the file has it, moved as a whole: its constant is what a smooth prior does
  /// not feel, and local minima are those of how stiff a body is.
  std::vector<SceneUnknown> sought() const;
  VectorX sought_values() const;  ///< where the search has ended

  /// @param start  of these
  void run(const VectorX& start);

  // The prior's value at the end, and its weight.
  double roughness() const { return roughness(u_); }
  double strength() const { return strength_; }

  VectorX values() const { return values_at(u_); }
  const SceneModel::Solved& solved() const { return solved_; }
  const VectorX& residuals() const { return r_; }
  int solves() const { return solves_; }
  bool is_converged() const { return is_converged_; }
  const std::string& why_not() const { return why_not_; }

  /// Fields, intervals of all that was sought, how the weight was chosen and what is to be said.
  void tell_fields(SceneFitReport& report) const;

 private:
  VectorX values_at(const VectorX& u) const;
  template <class Use>
  void for_each_sought(const Use& use) const;
  VectorX weighted_residuals(const SceneModel::Solved& solved) const;
  double roughness(const VectorX& u) const { return u.dot(prior_.times(u)); }
  void tell(double sum, const VectorX& u, bool is_better, const std::string& problem) const;
  double chosen_strength() const;
  double variance() const;
  bool step();
  void tell_interval(Eigen::Index i, double half_width, double& lower, double& upper) const;
  void tell_field(const UnknownRange& range, std::size_t parameter, const VectorX& deviations,
                  const VectorX& resolution, SceneFitReport& report) const;
  void tell_strength(SceneFitReport& report) const;

  const SceneModel& model_;
  const SceneFitDescription& description_;
  const SceneFitOptions& options_;
  std::vector<SoughtScale> scales_;
  std::vector<FieldCells> cells_;  ///< cells of the fields, in their order
  FieldPrior prior_;
  VectorX start_, u_, r_, weights_;  ///< u: the way from the start
  SceneModel::Solved solved_;
  std::unique_ptr<RegularisedProblem> problem_;  ///< around u
  double strength_ = 0;
  bool is_chosen_ = false;  ///< the weight stays
  int rounds_ = 0, solves_ = 0;
  bool is_converged_ = false;
  std::string why_not_;
};

}  // namespace resilin
