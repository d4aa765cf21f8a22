#pragma once

#include <cstddef>
#include <string>

namespace resilin {

/// Name of the BLAS kernels in use, such as "OpenBLAS Haswell"; "generic" for one that does not say, "none"
/// when the build has no BLAS.
std::string blas_kernel_name();

/// Makes OpenBLAS use AVX-512 kernels where the processor has them but is newer than the library, which then
/// falls back to older ones (1.8 times slower); with the environment variable RESILIN_ISA (core/cpu.hpp)
/// those of the set that it asks for. Returns true when it changed something.
///
/// For the start of a program, before other threads run: it swaps the library's kernel table. Where
/// RESILIN_ISA says nothing, a choice made by OpenBLAS's own variable OPENBLAS_CORETYPE stands.
bool choose_blas_kernel();

/// Keeps each call of the BLAS on one thread while it lives: the solvers are parallel over tasks of their
/// own, and a threaded BLAS collapses on a busy machine. Also keeps the bits the same for any number of
/// threads. Several may live at once, in any order.
class SingleThreadedBlas {
 public:
  /// Sees to it that `num_calls` calls can run at the same time, beside `other_bytes` that the caller is
  /// about to allocate. OpenBLAS takes 128 MiB of address space for each, and where it cannot have them it
  /// tries for ever (0.3.21) or ends the process: here they are taken while they are known to be there. A
  /// BLAS other than OpenBLAS is taken to need nothing.
  ///
  /// @throws OutOfMemory  where there is no room
  explicit SingleThreadedBlas(int num_calls = 1, std::size_t other_bytes = 0);
  ~SingleThreadedBlas();
  SingleThreadedBlas(const SingleThreadedBlas&) = delete;
  SingleThreadedBlas& operator=(const SingleThreadedBlas&) = delete;

 private:
  int num_calls_;
};

}  // namespace resilin
