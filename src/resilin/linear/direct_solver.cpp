#include "resilin/linear/direct_solver.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "resilin/core/text.hpp"

namespace resilin {
namespace {

std::string shortage_text(std::string_view solver, const std::string& needs, const MemoryRoom& room,
                          const BlockMatrix& A) {
  return "out of memory: solver.kind = \"" + std::string(solver) + "\" needs " + needs + " for " +
         std::to_string(A.num_unknowns()) + " DOFs, " + words(room) +
         "; take solver.kind = \"cg_amg\", fewer cells, or raise the limit";
}

}  // namespace

/// Pairs that have gone stay within a search, of which they are often part again; one that began with those
/// of a search before would round in another order.
void DirectSolver::prepare(const BlockMatrix& A) {
  const bool is_first = std::exchange(is_new_search_, false);
  prepare(A, is_first ? MergedPattern::Keep::same_pairs : MergedPattern::Keep::superset);
}

void DirectSolver::analyze(const BlockMatrix& A, const VectorX&) {
  try {
    prepare(A);
  } catch (const std::bad_alloc&) {
    forget();  // `factorize` tries again and says it
  }
}

LinearReport DirectSolver::factorize(const BlockMatrix& A) {
  LinearReport report;
  try {
    prepare(A);
    return factorize_prepared(A);
  } catch (const OutOfMemory& shortage) {
    report.shortage = shortage.what();
  } catch (const std::bad_alloc&) {
    report.shortage = shortage_text(name(), "more memory", memory_room(), A);
  }
  report.status = LinearReport::Status::out_of_memory;
  forget();
  return report;
}

void DirectSolver::foresee(double bytes, const BlockMatrix& A, MemoryRoom (*room)()) const {
  if (!fits(bytes, room))
    throw OutOfMemory(shortage_text(name(), format_bytes(static_cast<std::uintmax_t>(bytes)), room(), A));
}

LinearReport DirectSolver::solve(const BlockMatrix& A, const VectorX& b, VectorX& x,
                                 double relative_tolerance) {
  constexpr int max_refinements = 2;
  constexpr double round_off = 1e-8;
  LinearReport report;
  const double b_norm = b.norm();
  if (b_norm == 0) {
    x.setZero(b.size());
    return report;
  }
  solve_factored(b, x);
  for (int refinement = 0;; ++refinement) {
    multiply(A, x, residual_, work_);
    residual_ = b - residual_;
    report.relative_residual = residual_.norm() / b_norm;
    if (report.relative_residual <= relative_tolerance || refinement == max_refinements) break;
    solve_factored(residual_, correction_);
    x += correction_;
  }
  if (!(report.relative_residual <= std::max(relative_tolerance, round_off)))
    report.status = LinearReport::Status::not_converged;
  return report;
}

}  // namespace resilin
