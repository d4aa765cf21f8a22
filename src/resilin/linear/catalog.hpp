#pragma once

#include <memory>

#include "resilin/linear/linear_solver.hpp"

namespace resilin {

/// One function for each solver, defined in the file of that name; linear/catalog.cpp lists them.
std::unique_ptr<LinearSolver> make_cholmod(const LinearOptions& options);
std::unique_ptr<LinearSolver> make_multifrontal(const LinearOptions& options);
std::unique_ptr<LinearSolver> make_ldlt(const LinearOptions& options);
std::unique_ptr<LinearSolver> make_cg_jacobi(const LinearOptions& options);
std::unique_ptr<LinearSolver> make_cg_ic0(const LinearOptions& options);
std::unique_ptr<LinearSolver> make_cg_amg(const LinearOptions& options);

/// The choice of `auto`: see linear/auto_solver.cpp.
std::unique_ptr<LinearSolver> make_auto(const LinearOptions& options, Index num_unknowns);

}  // namespace resilin
