#include "resilin/petsc/session.hpp"

#include <petscsys.h>

#include <stdexcept>
#include <string>

namespace resilin {
namespace {

struct Session {
  Session() {
    PetscOptionsSetValue(nullptr, "-no_signal_handler", "true");  // signals are the program's
    PetscInitializeNoArguments();
    PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  }
  ~Session() { PetscFinalize(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

}  // namespace

void start_petsc() { static const Session session; }

void require_petsc(PetscErrorCode code) {
  if (code == 0) return;
  const char* words = nullptr;
  PetscErrorMessage(code, &words, nullptr);
  throw std::runtime_error("PETSc: " +
                           std::string(words == nullptr ? "error " + std::to_string(code) : words));
}

}  // namespace resilin
