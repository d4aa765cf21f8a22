#pragma once

#include <vector>

#include "resilin/core/memory.hpp"
#include "resilin/linear/linear_solver.hpp"
#include "resilin/linear/merged_pattern.hpp"

namespace resilin {

/// Common part of direct solvers: the residual of every solve is checked, and refined when it misses the
/// tolerance; memory that runs out is a status of `factorize`, with words.
class DirectSolver : public LinearSolver {
 public:
  bool is_direct() const override { return true; }

  void begin_search() final { is_new_search_ = true; }
  void release() final { forget(); }
  void analyze(const BlockMatrix& A, const VectorX& node_positions) final;
  LinearReport factorize(const BlockMatrix& A) final;

  /// `not_converged` when the residual stays above the tolerance and above 1e-8: the factors do not belong to
  /// A, or A is singular to working precision.
  LinearReport solve(const BlockMatrix& A, const VectorX& b, VectorX& x, double relative_tolerance) override;

 protected:
  /// Analyses the pattern of A unless it is the one held, of which `keep` says what stays. These two may
  /// throw std::bad_alloc.
  virtual void prepare(const BlockMatrix& A, MergedPattern::Keep keep) = 0;
  virtual LinearReport factorize_prepared(const BlockMatrix& A) = 0;
  /// Gives back what they hold, which may be half done.
  virtual void forget() = 0;
  /// x = (factors)^-1 b.
  virtual void solve_factored(const VectorX& b, VectorX& x) = 0;

  /// Throws OutOfMemory where it does not fit.
  void foresee(double bytes, const BlockMatrix& A, MemoryRoom (*room)() = memory_room) const;

 private:
  void prepare(const BlockMatrix& A);

  bool is_new_search_ = false;
  VectorX residual_, correction_;
  std::vector<double> work_;
};

}  // namespace resilin
