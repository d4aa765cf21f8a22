/// OpenBLAS asks for this when it is loaded, before `main`, and would start a thread for each core: with 8
/// MiB of stack and 128 MiB to work in each, and where it cannot have them it tries for ever or ends the
/// process; where it can, they spin for a while. We have no use for its threads (linear/blas.hpp).
extern "C" __attribute__((visibility("default"), used)) int openblas_num_threads_env() { return 1; }
