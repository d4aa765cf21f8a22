#pragma once

#include <optional>

#include "resilin/linear/linear_solver.hpp"
#include "resilin/optimize/newton.hpp"
#include "resilin/sensitivity/earlier_solutions.hpp"
#include "resilin/simulation/potential.hpp"

namespace resilin {

/// Nonsymmetric part of the derivative of a potential's gradient.
///
/// For forces without a potential (a follower pressure on an open surface) the Hessian is the symmetric part.
/// They are quadratic in x, so that a central difference gives their derivative times a vector without an
/// error but rounding. Terms that lag something behind, friction, have a Hessian by what it is now: besides,
/// it follows the places.
class SkewPart {
 public:
  /// @param potential  its lag formed at x; to outlive this
  SkewPart(const World& world, const Potential& potential, const VectorX& x);
  bool is_zero() const { return terms_.empty() && lagging_.empty(); }
  VectorX times(const VectorX& p, bool is_transposed) const;

 private:
  VectorX skew_times(const VectorX& p) const;

  std::vector<const Energy*> terms_;    ///< those without a potential here
  std::vector<const Energy*> lagging_;  ///< those with a parameter "lag" that counts here
  BlockMatrix symmetric_;               ///< their Hessian
  Conditions conditions_;
  VectorX x_;
};

/// The derivative K of an objective's gradient at one place, whole and solved with over the free unknowns.
///
/// Its symmetric part is the Hessian, unprojected; where forces have no potential there is a skew part, too.
class Tangent {
 public:
  /// @param solver_kind  a name of the solvers' catalogue, or auto
  /// @param analyses     as in LinearOptions
  Tangent(const World& world, const std::string& solver_kind,
          std::shared_ptr<AnalysisCache> analyses = nullptr);

  /// Matrices of a sequence follow, each near to the one before it, as those of the steps of a motion:
  /// factors serve for as many of them as they can. What was learnt of those before is forgotten, so that a
  /// sequence gives the same bits whatever went before it.
  void begin_sequence();

  /// Forms K at x and factorises it; where `near` is given, and holds factors of a matrix near to K, only
  /// when these turn out not to serve.
  /// @throws InputError  where K is singular
  void form(const Potential& potential, const VectorX& x, Newton* near = nullptr);

  /// Number of negative eigenvalues of a symmetric K, as far as its solution has told; 0: it is definite.
  Index negative_eigenvalues() const { return negative_; }

  bool is_symmetric() const { return !skew_ || skew_->is_zero(); }
  /// K p, or K^T p, of all unknowns.
  VectorX times(const VectorX& p, bool is_transposed) const;
  /// Solves K p = b, or K^T p = b, over the free unknowns; p is zero at the others.
  /// @param earlier  of like equations, to begin with; the solution joins them
  VectorX solve(VectorX b, bool is_transposed, EarlierSolutions* earlier = nullptr);
  /// The same with the symmetric part of K alone.
  VectorX solve_symmetric_part(VectorX b);

 private:
  void factorize();
  void factorize_indefinite();
  double tolerance() const;
  void reduce(VectorX& b) const;
  VectorX followed(VectorX p) const;
  VectorX solve_symmetric(const VectorX& b, EarlierSolutions* earlier = nullptr);
  /// To a tolerance beside b with factors of a matrix that is near. None: there are none, or they take too
  /// long, and K has its own now.
  std::optional<VectorX> solve_with_near(const VectorX& b, double tolerance);
  std::optional<VectorX> solve_by_newton(const VectorX& b, double tolerance);
  std::optional<VectorX> solve_with_old_factors(const VectorX& b, double tolerance);

  const World& world_;
  std::string solver_kind_;
  std::shared_ptr<AnalysisCache> analyses_;
  BlockMatrix whole_, free_;
  std::optional<SkewPart> skew_;
  std::unique_ptr<LinearSolver> definite_, indefinite_;
  LinearSolver* solver_ = nullptr;
  Newton* near_ = nullptr;
  bool has_impulses_ = false;  ///< contact or friction is among the terms
  bool is_sequence_ = false;
  /// Factors of `solver_`, a direct one: they are of a definite matrix of this sequence ...
  bool has_factors_ = false;
  bool are_factors_old_ = false;  ///< ... before the present one
  Index negative_ = 0;
  VectorX x_;
};

}  // namespace resilin
