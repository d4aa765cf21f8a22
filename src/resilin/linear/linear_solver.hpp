#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/process_group.hpp"
#include "resilin/linear/block_matrix.hpp"

namespace resilin {

class AnalysisCache;

/// Choice and limits of a linear solver.
struct LinearOptions {
  std::string kind = "auto";  ///< a name in the catalogue, or "auto"
  bool is_dynamic = false;    ///< helps "auto": mass makes iterative solvers quick
  bool is_definite = true;    ///< false: negative eigenvalues are solved with and counted, not refused
  int max_iterations = 2000;  ///< maximum iterations of an iterative solver
  std::shared_ptr<AnalysisCache> analyses = nullptr;  ///< shared with other solvers, by those that can
  ProcessGroup share = {};  ///< process group of the matrix: its entries are then this process's part of them
};

/// Status of a factorisation or a solve.
struct LinearReport {
  enum class Status { ok, indefinite, not_converged, out_of_memory };
  Status status = Status::ok;
  int iterations = 0;            ///< iterations of an iterative solver; 0 for a direct one
  double relative_residual = 0;  ///< |b - A x| / |b|, where it is known
  Index negative_pivots = 0;     ///< negative pivots of a solver for matrices that need not be definite: by
                                 ///< Sylvester's law of inertia the number of negative eigenvalues
  Index worst_node = -1;  ///< the node whose pivot failed or that bends the curvature most, where it is known
  std::string shortage;   ///< shortage of `out_of_memory`: who needed how much, how much there is, what to do
};

/// Throws the OutOfMemory of a report that says so: no smaller step would help.
void require_memory(const LinearReport& report);

/// Solves A x = b for symmetric positive definite A. Analysed once for each pattern, factorised again for new
/// values.
///
/// An indefinite matrix is reported by `factorize` or, where only the iteration sees it, by `solve`; unless
/// the solver was asked for with `is_definite = false`: then only a singular one is.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  virtual std::string_view name() const = 0;
  virtual bool is_direct() const = 0;
  /// Matrices of one search for an equilibrium follow: what was learnt of those before is forgotten, so that
  /// a search gives the same bits whatever went before it.
  virtual void begin_search() {}
  /// Lower estimate of the memory for a matrix of this pattern [bytes]; 0 where it looks at the memory that
  /// is left itself.
  virtual double expected_bytes(const BlockPattern& /*pattern*/, int /*dim*/) const { return 0; }
  /// Gives back memory: the next matrix is analysed anew. Changes no result.
  virtual void release() {}
  /// `node_positions` (dim per node) and rigid modes derived from them help multilevel solvers; may be empty.
  /// After large rotations give current positions: again on the same pattern this costs little. May be left
  /// out, and is needed before the bits of a run are to be repeated from a checkpoint when extra blocks came
  /// and went.
  virtual void analyze(const BlockMatrix& A, const VectorX& node_positions) = 0;
  virtual LinearReport factorize(const BlockMatrix& A) = 0;
  /// `x` is the start of an iterative solver (use zero) and holds the solution after. On `indefinite` and
  /// `not_converged`, x is the last iterate, a descent direction when b is minus a gradient and x began as
  /// zero. A direct solver refines its answer when it misses the tolerance and reports what is left. A may
  /// have other values than the matrix that was factorised, as long as it is near to it: iterative solvers
  /// then use old factors for new values.
  virtual LinearReport solve(const BlockMatrix& A, const VectorX& b, VectorX& x,
                             double relative_tolerance) = 0;
};

/// An entry of the catalogue of solvers.
struct LinearSolverKind {
  std::string name;
  std::unique_ptr<LinearSolver> (*make)(const LinearOptions& options);
  bool solves_indefinite = false;  ///< takes matrices that need not be definite, and counts negative pivots
  bool is_distributed = false;     ///< takes a share of a matrix that several processes have
};

/// Adds a solver from outside this module, such as one of an optional library, to those that scenes may name.
/// For a program to call before it reads scenes. Throws std::invalid_argument for a name that is taken.
void register_linear_solver(LinearSolverKind kind);

/// A solver by name: see linear/catalog.cpp. Throws InputError for an unknown name, and for one that cannot
/// do without definite matrices when they need not be.
std::unique_ptr<LinearSolver> make_linear_solver(const LinearOptions& options, Index num_unknowns);

/// Throws InputError at `place` unless `kind` is "auto" or one of `linear_solver_names`.
void require_linear_solver(const std::string& kind, const std::string& place);

/// Names of all solvers, in the order of the catalogue; registered ones last.
std::vector<std::string> linear_solver_names();

}  // namespace resilin
