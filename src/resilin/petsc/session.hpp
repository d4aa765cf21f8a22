#pragma once

#include <petscsystypes.h>

namespace resilin {

/// Starts MPI and PETSc, once; they end with the program. PETSc's errors come back as codes: see
/// `require_petsc`. PETSC_OPTIONS of the environment are heeded.
void start_petsc();

/// Throws std::runtime_error with PETSc's words for a code that is not zero.
void require_petsc(PetscErrorCode code);

}  // namespace resilin
