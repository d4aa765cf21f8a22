#include "resilin/linear/blas.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "resilin/core/cpu.hpp"
#include "resilin/core/memory.hpp"

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

/// The kernels of OpenBLAS that should be in use; empty when its own choice is right. OpenBLAS knows a
/// processor by its model, not by its instruction sets. For a model newer than the library it takes kernels
/// of Haswell or of Prescott.
std::string wanted_core(std::string_view core) {
#if defined(__x86_64__)
  if (const auto requested = requested_instruction_set()) {
    switch (*requested) {
      case InstructionSet::baseline:
        return "Prescott";
      case InstructionSet::avx2:
        return "Haswell";
      case InstructionSet::avx512:
        return "SkylakeX";
    }
  }
  const bool is_unknown = core == "Prescott";
  if (processor_runs(InstructionSet::avx512) && (is_unknown || core == "Haswell" || core == "Zen"))
    return "SkylakeX";
  if (processor_runs(InstructionSet::avx2) && is_unknown) return "Haswell";
#endif
  static_cast<void>(core);
  return {};
}

constexpr std::size_t buffer_bytes =
    (std::size_t{128} << 20) + 4096;  ///< size of the buffers of OpenBLAS, its page of slack too
constexpr int most_buffers = 64;      ///< it keeps books for some 128

/// The buffers belong to the process, as OpenBLAS does.
struct BlasBuffers {
  std::mutex mutex;
  int held = 0;                 ///< at least so many does OpenBLAS have
  int in_use = 0;               ///< calls that may run at this moment
  int num_single_threaded = 0;  ///< those who keep it on one thread at this moment
  int threads_before = 1;       ///< before the first of these came
};

BlasBuffers& blas_buffers() {
  static BlasBuffers buffers;
  return buffers;
}

/// OpenBLAS makes a buffer when all that it has are in use, and keeps it: taking them at the same time makes
/// it hold so many.
void require_buffers(int num_calls, std::size_t other_bytes) {
  static const auto take = find_function<void*(int)>("blas_memory_alloc");
  static const auto give_back = find_function<void(void*)>("blas_memory_free");
  BlasBuffers& buffers = blas_buffers();
  const std::lock_guard lock(buffers.mutex);
  const int wanted = std::min(buffers.in_use + num_calls, most_buffers);
  if (take != nullptr && give_back != nullptr && buffers.held < wanted) {
    std::vector<void*> taken(static_cast<std::size_t>(wanted));
    int count = 0;
    while (count < wanted && can_allocate(other_bytes + buffer_bytes)) taken[count++] = take(1);
    for (int k = 0; k < count; ++k) give_back(taken[k]);
    buffers.held = std::max(buffers.held, count);
    if (count < wanted)
      throw OutOfMemory("out of memory: the BLAS needs 128 MiB" +
                        (wanted == 1 ? "" : " for each of " + std::to_string(wanted) + " threads") + ", " +
                        words(address_space_left()) +
                        "; take solver.kind = \"cg_amg\" or \"ldlt\", fewer threads, or raise the limit");
  }
  buffers.in_use += num_calls;
}

}  // namespace

std::string blas_kernel_name() {
  if (!openblas_core().empty()) return "OpenBLAS " + std::string(openblas_core());
  return find_function<void()>("dgemm_") != nullptr ? "generic" : "none";
}

bool choose_blas_kernel() {
  const std::string_view core = openblas_core();
  // The variable of OpenBLAS is obeyed, unless our own, which says more, asks for something else.
  const char* const variable = std::getenv("OPENBLAS_CORETYPE");
  if (core.empty() || (variable != nullptr && !requested_instruction_set())) return false;
  const std::string wanted = wanted_core(core);
  if (wanted.empty() || wanted == core) return false;
  // OpenBLAS reads the variable in this pair of functions, which its own start-up and shut-down call.
  const auto quit = find_function<void()>("gotoblas_dynamic_quit");
  const auto init = find_function<void()>("gotoblas_dynamic_init");
  if (quit == nullptr || init == nullptr) return false;
  const std::optional<std::string> before = variable != nullptr ? std::optional(variable) : std::nullopt;
  setenv("OPENBLAS_CORETYPE", wanted.c_str(), 1);
  quit();
  init();
  if (before) {
    setenv("OPENBLAS_CORETYPE", before->c_str(), 1);
  } else {
    unsetenv("OPENBLAS_CORETYPE");
  }
  return openblas_core() != core;
}

SingleThreadedBlas::SingleThreadedBlas(int num_calls, std::size_t other_bytes) : num_calls_(num_calls) {
  require_buffers(num_calls, other_bytes);
  static const auto num_threads = find_function<int()>("openblas_get_num_threads");
  static const auto set_num_threads = find_function<void(int)>("openblas_set_num_threads");
  BlasBuffers& buffers = blas_buffers();
  const std::lock_guard lock(buffers.mutex);
  if (buffers.num_single_threaded++ > 0 || num_threads == nullptr || set_num_threads == nullptr) return;
  buffers.threads_before = num_threads();
  if (buffers.threads_before != 1) set_num_threads(1);
}

// The number of threads is one of the process: who came first may be the first to go, while others work.
SingleThreadedBlas::~SingleThreadedBlas() {
  static const auto set_num_threads = find_function<void(int)>("openblas_set_num_threads");
  BlasBuffers& buffers = blas_buffers();
  const std::lock_guard lock(buffers.mutex);
  buffers.in_use -= num_calls_;
  if (--buffers.num_single_threaded > 0 || buffers.threads_before == 1) return;
  set_num_threads(std::exchange(buffers.threads_before, 1));
}

}  // namespace resilin
