#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/linear/linear_solver.hpp"
#include "resilin/optimize/objective.hpp"
#include "resilin/optimize/projection_chooser.hpp"

namespace resilin {

/// Tolerances and limits of Newton's method with line search.
struct NewtonSettings {
  double tolerance = 1e-8;  ///< tolerance of the force residual relative to the objective's force scale
  /// Further iterations for each lagged update, unless the limit is smaller than this.
  int max_iterations = 100;
  ProjectionPolicy projection = ProjectionPolicy::adaptive;
  bool is_quadratic = false;  ///< the objective is: one step, whose linear system is solved to the end
  double armijo = 1e-4;       ///< share of the predicted decrease that a step must reach
  int max_halvings = 40;      ///< maximum halvings of one line search
  int lag_rounds = 0;         ///< limit of lagged updates
  /// With carried internal values: so many steps in a row may leave the energy above its lowest value, before
  /// the search goes back there. 0: every step lowers the energy.
  int relaxed_steps = 0;
};

/// Result of Newton's method; not converging is a status.
struct NewtonReport {
  enum class Status {
    converged,
    max_iterations,
    stalled,
    singular,
    out_of_digits,  ///< rounding leaves more of the residual than is small beside the load
    not_finite,     ///< forces or energies are not numbers
    interrupted,
  };
  Status status = Status::converged;
  std::string reason;  ///< in words
  int iterations = 0;  ///< Newton steps taken
  int linear_solves = 0;
  int linear_iterations = 0;  ///< linear iterations of iterative solvers, summed
  int line_search_halvings = 0;
  int tangent_iterations = 0;        ///< tangent iterations of GMRES on a tangent that is not symmetric
  int projected_solves = 0;          ///< solves with projected elements
  bool last_step_was_exact = false;  ///< whole, by the exact Hessian, which the solver found definite
  /// In the part of the scene (the nodes that hang together) where they are largest beside one another:
  double residual = 0;  ///< |gradient on its free unknowns| [N]; beyond rounding where that is all there is
  double force_scale = 0;    ///< [N]; converged means residual <= tolerance * force_scale
  Index worst_unknown = -1;  ///< its free unknown with the largest residual
  VectorX rounding{};  ///< bound of the rounding of each force, where that was asked for; else empty [N]
  int lag_rounds = 0;  ///< number of lagged updates
  /// After a converged search: `relative_residual` with lagged quantities of the final positions, if
  /// unbalanced; else 0.
  double lag_mismatch = 0;
  double assembly_seconds = 0, solve_seconds = 0;

  bool converged() const { return status == Status::converged; }
  double relative_residual() const { return residual > 0 ? residual / force_scale : residual; }
};

/// Called after every iteration; returning false stops the search.
using NewtonObserver = std::function<bool(const NewtonReport& so_far)>;

/// Newton's method with all that it keeps between calls: the matrix and the analysed solver.
///
/// Nothing that it keeps changes a result: two calls with the same arguments give the same bits.
class Newton {
 public:
  /// @param share  of the scene, to which the nodes of the pattern belong
  Newton(int dim, std::shared_ptr<const BlockPattern> pattern, std::unique_ptr<LinearSolver> solver,
         const ProcessGroup& share = {});

  /// Minimises over the unknowns with is_fixed[i] == 0 from x, which is moved. The fixed ones are led to
  /// `targets[i]`, all at once where the domain allows, else in several steps.
  ///
  /// Every accepted step lowers the objective (once the fixed unknowns are in place) and stays in the domain.
  /// A missed tolerance is a status, never an exception; x is then the best point reached. Memory that runs
  /// out is an exception (OutOfMemory), for shorter steps would not help.
  NewtonReport minimize(Objective& objective, std::span<const std::uint8_t> is_fixed, const VectorX& targets,
                        const NewtonSettings& settings, VectorX& x, const NewtonObserver& observer = {});

  /// Where forces lead by the last matrix, that of the latest search (projected, where it was) or of
  /// `form_matrix`: H^-1 f [m], zero at the fixed unknowns. None where the search needed no matrix.
  /// @param tolerance  to which an iterative solver goes, relative to the forces
  std::optional<VectorX> response(VectorX forces, std::span<const std::uint8_t> is_fixed, double tolerance);
  /// A^-1 f for an A that is near to the last matrix, with what an iterative solver keeps of that one as
  /// preconditioner. None where the solver is a direct one, where the last matrix weighs parts, and where A
  /// turns out not to be definite.
  std::optional<VectorX> response_near(const BlockMatrix& A, VectorX forces,
                                       std::span<const std::uint8_t> is_fixed, double tolerance);
  /// Factors that solve with a matrix: its own, or those of the latest search, which it is near to.
  enum class Factors { anew, of_search };
  /// Makes the Hessian of an objective at x, its elements projected, the last matrix. It depends on x alone,
  /// that of a search on the way that has led there.
  void form_matrix(const Objective& objective, std::span<const std::uint8_t> is_fixed, const VectorX& x,
                   Factors factors = Factors::anew);

  /// Gives back the memory of the analysed solver; the next search analyses anew.
  void release_solver() { solver_->release(); }
  std::string_view solver_name() const { return solver_->name(); }
  bool solver_is_direct() const { return solver_->is_direct(); }
  const ConnectedComponents& parts() const { return parts_; }

 private:
  struct Search;
  /// Measure of the parts in the matrix that the solver holds; empty for one part.
  struct Measure {
    std::optional<ConnectedComponents> parts;
    VectorX weights;
  };

  void keep_measure(bool has_matrix, const ConnectedComponents& parts, const VectorX& weights);
  /// Whether `hessian_` is definite. @param x  as `LinearSolver::analyze` takes it
  bool factorize_last(const VectorX& x);

  BlockMatrix hessian_;
  ConnectedComponents parts_;
  std::unique_ptr<LinearSolver> solver_;
  std::optional<Measure> last_measure_;  ///< measure of the last matrix; none: the search has none
  bool has_near_factors_ = false;        ///< the factors are of a matrix that is near to the last one
};

/// "converged", "max_iterations" ...
std::string_view name(NewtonReport::Status status);

}  // namespace resilin
