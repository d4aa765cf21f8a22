#pragma once

#include <string>

namespace resilin {

/// What the BLAS in use calls its kernels, such as "OpenBLAS Haswell"; "generic" for one that does not say,
/// "none" when the build has no BLAS.
std::string blas_kernel_name();

/// Makes OpenBLAS use AVX-512 kernels where the processor has them but is newer than the library, which then
/// falls back to older ones (1.8 times slower); with the environment variable RESILIN_ISA (core/cpu.hpp)
/// those of the set that it asks for. Returns true when it changed something.
///
/// For the start of a program, before other threads run: it swaps the library's kernel table. Where
/// RESILIN_ISA says nothing, a choice made by OpenBLAS's own variable OPENBLAS_CORETYPE stands.
bool choose_blas_kernel();

/// Keeps BLAS on one thread while it lives: the solvers are parallel over tasks of their own, and a threaded
/// BLAS collapses on a busy machine. Also keeps the bits the same for any number of threads.
class SingleThreadedBlas {
 public:
  SingleThreadedBlas();
  ~SingleThreadedBlas();
  SingleThreadedBlas(const SingleThreadedBlas&) = delete;
  SingleThreadedBlas& operator=(const SingleThreadedBlas&) = delete;

 private:
  int previous_ = 1;
};

}  // namespace resilin
