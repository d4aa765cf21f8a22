#include "resilin/linear/catalog.hpp"

#include <algorithm>
#include <mutex>
#include <stdexcept>

#include "resilin/core/error.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/text.hpp"
#include "resilin/core/vocabulary.hpp"

namespace resilin {
namespace {

/// Every solver of this module; others are registered.
std::vector<LinearSolverKind> built_in() {
  return {
#ifdef RESILIN_HAS_CHOLMOD
      {"cholesky", make_cholmod},
#elif defined(RESILIN_HAS_LAPACK)
      {"cholesky", make_multifrontal},
#else
      {"cholesky", make_ldlt},
#endif
#ifdef RESILIN_HAS_LAPACK
      {"multifrontal", make_multifrontal, true},
#endif
      {"ldlt", make_ldlt, true},
      {"cg_amg", make_cg_amg},
      {"cg_ic0", make_cg_ic0},
      {"cg_jacobi", make_cg_jacobi},
  };
}

/// All solvers, behind a lock: programs register theirs at any time.
struct Catalog {
  std::mutex mutex;
  std::vector<LinearSolverKind> kinds = built_in();
};

Catalog& catalog() {
  static Catalog all;
  return all;
}

std::vector<LinearSolverKind> kinds() {
  const std::lock_guard lock(catalog().mutex);
  return catalog().kinds;
}

/// The solver of this name, or the first, of those that several processes share.
std::unique_ptr<LinearSolver> make_distributed(const LinearOptions& options) {
  std::vector<std::string> names = {"\"auto\""};
  for (const LinearSolverKind& kind : kinds()) {
    if (!kind.is_distributed) continue;
    if (options.kind == "auto" || options.kind == kind.name) return kind.make(options);
    names.push_back('"' + kind.name + '"');
  }
  throw InputError("solver.kind", join(names, " or ") + " for a scene on several MPI processes",
                   '"' + options.kind + '"', "let it be \"auto\", or run it on one process");
}

}  // namespace

void require_memory(const LinearReport& report) {
  if (report.status == LinearReport::Status::out_of_memory) throw OutOfMemory(report.shortage);
}

void register_linear_solver(LinearSolverKind kind) {
  const std::lock_guard lock(catalog().mutex);
  const bool is_taken =
      std::ranges::find(catalog().kinds, kind.name, &LinearSolverKind::name) != catalog().kinds.end();
  if (is_taken || kind.name == "auto" || kind.make == nullptr)
    throw std::invalid_argument("a linear solver needs a name of its own and a function that makes it: \"" +
                                kind.name + "\"");
  catalog().kinds.push_back(std::move(kind));
}

std::unique_ptr<LinearSolver> make_linear_solver(const LinearOptions& options, Index num_unknowns) {
  if (!options.share.is_whole()) return make_distributed(options);
  if (options.kind == "auto") return make_auto(options, num_unknowns);
  require_linear_solver(options.kind, "solver.kind");
  const std::vector<LinearSolverKind> all = kinds();
  const LinearSolverKind& kind = *std::ranges::find(all, options.kind, &LinearSolverKind::name);
  if (!options.is_definite && !kind.solves_indefinite) {
    std::vector<std::string> others;
    for (const LinearSolverKind& other : all)
      if (other.solves_indefinite) others.push_back('"' + other.name + '"');
    throw InputError("solver.kind", join(others, " or ") + " where the matrix need not be definite",
                     "\"" + options.kind + "\"", "let it be \"auto\"");
  }
  return kind.make(options);
}

void require_linear_solver(const std::string& kind, const std::string& place) {
  std::vector<std::string> names = linear_solver_names();
  names.insert(names.begin(), "auto");
  if (std::ranges::find(names, kind) != names.end()) return;
  refuse_own_word(place, kind, names);
}

std::vector<std::string> linear_solver_names() {
  std::vector<std::string> names;
  for (const LinearSolverKind& kind : kinds()) names.push_back(kind.name);
  return names;
}

}  // namespace resilin
