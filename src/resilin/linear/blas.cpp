#include "resilin/linear/blas.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <string_view>

#ifdef RESILIN_HAS_LAPACK
extern "C" void dgemm_(const char*, const char*, const int*, const int*, const int*, const double*,
                       const double*, const int*, const double*, const int*, const double*, double*,
                       const int*);
#endif

namespace resilin {
namespace {

/// The library that our calls of the BLAS go to. A Python extension and what it is linked with are not among
/// the names that all may see, and the process may hold another BLAS beside ours.
void* blas_library() {
#ifdef RESILIN_HAS_LAPACK
  Dl_info place{};
  if (dladdr(reinterpret_cast<void*>(&dgemm_), &place) != 0)
    if (void* library = dlopen(place.dli_fname, RTLD_LAZY | RTLD_NOLOAD)) return library;
#endif
  return RTLD_DEFAULT;
}

/// A function of the BLAS that is loaded, or null: Debian lets the user exchange the library.
template <class Function>
Function* find_function(const char* name) {
  static void* const library = blas_library();
  return reinterpret_cast<Function*>(dlsym(library, name));
}

std::string_view openblas_core() {
  static const auto core_name = find_function<const char*()>("openblas_get_corename");
  return core_name != nullptr ? core_name() : std::string_view{};
}

bool has_avx512() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512cd");
#else
  return false;
#endif
}

}  // namespace

std::string blas_kernel_name() {
  if (!openblas_core().empty()) return "OpenBLAS " + std::string(openblas_core());
  return find_function<void()>("dgemm_") != nullptr ? "generic" : "none";
}

bool choose_blas_kernel() {
  const std::string_view core = openblas_core();
  if (!has_avx512() || (core != "Haswell" && core != "Zen")) return false;
  if (std::getenv("OPENBLAS_CORETYPE") != nullptr) return false;
  // OpenBLAS reads the variable in this pair of functions, which its own start-up and shut-down call.
  const auto quit = find_function<void()>("gotoblas_dynamic_quit");
  const auto init = find_function<void()>("gotoblas_dynamic_init");
  if (quit == nullptr || init == nullptr) return false;
  setenv("OPENBLAS_CORETYPE", "SkylakeX", 1);
  quit();
  init();
  unsetenv("OPENBLAS_CORETYPE");
  return openblas_core() != core;
}

SingleThreadedBlas::SingleThreadedBlas() {
  static const auto num_threads = find_function<int()>("openblas_get_num_threads");
  static const auto set_num_threads = find_function<void(int)>("openblas_set_num_threads");
  if (num_threads == nullptr || set_num_threads == nullptr) return;
  previous_ = num_threads();
  if (previous_ != 1) set_num_threads(1);
}

SingleThreadedBlas::~SingleThreadedBlas() {
  if (previous_ == 1) return;
  static const auto set_num_threads = find_function<void(int)>("openblas_set_num_threads");
  set_num_threads(previous_);
}

}  // namespace resilin
