#pragma once

#include <string>

namespace resilin {

/// Adds "petsc_gamg" to the linear solvers that scenes may name: PETSc's conjugate gradients with its
/// smoothed aggregation, on one process or on several that share a matrix.
void register_petsc_solver();

/// "PETSc 3.18.5 and Open MPI v4.1.4".
std::string petsc_version();

}  // namespace resilin
