#define RESILIN_KERNELS multigrid_kernels_avx2
#include "resilin/linear/multigrid_kernels.inl"
