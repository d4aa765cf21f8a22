#include "resilin/linear/catalog.hpp"

#include <functional>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

struct Entry {
  const char* name;
  std::unique_ptr<LinearSolver> (*make)(const LinearOptions&);
};

const Entry entries[] = {
#ifdef RESILIN_HAS_CHOLMOD
    {"cholesky", make_cholmod},
#elif defined(RESILIN_HAS_LAPACK)
    {"cholesky", make_multifrontal},
#else
    {"cholesky", make_ldlt},
#endif
#ifdef RESILIN_HAS_LAPACK
    {"multifrontal", make_multifrontal},
#endif
    {"ldlt", make_ldlt},
    {"cg_amg", make_cg_amg},
    {"cg_ic0", make_cg_ic0},
    {"cg_jacobi", make_cg_jacobi},
};

}  // namespace

std::unique_ptr<LinearSolver> make_linear_solver(const LinearOptions& options, Index num_unknowns) {
  if (options.kind == "auto") return make_auto(options, num_unknowns);
  if (!options.is_definite && options.kind != "multifrontal" && options.kind != "ldlt") {
    throw InputError("solver.kind", "\"multifrontal\" or \"ldlt\" where the matrix need not be definite",
                     "\"" + options.kind + "\"", "let it be \"auto\"");
  }
  for (const Entry& entry : entries)
    if (options.kind == entry.name) return entry.make(options);
  std::vector<std::string> names = linear_solver_names();
  names.insert(names.begin(), "auto");
  const std::string nearest = nearest_word(options.kind, names);
  throw InputError("solver.kind", "one of " + join(names), "\"" + options.kind + "\"",
                   nearest.empty() ? "" : "did you mean \"" + nearest + "\"?");
}

std::vector<std::string> linear_solver_names() {
  std::vector<std::string> names;
  for (const Entry& entry : entries) names.emplace_back(entry.name);
  return names;
}

}  // namespace resilin
