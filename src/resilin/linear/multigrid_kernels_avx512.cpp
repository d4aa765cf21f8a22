#define RESILIN_KERNELS multigrid_kernels_avx512
#include "resilin/linear/multigrid_kernels.inl"
