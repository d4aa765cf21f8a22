#pragma once

#include <string>
#include <vector>

#include "resilin/fit/scene_fit.hpp"

namespace resilin {

/// Levenberg's and Marquardt's search for the unknowns of scenes from one start, in logarithms of what is
/// positive.
class SceneSearch {
 public:
  /// All kept by reference.
  SceneSearch(const SceneModel& model, const SceneFitDescription& description,
              const SceneFitOptions& options);

  /// @param start  of the unknowns
  void run(const VectorX& start);

  /// Unknowns of the search, in order; each start has a number for every one, and so has the end.
  const std::vector<SceneUnknown>& sought() const { return model_.unknowns(); }
  VectorX sought_values() const { return values(); }
  // There is no prior here.
  static double roughness() { return 0; }
  static double strength() { return 0; }

  VectorX values() const { return values_at(z_); }
  const SceneModel::Solved& solved() const { return solved_; }
  const VectorX& residuals() const { return r_; }
  const DenseMatrix& slopes() const {
    return slopes_;
  }  ///< derivatives of weighted residuals by the unknowns
  /// Unit of an unknown by what is sought.
  double unit(Eigen::Index i) const;
  int solves() const { return solves_; }
  bool is_converged() const { return is_converged_; }
  const std::string& why_not() const { return why_not_; }
  /// Held by a bound against which the sum falls.
  bool is_held(Eigen::Index i) const;

 private:
  const SceneUnknown& unknown(Eigen::Index i) const { return model_.unknowns()[static_cast<std::size_t>(i)]; }
  double sought(Eigen::Index i, double value) const;
  double lower(Eigen::Index i) const { return sought(i, unknown(i).lower); }
  double upper(Eigen::Index i) const { return sought(i, unknown(i).upper); }
  VectorX values_at(const VectorX& z) const;
  VectorX weighted_residuals(const SceneModel::Solved& solved) const;
  void tell(double sum, const VectorX& z, bool is_better, const std::string& problem) const;
  void solve_first();
  void refuse_what_is_not_felt() const;
  VectorX damped_step(double damping) const;
  double relative_size(const VectorX& change) const;
  bool step();

  const SceneModel& model_;
  const SceneFitDescription& description_;
  const SceneFitOptions& options_;
  VectorX start_, z_, r_, weights_;
  DenseMatrix slopes_;
  SceneModel::Solved solved_;
  double damping_ = 0;
  int solves_ = 0;
  bool is_converged_ = false;
  std::string why_not_;
};

}  // namespace resilin
